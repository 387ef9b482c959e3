# SPDX-License-Identifier: Apache-2.0
"""The live page of a ring, served by the installed command."""
from __future__ import annotations

import html
import subprocess
import threading
from types import TracebackType

from ._rths import Error
from .installation import command

_START_S = 10.0  #: until the page is served
_GRACE_S = 5.0  #: of a server that was asked to stop


class View:
    """A page that shows a ring, served until `close`. A notebook shows its address as a link."""

    def __init__(self, server: subprocess.Popen[str], url: str) -> None:
        self._server = server
        self.url = url  #: for a browser of this host

    def close(self) -> None:
        """Ends the server. May be called again."""
        self._server.terminate()
        try:
            self._server.communicate(timeout=_GRACE_S)
        except subprocess.TimeoutExpired:
            self._server.kill()
            self._server.communicate()

    def __enter__(self) -> View:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __del__(self) -> None:
        if self._server.poll() is None:
            self._server.kill()

    def _repr_html_(self) -> str:
        url = html.escape(self.url)
        return f'<a href="{url}" target="_blank" rel="noopener">{url}</a>'


def view(ring: str | None = None, *, port: int | None = None) -> View:
    """Serves a page that shows a ring live, by `rths view`; see docs/watching.md.

    ring: its name; None: the first ring of this host. The page waits for it. port: None: a free one, or 8017.
    Raises Error if the page cannot be served.
    """
    arguments = [str(command()), "view", *([ring] if ring else []), *(["--port", str(port)] if port is not None else [])]
    server = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
    late = threading.Timer(_START_S, server.kill)
    late.start()
    assert server.stdout is not None
    line = server.stdout.readline()
    late.cancel()
    address = next((word for word in line.split() if word.startswith("http://")), None)
    if address is None:
        server.kill()
        trouble = server.communicate()[1].strip().removeprefix("rths: ")
        raise Error(trouble or f"rths view has not served its page within {_START_S:g} s")
    return View(server, address)

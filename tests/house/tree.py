"""The tree as the house sees it: sources, folders, targets, and the arrows between folders."""
import functools
import json
import pathlib
import re
import subprocess
import tomllib
from dataclasses import dataclass, field

import cpp

TOP = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)
CPP_ENDINGS = (".cpp", ".hpp", ".c", ".h")


def below(path, folder):
    """True if the path is the folder or in it; a star in the folder stands for one name."""
    parts, names = path.split("/"), folder.split("/")
    return len(parts) >= len(names) and all(name in ("*", part) for part, name in zip(parts, names))


@dataclass
class Source:
    path: str
    text: str

    @functools.cached_property
    def found(self):
        return cpp.scan(self.text)

    @functools.cached_property
    def plain(self):
        """Its text without comments and quoted texts."""
        return cpp.masked(self.text)

    @property
    def lines(self):
        return self.text.count("\n")


@dataclass
class Target:
    name: str
    kind: str
    folder: str
    names: list = field(default_factory=list)


@dataclass(frozen=True, order=True)
class Arrow:
    """One folder uses another; folders as the table of arrows names them."""
    user: str
    used: str


class Tree:
    """All that the figures are taken from."""

    def __init__(self, plan, sources, targets):
        self.plan = plan
        self.sources = sources
        self.targets = {target.name: target for target in targets}

    @staticmethod
    def read(targets_file, top=TOP):
        plan = tomllib.loads((pathlib.Path(__file__).parent / "house.toml").read_text())
        listing = subprocess.run(["git", "-c", f"safe.directory={top}", "ls-files", "-co", "--exclude-standard"],
                                 cwd=top, capture_output=True, text=True, check=True).stdout.splitlines()
        names = [name for name in listing if name.endswith((*CPP_ENDINGS, ".py")) and (top / name).is_file()]
        sources = [Source(name, (top / name).read_text(errors="replace")) for name in sorted(set(names))]
        targets = [Target(**entry) for entry in json.loads(pathlib.Path(targets_file).read_text())]
        return Tree(plan, sources, targets)

    def is_product(self, path):
        return not any(below(path, folder) for folder in self.plan["outside"])

    def cpp_sources(self, product=True):
        return [source for source in self.sources
                if source.path.endswith(CPP_ENDINGS) and (not product or self.is_product(source.path))]

    @functools.cached_property
    def product_targets(self):
        return [target for target in self.targets.values() if self.is_product(target.folder) and target.folder]

    @functools.cached_property
    def folders(self):
        """Folders with targets, the deepest first."""
        return sorted({target.folder for target in self.targets.values()} - {""}, key=lambda name: (-name.count("/"), name))

    def folder_of(self, path):
        """The folder whose target a source belongs to."""
        return next((folder for folder in self.folders if below(path, folder)), path.split("/")[0])

    def place(self, folder, target=None):
        """The name of a folder, or of a target with a place of its own, in the table of arrows."""
        return self.plan["places"].get(target) or self.plan["names"].get(folder, folder)

    # --- arrows -----------------------------------------------------------------------------------

    def place_of(self, target):
        return self.place(target.folder, target.name)

    def arrow(self, user, used):
        return Arrow(self.place_of(user), self.place_of(used))

    def closure(self, target):
        """Names of all targets that a target reaches."""
        reached, waiting = set(), [target.name]
        while waiting:
            for name in self.targets[waiting.pop()].names:
                if name in self.targets and name not in reached:
                    reached.add(name)
                    waiting.append(name)
        return reached

    @functools.cached_property
    def arrows(self):
        """Each with the targets or files that draw it: links, and includes that no link explains."""
        drawn = {}
        for target in self.product_targets:
            for name in target.names:
                if name in self.targets and self.targets[name].folder:
                    drawn.setdefault(self.arrow(target, self.targets[name]), []).append(target.name)
        reached = {}
        for target in self.product_targets:
            folders = {self.targets[name].folder for name in self.closure(target)}
            reached.setdefault(target.folder, set()).update(folders | {target.folder})
        for source, owner, _ in self.includes:
            user = self.folder_of(source.path)
            if user in reached and owner not in reached[user]:
                drawn.setdefault(Arrow(self.place(user), self.place(owner)), []).append(source.path)
        return {arrow: drawn[arrow] for arrow in sorted(drawn) if arrow.user != arrow.used}

    def allowed(self, place):
        """Folders that a folder may use, with stars; None: it has no place in the table."""
        table = self.plan["arrows"]
        for entry in (place, place.rsplit("/", 1)[0] + "/*"):
            if entry in table:
                return [*table[entry], "core"]
        return None

    def is_allowed(self, arrow):
        allowed = self.allowed(arrow.user) or []
        return any(below(arrow.used, name) and arrow.used.count("/") == name.count("/") for name in allowed)

    def wrong_at_a_distance(self):
        """(user, used) pairs of targets that the rule `never` forbids at any distance."""
        for target in self.product_targets:
            for user, rule in self.plan["never"].items():
                if below(target.folder, user):
                    yield from ((target.name, name) for name in sorted(self.closure(target))
                                if any(below(self.targets[name].folder, never) for never in rule))

    # --- includes ---------------------------------------------------------------------------------

    @functools.cached_property
    def headers(self):
        """Headers by each ending of their path."""
        index = {}
        for source in self.cpp_sources(product=False):
            if source.path.endswith((".hpp", ".h")):
                parts = source.path.split("/")
                for start in range(len(parts)):
                    index.setdefault("/".join(parts[start:]), []).append(source.path)
        return index

    def header(self, source, name, is_quoted):
        """The header of this tree that an include means; None: it is another library's."""
        own = source.path.rsplit("/", 1)[0] + "/" + name
        paths = self.headers.get(name, [])
        if is_quoted and own in self.headers:
            return own
        ours = [path for path in paths if self.folder_of(path) == self.folder_of(source.path)]
        public = [path for path in paths if "/include/" in path]
        return next(iter(ours + public + paths), None)

    @functools.cached_property
    def includes(self):
        """(source, folder of the header, header) for each include of another folder's header in the product."""
        found = []
        for source in self.cpp_sources():
            for quote, name in INCLUDE.findall(source.text):
                header = self.header(source, name, quote == '"')
                if header and self.folder_of(header) != self.folder_of(source.path):
                    found.append((source, self.folder_of(header), header))
        return found

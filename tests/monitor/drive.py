"""Opens a page in Chromium, runs a script there, and prints what it returns.

    drive.py URL [--size 1400x900] [--dark] [--screenshot FILE] < script.js

The script is the body of an async function. Chromium is driven through its debugging pipe.
"""
import argparse
import base64
import json
import os
import subprocess
import sys
import tempfile

BROWSER = "/usr/bin/chromium"
DEADLINE_S = 100


class Browser:
    def __init__(self, profile):
        to_browser, self.commands = os.pipe()
        self.answers, from_browser = os.pipe()
        # The browser reads from descriptor 3 and writes to 4.
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec 3<&{to_browser} 4>&{from_browser} "$@"', "browser", "timeout", str(DEADLINE_S), BROWSER, "--headless",
             "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
             "--disable-sync", f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            pass_fds=[to_browser, from_browser], stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.pending = b""
        self.count = 0
        self.session = None

    def read(self):
        while b"\0" not in self.pending:
            part = os.read(self.answers, 1 << 20)
            if not part:
                sys.exit("the browser has ended")
            self.pending += part
        message, self.pending = self.pending.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.count:
                if "error" in answer:
                    sys.exit(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, url, size, dark):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        width, height = map(int, size.split("x"))
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.call("Page.navigate", url=url)

    def run(self, script):
        # The document of the address may not be there yet.
        body = "(async () => { while (document.readyState !== 'complete' || location.href === 'about:blank') " \
               "await new Promise(r => setTimeout(r, 20));\n" + script + "\n})()"
        result = self.call("Runtime.evaluate", expression=body, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            return "failed: " + result["exceptionDetails"].get("exception", {}).get("description", "?")
        return result["result"].get("value", "")

    def screenshot(self, file):
        picture = self.call("Page.captureScreenshot", captureBeyondViewport=True)
        with open(file, "wb") as out:
            out.write(base64.b64decode(picture["data"]))


def main():
    options = argparse.ArgumentParser()
    options.add_argument("url")
    options.add_argument("--size", default="1400x900")
    options.add_argument("--dark", action="store_true")
    options.add_argument("--screenshot")
    given = options.parse_args()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            browser.open(given.url, given.size, given.dark)
            print(browser.run(sys.stdin.read()))
            if given.screenshot:
                browser.screenshot(given.screenshot)
        finally:
            browser.process.terminate()
            browser.process.wait()


main()

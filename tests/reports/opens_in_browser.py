#!/usr/bin/env python3
"""opens_in_browser.py REPORT.HTML: opens a report in headless Chromium and checks what a reader would see.

Every picture must be loaded with a size, carry a text for readers who do not see it, and the page must leave
no error on the console and fetch nothing from outside. Speaks WebDriver to Debian's chromedriver with the
standard library alone. Exit code 0 if all holds.
"""

import json
import re
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

CHROMIUM_ARGUMENTS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-default-apps", "--disable-extensions",
    "--disable-dev-shm-usage", "--window-size=1280,1000",
]
PICTURES = """
return Promise.all([...document.images].map(image => image.decode().catch(() => null))).then(() =>
  [...document.images].map(image => ({ width: image.naturalWidth, height: image.naturalHeight,
    alternative: image.alt, figure: image.closest("figure")?.id ?? "" })));
"""
FETCHED = "return performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:'));"
WIDE = "return document.documentElement.scrollWidth - document.documentElement.clientWidth;"


class Browser:
    """One session of chromedriver with a fresh profile."""

    def __init__(self, profile: str):
        self.driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        port = None
        for line in self.driver.stdout:
            if match := re.search(r"on port (\d+)\.", line):
                port = match[1]
                break
        if port is None:
            raise RuntimeError("chromedriver did not start")
        self.base = f"http://127.0.0.1:{port}/session"
        options = {"args": [*CHROMIUM_ARGUMENTS, f"--user-data-dir={profile}"]}
        answer = self.call("", {"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.base += "/" + answer["sessionId"]

    def call(self, path: str, body: dict | None = None, method: str | None = None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=60) as answer:
            return json.load(answer)["value"]

    def run(self, script: str):
        return self.call("/execute/sync", {"script": script, "args": []})

    def close(self) -> None:
        try:
            self.call("", method="DELETE")
        finally:
            self.driver.terminate()
            self.driver.wait(timeout=30)
            self.driver.stdout.close()


def faults_of(page: Path, expected: list[str]) -> list[str]:
    """Everything that is wrong with the page, in words."""
    with tempfile.TemporaryDirectory(prefix="sprung_chromium_", ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            browser.call("/url", {"url": page.resolve().as_uri()})
            pictures, fetched = browser.run(PICTURES), browser.run(FETCHED)
            too_wide, log = browser.run(WIDE), browser.call("/se/log", {"type": "browser"})
        finally:
            browser.close()
    faults = [f"picture '{p['figure']}' is not there" for p in pictures if not p["width"] or not p["height"]]
    faults += [f"picture '{p['figure']}' has no text for readers who do not see it" for p in pictures
               if len(p["alternative"]) < 20]
    faults += [f"picture '{name}' is missing" for name in expected if name not in {p["figure"] for p in pictures}]
    faults += [f"console: {entry['level']}: {entry['message']}" for entry in log]
    faults += [f"fetched from outside: {name}" for name in fetched]
    if too_wide > 0:
        faults.append(f"the page is {too_wide} px wider than the window")
    return faults


def main(arguments: list[str]) -> int:
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    faults = faults_of(Path(arguments[0]), arguments[1:])
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""A headless Chromium by the WebDriver protocol (W3C), with Python's standard library alone."""

import base64
import json
import pathlib
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

CHROMIUM = shutil.which("chromium") or "chromium"
FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
         "--disable-sync", "--hide-scrollbars", "--disable-dev-shm-usage"]


class Browser:
    """`with Browser() as b: b.open(path)`; what a script returns comes back as Python's values."""

    def __init__(self, width=1200, height=900, dark=False):
        self.folder = tempfile.TemporaryDirectory()
        self.log = tempfile.TemporaryFile()
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=self.log, text=True)
        self.session = None
        port = None
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                port = line.rstrip(". \n").rsplit(" ", 1)[1]
                break
        if port is None:
            raise RuntimeError("chromedriver did not start")
        self.base = f"http://127.0.0.1:{port}/session"
        flags = [*FLAGS, f"--user-data-dir={self.folder.name}", f"--window-size={width},{height}"]
        if dark:
            flags.append("--force-dark-mode")
        told = self.call("", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": {"args": flags, "binary": CHROMIUM},
            "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.session = told["sessionId"]
        self.base += "/" + self.session
        self.devtools("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})
        self.size(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            if self.session:
                self.call("", method="DELETE")
        except (OSError, RuntimeError):
            pass
        self.driver.terminate()
        self.driver.wait(20)
        self.driver.stdout.close()
        self.log.close()
        for _ in range(20):
            try:
                self.folder.cleanup()
                break
            except OSError: # Chromium still writes into it
                time.sleep(0.2)

    def call(self, path, body=None, method=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data=data, method=method or ("POST" if data else "GET"),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=1200) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as problem:
            raise RuntimeError(problem.read().decode()[:2000]) from None

    def devtools(self, command, parameters):
        return self.call("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def size(self, width, height):
        """Of the page, however narrow: a window has a least width."""
        self.devtools("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def open(self, path):
        self.call("/url", {"url": pathlib.Path(path).resolve().as_uri()})

    def run(self, script, *arguments):
        return self.call("/execute/sync", {"script": script, "args": list(arguments)})

    def console(self):
        """What the page complained of since the last call."""
        return [entry["message"] for entry in self.call("/se/log", {"type": "browser"}) if entry["level"] == "SEVERE"]

    def drag(self, x, y, to_x):
        """With the left button, along a line."""
        def move(at):
            return {"type": "pointerMove", "duration": 20, "x": int(at), "y": int(y), "origin": "viewport"}
        self.call("/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [
            move(x), {"type": "pointerDown", "button": 0}, move(0.5 * (x + to_x)), move(to_x), {"type": "pointerUp", "button": 0}]}]})

    def point(self, x, y):
        self.call("/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": [
            {"type": "pointerMove", "duration": 20, "x": int(x), "y": int(y), "origin": "viewport"}]}]})

    def picture(self, path, whole=False):
        """A screenshot as PNG: of the window, or of the whole page."""
        told = self.devtools("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": whole,
                                                        **({"clip": {**self.extent(), "x": 0, "y": 0, "scale": 1}} if whole else {})})
        pathlib.Path(path).write_bytes(base64.b64decode(told["data"]))

    def extent(self):
        return self.run("return {width: document.documentElement.clientWidth, height: document.documentElement.scrollHeight}")

    def print(self):
        """The page as PDF."""
        return base64.b64decode(self.call("/print", {"page": {"width": 21.0, "height": 29.7}, "background": True}))

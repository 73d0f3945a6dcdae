"""A headless Chromium for tests of pages, spoken to over a pipe: no package is needed for it."""

import base64
import io
import json
import os
import shutil
import subprocess
import time

import numpy as np

COMMAND = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))),
               None)
OPTIONS = ("--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run",
           "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--disable-extensions", "--disable-dev-shm-usage", "--hide-scrollbars",
           "--host-resolver-rules=MAP * ~NOTFOUND", "about:blank")


class Browser:
    """One page of a browser, with its errors; the network is cut off."""

    def __init__(self, profile, width=660, height=500):
        to, self._in = os.pipe()
        self._out, of = os.pipe()
        # the browser reads from 3 and writes to 4
        places = f"exec {COMMAND} \"$@\" 3<&{to} 4>&{of}"
        self._process = subprocess.Popen(
            ["bash", "-c", places, "bash", f"--user-data-dir={profile}", *OPTIONS],
            pass_fds=(to, of), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to)
        os.close(of)
        self._rest, self._count, self._session = b"", 0, None
        self.errors = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target,
                                  flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "Performance"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)

    def close(self):
        """End the browser."""
        os.close(self._in)          # it ends with its pipe
        try:
            self._process.wait(20)
        finally:
            self._process.kill()
            self._process.wait()
            os.close(self._out)

    def call(self, method, **parameters):
        """Answer to a command of the DevTools protocol."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._in, json.dumps(message).encode() + b"\0")
        while True:
            found = self._read()
            if found.get("id") == self._count:
                assert "error" not in found, found
                return found["result"]
            self._note(found)

    def open(self, path):
        """Load a file; the seconds that the page has computed until its first picture.

        They are seconds of the processor: others may use the machine.
        """
        began = self._computed()
        self.call("Page.navigate", url=path.resolve().as_uri())
        self.wait("document.body && document.body.dataset.drawn")
        ended = self._computed()
        return ended - began if ended > began else ended    # the process may be a new one

    def wait(self, expression, seconds=20.0):
        """Until an expression is true."""
        end = time.perf_counter() + seconds
        while not self.value(expression):
            assert time.perf_counter() < end, (expression, self.errors)
            time.sleep(0.02)

    def value(self, expression):
        """Value of an expression in the page."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                          awaitPromise=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def picture(self, path=None):
        """What is seen, (height, width, 3) of bytes."""
        from matplotlib.image import imread

        content = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if path:
            path.write_bytes(content)
        return np.rint(255 * imread(io.BytesIO(content), format="png")[..., :3]).astype(int)

    def _computed(self):
        """Processor time of the page."""
        metrics = self.call("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "ProcessTime")

    def _read(self):
        while b"\0" not in self._rest:
            piece = os.read(self._out, 1 << 20)
            assert piece, "the browser has ended"
            self._rest += piece
        one, _, self._rest = self._rest.partition(b"\0")
        return json.loads(one)

    def _note(self, event):
        parameters = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            self.errors.append(parameters["exceptionDetails"])
        if event.get("method") == "Runtime.consoleAPICalled" and parameters["type"] in (
                "error", "warning", "assert"):
            self.errors.append(parameters["args"])
        if event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(parameters["entry"])
        if event.get("method") == "Network.requestWillBeSent":
            url = parameters["request"]["url"]
            if not url.startswith(("file:", "data:", "about:")):
                self.errors.append(url)

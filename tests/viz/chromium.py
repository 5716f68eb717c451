"""A headless Chromium, driven through its debugging protocol."""

from __future__ import annotations

import asyncio
import base64
import json
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from tornado.websocket import websocket_connect

FLAGS = """
--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
--disable-component-update --disable-sync --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader
--remote-debugging-port=0 --hide-scrollbars
"""


def executable() -> str:
    """Return the path of a Chromium."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None:
        raise RuntimeError("no Chromium on this machine (install it, or leave these tests out: -m 'not browser')")
    return found


class Page:
    """One page; use as a context manager."""

    def __init__(self, url: str, size: tuple[int, int] = (1280, 800)) -> None:
        self._url, self._size = url, size

    def __enter__(self) -> Page:
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._loop = asyncio.new_event_loop()
        flags = [*FLAGS.split(), f"--user-data-dir={self._folder.name}", "--window-size={},{}".format(*self._size)]
        self._log = (Path(self._folder.name) / "stderr").open("wb")
        self._process = subprocess.Popen(
            [executable(), *flags, "about:blank"], stderr=self._log, stdout=subprocess.DEVNULL
        )
        address = self._until(self._debugger, 15)
        self._socket = self._run(self._connect(address))
        self._number = 0
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        width, height = self._size
        self._call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self._call("Page.enable")
        self.load()
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._process.terminate()
        self._process.wait(5)
        self._loop.run_until_complete(asyncio.sleep(0.05))
        self._loop.close()
        self._log.close()
        self._folder.cleanup()

    def load(self) -> None:
        """Load the page, again if it is there already, and wait until it is."""
        self._call("Page.navigate", url="about:blank")
        self._call("Page.navigate", url=self._url)
        self.wait_for("document.readyState == 'complete'")

    def evaluate(self, script: str) -> object:
        """Return the value of a JavaScript expression."""
        answer = self._call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise AssertionError(answer["exceptionDetails"]["exception"].get("description"))
        return answer["result"].get("value")

    def wait_for(self, script: str, timeout: float = 10.0) -> object:
        """Return the value of an expression as soon as it is true; it may read things that are not there yet."""
        missing = "if (error instanceof TypeError) return null; throw error"
        patient = f"(() => {{ try {{ return ({script}) }} catch (error) {{ {missing} }} }})()"
        return self._until(lambda: self.evaluate(patient), timeout, script)

    def screenshot(self) -> bytes:
        """Return the page as PNG."""
        return base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])

    def resize(self, width: int, height: int) -> None:
        self._call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def _call(self, method: str, **parameters: object) -> dict:
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if getattr(self, "_session", None):
            message["sessionId"] = self._session
        return self._run(self._exchange(message))

    @staticmethod
    async def _connect(address: str):
        return await websocket_connect(address, max_message_size=1 << 28)

    async def _exchange(self, message: dict) -> dict:
        await self._socket.write_message(json.dumps(message))
        while True:
            answer = json.loads(await asyncio.wait_for(self._socket.read_message(), 20))
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise AssertionError(answer["error"])
                return answer["result"]

    def _run(self, work):
        return self._loop.run_until_complete(work)

    def _debugger(self) -> str | None:
        said = (Path(self._folder.name) / "stderr").read_text(errors="replace")
        found = re.search(r"DevTools listening on (ws://\S+)", said)
        return found.group(1) if found else None

    @staticmethod
    def _until(look, timeout: float, what: str = "") -> object:
        end = time.monotonic() + timeout
        while not (value := look()):
            if time.monotonic() > end:
                raise AssertionError(f"not within {timeout} s: {what}")
            time.sleep(0.05)
        return value

"""The process that serves the browser view.

It reads messages from its standard input until that ends, which it does when the mission's process ends in whatever
way. It keeps the latest message of each slot of the scene, for browsers that come later, and hands the news to those
that are there, each at the pace it can take: what was replaced before it could be sent is left out.

A message is a header of `HEADER` (length of the name, length of the payload), the name, and the payload, which goes to
the browser as it is. A name is ``path#slot``; an empty payload asks for the path and all below it to be deleted.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import importlib.util
import json
import struct
import sys
from pathlib import Path
from typing import Any

import tornado.httpserver
import tornado.netutil
import tornado.web
import tornado.websocket

HEADER = struct.Struct(">II")
DELETE = "delete"
_FIRST_PORT, _PORTS = 7000, 100
_FAREWELL = 1.0  # how long slow browsers are waited for at the end [s]
_PAGE = Path(__file__).with_name("page.html")


def split_name(name: str) -> tuple[str, str]:
    """Return path and slot of a message's name."""
    path, _, slot = name.partition("#")
    return path, slot


class Messages(dict[str, bytes]):
    """Messages by name, in the order of their latest arrival."""

    def add(self, name: str, payload: bytes) -> None:
        """Put a message in place of an older one; a deletion takes the place of all it deletes."""
        path, slot = split_name(name)
        if slot == DELETE:
            for older in [key for key in self if split_name(key)[0] == path or key.startswith(f"{path}/")]:
                del self[older]
        self.pop(name, None)
        self[name] = payload


class Hub:
    """The scene so far and the browsers that watch it."""

    def __init__(self) -> None:
        """Start with an empty scene and nobody watching."""
        self.scene = Messages()
        self.browsers: set[Browser] = set()

    def publish(self, name: str, payload: bytes) -> None:
        """Keep a message and pass it on."""
        self.scene.add(name, payload)
        if split_name(name)[1] == DELETE:
            self.scene.pop(name, None)  # nothing is left to delete for those that come later
        for browser in self.browsers:
            browser.enqueue(name, payload)

    async def drain(self) -> None:
        """Wait until every browser has got everything."""
        while any(browser.behind for browser in self.browsers):
            await asyncio.sleep(0.01)

    def count(self) -> None:
        """Tell the mission's process how many browsers watch."""
        print(json.dumps({"browsers": len(self.browsers)}), flush=True)


class Browser(tornado.websocket.WebSocketHandler):
    """One page that is open."""

    def initialize(self, hub: Hub) -> None:
        """Take the hub from the route."""
        self._hub, self._pending, self._news = hub, Messages(), asyncio.Event()
        self.behind = False

    def open(self, *_args: str, **_kwargs: str) -> None:
        """Send the scene so far, then the news."""
        self.set_nodelay(True)
        for name, payload in self._hub.scene.items():
            self.enqueue(name, payload)
        self._hub.browsers.add(self)
        self._hub.count()
        self._sender = asyncio.create_task(self._send())

    def enqueue(self, name: str, payload: bytes) -> None:
        """Send a message when the connection is free."""
        self._pending.add(name, payload)
        self.behind = True
        self._news.set()

    def on_message(self, message: str | bytes) -> None:
        """Ignore what the page says: it only watches."""

    def on_close(self) -> None:
        """Forget the page."""
        self._hub.browsers.discard(self)
        self._sender.cancel()
        self._hub.count()

    async def _send(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            while self._pending:
                name = next(iter(self._pending))
                payload = self._pending.pop(name)
                try:
                    await self.write_message(payload, binary=True)
                except tornado.websocket.WebSocketClosedError:
                    return
            self.behind = False


class _Fresh(tornado.web.RequestHandler):
    def set_default_headers(self) -> None:
        self.set_header("Cache-Control", "no-store")

    def get(self) -> None:
        self.finish(_PAGE.read_text(encoding="utf-8"))


def application(hub: Hub) -> tornado.web.Application:
    """Return the routes: the page, meshcat's script, the scene's stream."""
    package = importlib.util.find_spec("meshcat")
    if package is None or not package.submodule_search_locations:
        raise SystemExit("meshcat is not installed")
    viewer = Path(package.submodule_search_locations[0]) / "viewer" / "dist"
    return tornado.web.Application(
        [
            (r"/", _Fresh),
            (r"/stream", Browser, {"hub": hub}),
            (r"/static/(.*)", tornado.web.StaticFileHandler, {"path": str(viewer)}),
        ]
    )


def listen(host: str, port: int | None) -> tuple[list[Any], int]:
    """Return sockets that listen on a port, or on the first free one if it is None.

    Raises:
        OSError: The port is taken, or all are.
    """
    if port is not None:
        sockets = tornado.netutil.bind_sockets(port, host)
        return sockets, sockets[0].getsockname()[1]
    for attempt in range(_FIRST_PORT, _FIRST_PORT + _PORTS):
        try:
            return tornado.netutil.bind_sockets(attempt, host), attempt
        except OSError:
            continue
    raise OSError(f"no free port from {_FIRST_PORT} to {_FIRST_PORT + _PORTS - 1}")


async def serve(host: str, port: int | None) -> None:
    """Serve until the standard input ends."""
    hub = Hub()
    sockets, port = listen(host, port)
    server = tornado.httpserver.HTTPServer(application(hub))
    server.add_sockets(sockets)
    print(json.dumps({"url": f"http://{host}:{port}/"}), flush=True)
    reader = asyncio.StreamReader()
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    try:
        while True:
            name_length, payload_length = HEADER.unpack(await reader.readexactly(HEADER.size))
            name = (await reader.readexactly(name_length)).decode()
            hub.publish(name, await reader.readexactly(payload_length))
    except asyncio.IncompleteReadError:  # the mission's process has said all, or is gone
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(hub.drain(), _FAREWELL)
        server.stop()


def main() -> None:
    """Run as a program."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--host", required=True)
    parser.add_argument("--port", type=int)
    arguments = parser.parse_args()
    try:
        asyncio.run(serve(arguments.host, arguments.port))
    except OSError as error:
        raise SystemExit(error.strerror or str(error)) from None


if __name__ == "__main__":
    main()

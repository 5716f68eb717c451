"""A mission in the browser."""

from __future__ import annotations

import logging
import time
from types import TracebackType

from zavis_bt.types import MissionResult, Observed
from zavis_bt.viz.link import Link
from zavis_bt.viz.scene import Scene

_LOG = logging.getLogger(__name__)
_PERIOD = 0.1  # least time between frames [s]
_SHARE = 0.03  # of the wall time that drawing may take
_FAREWELL = 2.0  # how long the end of a mission waits for the last frame to leave [s]


class MeshcatViewer:
    """Shows map, robot, landmarks, viewpoints, candidates and the tree in the browser: an `Observer`.

    Frames are paced by wall time, and by what they cost: a mission that runs in lock step is shown now and then and is
    not slowed. Nothing waits for a browser; one that comes later, or again, sees the scene as it is.
    """

    def __init__(
        self, port: int | None = None, open_browser: bool = False, *, title: str = "", host: str = "127.0.0.1"
    ) -> None:
        """Start serving.

        Args:
            port: None takes the first free one from 7000, 0 any.
            open_browser: Whether to open a page in the user's browser.
            title: Heading of the page, for example what is looked for.
            host: Address to listen at; other machines can watch only if it is not the local one.

        Raises:
            DeviceError: The server does not start, for example because the port is taken.
        """
        self._title = title
        self._link = Link(host, port)
        self._scene = Scene()
        self._due = 0.0
        self._lost = False
        if open_browser:
            import webbrowser

            webbrowser.open(self.url, new=2)

    @property
    def url(self) -> str:
        """Address of the page."""
        return self._link.url

    def wait_for_browser(self, timeout: float = 0.0) -> bool:
        """Return whether a page is open, waiting for one for at most ``timeout`` seconds; by default not at all."""
        end = time.monotonic() + timeout
        while self._link.browsers == 0 and self._link.alive and time.monotonic() < end:
            time.sleep(0.02)
        return self._link.browsers > 0

    def on_start(self, mission: Observed) -> None:
        """Clear the stage and draw what there is."""
        if self._works():
            self._link.flush(_FAREWELL)
            self._scene = Scene()
            opening = list(self._scene.opening(mission.robot, self._title))
            self._link.send([*opening, *self._scene.news(mission, time.monotonic(), everything=True)])

    def on_tick(self, mission: Observed) -> None:
        """Draw what changed, if it is time for a frame."""
        now = time.monotonic()
        if now < self._due or self._link.busy or not self._works():
            return
        self._link.send(list(self._scene.news(mission, now)))
        cost = time.monotonic() - now
        self._due = now + max(_PERIOD, cost / _SHARE)

    def on_end(self, mission: Observed, result: MissionResult) -> None:
        """Draw the end of the mission; the page stays until `close`."""
        if self._works() and self._link.flush(_FAREWELL):
            news = self._scene.news(mission, time.monotonic(), everything=True)
            self._link.send([*news, *self._scene.closing(result)])
            self._link.flush(_FAREWELL)

    def close(self) -> None:
        """End the server; may be called twice. An open page keeps showing the last frame."""
        self._lost = True
        self._link.close()

    def __enter__(self) -> MeshcatViewer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _works(self) -> bool:
        if not self._lost and not self._link.alive:
            self._lost = True
            _LOG.error("browser view at %s: its server has ended; the mission goes on unseen", self.url)
        return not self._lost

"""A simulated robot whose devices can be made to fail, and that notes what is sent to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from zavis_bt.errors import DeviceError
from zavis_bt.protocols import Clock, Robot
from zavis_bt.types import BaseState, LaserScan, PanTiltState, RgbdFrame, Twist2D

DEVICES = ("base", "lidar", "pan_tilt", "camera")


class FaultyRobot:
    """Passes everything on, but what its tests take from it."""

    def __init__(self, robot: Robot, clock: Clock) -> None:
        self._robot, self._clock, self.spec = robot, clock, robot.spec
        self.silent: set[str] = set()
        """Devices that go on saying what they said last."""
        self.refusing: set[str] = set()
        """Devices that raise at commands."""
        self.fault: dict[str, str] = {}
        """What base and pan-tilt unit say is wrong."""
        self.commands: list[tuple[float, Twist2D | str]] = []
        """When the base was told what; only what reaches it."""
        self.moves: list[tuple[float, tuple[float, float] | str]] = []
        self._last: dict[str, Any] = {}
        self.base, self.lidar, self.pan_tilt, self.camera = _Base(self), _Lidar(self), _PanTilt(self), _Camera(self)

    def motions(self, since: float, until: float = math.inf) -> list[Twist2D]:
        """What the base was told in this time that would move it."""
        return [twist for stamp, twist in self.commands if since < stamp < until and twist not in ("stop", Twist2D())]

    def heard(self, device: str, read: Callable[[], Any]) -> Any:
        if device not in self.silent:
            self._last[device] = read()
        return self._last.get(device)

    def reach(self, device: str) -> None:
        if device in self.refusing:
            raise DeviceError(f"{device}: cannot be reached (check its cable)")

    def now(self) -> float:
        return self._clock.now()

    def close(self) -> None:
        self._robot.close()

    @property
    def whole(self) -> Robot:
        return self._robot


class _Base:
    def __init__(self, robot: FaultyRobot) -> None:
        self._all, self._base = robot, robot.whole.base

    def state(self) -> BaseState:
        state: BaseState = self._all.heard("base", self._base.state)
        return replace(state, fault=self._all.fault.get("base", ""))

    def pose_at(self, stamp: float) -> Any:
        return self._base.pose_at(stamp)

    def command(self, twist: Twist2D) -> None:
        self._all.reach("base")
        self._all.commands.append((self._all.now(), twist))
        self._base.command(twist)

    def stop(self) -> None:
        if "base" not in self._all.refusing:
            self._all.commands.append((self._all.now(), "stop"))
            self._base.stop()


class _PanTilt:
    def __init__(self, robot: FaultyRobot) -> None:
        self._all, self._unit = robot, robot.whole.pan_tilt

    def state(self) -> PanTiltState:
        state: PanTiltState = self._all.heard("pan_tilt", self._unit.state)
        return replace(state, fault=self._all.fault.get("pan_tilt", ""))

    def angles_at(self, stamp: float) -> tuple[float, float]:
        return self._unit.angles_at(stamp)

    def move_to(self, pan: float, tilt: float) -> None:
        self._all.reach("pan_tilt")
        self._all.moves.append((self._all.now(), (pan, tilt)))
        self._unit.move_to(pan, tilt)

    def stop(self) -> None:
        self._all.moves.append((self._all.now(), "stop"))
        self._unit.stop()


class _Lidar:
    def __init__(self, robot: FaultyRobot) -> None:
        self._all = robot

    def scan(self) -> LaserScan | None:
        scan: LaserScan | None = self._all.heard("lidar", self._all.whole.lidar.scan)
        return scan


class _Camera:
    def __init__(self, robot: FaultyRobot) -> None:
        self._all = robot

    def frame(self) -> RgbdFrame | None:
        frame: RgbdFrame | None = self._all.heard("camera", self._all.whole.camera.frame)
        return frame

"""The simulated pan-tilt unit: two drives on one CAN bus."""

from __future__ import annotations

import contextlib
import logging
import math
import os
import socket
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from drivers.pan_tilt.objects import HEARTBEAT, NMT, SDO_REQUEST, SYNC
from drivers.pan_tilt.states import State
from sim.devices.cia402.axis import Axis
from sim.devices.cia402.dictionary import object_dictionary
from sim.devices.cia402.drive import Drive
from sim.devices.cia402.servo import Servo
from zavis_bt.errors import InputError
from zavis_bt.types import RobotSpec

if TYPE_CHECKING:
    import can

_TICK = 0.01  # [s]
_SWITCH, _STOP = math.radians(2), math.radians(4)  # limit switch and hard stop beyond the limits [rad]
_NODE = 0x7F
_FRAME = 8
_IP_MULTICAST_ALL = 49  # of linux/in.h


class Body(Protocol):
    """What the unit sits on: a `sim.devices.plant.Plant`, or less."""

    joints: Callable[[float], tuple[float, float]]
    """Pan and tilt [rad] at a time [s]."""

    @property
    def spec(self) -> RobotSpec:
        """The robot's model."""

    @property
    def now(self) -> float:
        """Its time [s]."""


class _LimitSwitches:
    def __init__(self, axis: Axis, low: float, high: float) -> None:
        self._axis, self._low, self._high = axis, low, high

    def pressed(self, now: float, *, positive: bool) -> bool:
        position = self._axis.at(now)[0]
        return position >= self._high if positive else position <= self._low


class Cia402Drives:
    """Two CiA 402 servo drives that move a plant's camera. They run by themselves from `start` to `close`."""

    def __init__(
        self,
        plant: Body,
        *,
        interface: str = "udp_multicast",
        channel: str = "239.74.163.2",
        pan_node: int = 1,
        tilt_node: int = 2,
        units_per_degree: float = 1000.0,
        begin: tuple[float, float] = (0.0, 0.0),
        **options: Any,
    ) -> None:
        """Put two drives on a bus; they sleep until `start`.

        Args:
            plant: The body whose ``joints`` they set.
            interface: Kind of bus, as python-can calls it.
            channel: Its channel; both ends must name the same.
            pan_node: Node number of the drive of the pan axis, 1 to 126.
            tilt_node: The same of the tilt axis.
            units_per_degree: The drives' unit of angles.
            begin: Pan and tilt when the power comes on [rad]; the drives count from there until they are homed.
            options: Passed to python-can.

        Raises:
            InputError: The node numbers are no two different ones from 1 to 126.
        """
        if pan_node == tilt_node or not {pan_node, tilt_node} <= set(range(1, _NODE)):
            raise InputError(f"pan-tilt: nodes {pan_node} and {tilt_node} (take two different ones from 1 to 126)")
        self.nodes = {"pan": pan_node, "tilt": tilt_node}
        """Node numbers by axis."""
        self._plant, self._units = plant, math.degrees(1.0) * units_per_degree
        self._bus_options = {"interface": interface, "channel": channel, **options}
        self._per_degree, self._begin = units_per_degree, begin
        self._drives: dict[int, Drive] = {}
        self._silent: dict[int, float] = {}
        self._lock = threading.RLock()
        self._running = threading.Event()
        self._thread = threading.Thread(target=self._run, name="cia402", daemon=True)

    def start(self) -> None:
        """Switch the power on: both drives send their boot-up message.

        Raises:
            can.CanError: The bus cannot be opened.
        """
        from sim.devices.cia402.network import DriveNetwork

        self._network = DriveNetwork(_open(self._bus_options))
        spec = self._plant.spec.pan_tilt
        ranges = (spec.pan_min, spec.pan_max), (spec.tilt_min, spec.tilt_max)
        for node, limits, begin in zip(self.nodes.values(), ranges, self._begin, strict=True):
            self._drives[node] = self._drive(node, limits, begin)
        self._plant.joints = self.angles_at
        for drive in self._drives.values():
            drive.boot()
        self._running.set()
        self._thread.start()

    def close(self) -> None:
        """Leave the bus; may be called twice."""
        if not self._running.is_set():
            return
        self._running.clear()
        if threading.current_thread() is not self._thread:
            self._thread.join()
        bus, self._network.bus = self._network.bus, None
        if bus is not None:
            bus.shutdown()

    def angles_at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time of the plant within the last seconds [s]."""
        moment = time.monotonic() + (stamp - self._plant.now)
        with self._lock:
            pan, tilt = (drive.servo.axis.at(moment)[0] / self._units for drive in self._drives.values())
        return pan, tilt

    def state(self, axis: str) -> State:
        """Return the state of the drive of ``pan`` or ``tilt``."""
        return self._of(axis).state

    def raise_emergency(self, axis: str, code: int, seconds: float = 0.0) -> None:
        """Let a drive fail with an error code whose cause lasts ``seconds``."""
        with self._lock:
            self._of(axis).fail(code, seconds)

    def silence(self, axis: str, seconds: float | None = None) -> None:
        """Cut a drive off the bus, for some time [s] or until `resume`; it goes on as it does alone."""
        with self._lock:
            self._silent[self.nodes[axis]] = math.inf if seconds is None else time.monotonic() + seconds
            self._network.silent.add(self.nodes[axis])

    def resume(self, axis: str) -> None:
        """Put a drive back on the bus."""
        with self._lock:
            self._silent.pop(self.nodes[axis], None)
            self._network.silent.discard(self.nodes[axis])

    def restart(self, axis: str) -> None:
        """Switch a drive off and on again: it forgets what it was told, but not where it stands."""
        with self._lock:
            self._of(axis).boot()

    def _of(self, axis: str) -> Drive:
        return self._drives[self.nodes[axis]]

    def _drive(self, number: int, limits: tuple[float, float], begin: float) -> Drive:
        from canopen import LocalNode

        low, high = (limit * self._units for limit in limits)
        dictionary = object_dictionary(
            number, units_per_degree=self._per_degree, limits=(math.floor(low), math.ceil(high))
        )
        node = LocalNode(number, dictionary)
        node.associate_network(self._network)
        stop, switch, first = _STOP * self._units, _SWITCH * self._units, begin * self._units
        axis = Axis(low - stop, high + stop, first)
        servo = Servo(node, axis, origin=first)
        return Drive(node, servo, _LimitSwitches(axis, low - switch, high + switch), time.monotonic)

    def _run(self) -> None:
        bus, due = self._network.bus, time.monotonic()
        assert bus is not None
        while self._running.is_set():
            message = _receive(bus, max(due - time.monotonic(), 0.0))
            with self._lock:
                if message is not None:
                    self._dispatch(message.arbitration_id, bytes(message.data))
                if time.monotonic() >= due:
                    self._tick()
                    due = max(due + _TICK, time.monotonic())

    def _tick(self) -> None:
        now = time.monotonic()
        for axis, node in self.nodes.items():
            if self._silent.get(node, math.inf) <= now:
                self.resume(axis)
        self._network.send_due(now)
        for drive in self._drives.values():
            drive.tick()

    def _dispatch(self, identifier: int, data: bytes) -> None:
        for node, drive in self._drives.items():
            if node in self._silent:
                continue
            if identifier == NMT and len(data) >= 2:
                drive.on_nmt(data[0], data[1])
            elif identifier == SYNC:
                drive.on_sync()
            elif identifier == SDO_REQUEST + node:
                if len(data) == _FRAME:
                    drive.on_sdo(data)
            elif HEARTBEAT < identifier <= HEARTBEAT + _NODE:
                drive.on_heartbeat(identifier - HEARTBEAT)
            else:
                drive.on_pdo(identifier, data)


def _open(options: dict[str, Any]) -> can.BusABC:
    import can

    for library in ("can", "canopen"):  # they have much to say of foreign masters' mistakes
        logging.getLogger(library).addHandler(logging.NullHandler())
    if options["interface"] == "udp_multicast":
        bus = can.Bus(**{"fd": False, "hop_limit": 0, **options})
        # Linux would hand us what others send on other groups of the same port.
        with contextlib.suppress(OSError), socket.socket(fileno=os.dup(bus.fileno())) as line:
            line.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
        return bus
    return can.Bus(**options)


def _receive(bus: can.BusABC, timeout: float) -> can.Message | None:
    """Return the next data frame, if one comes in time."""
    import can

    try:
        message = bus.recv(timeout)
    except (can.CanError, OSError):  # not a frame, or a bus that is down: wait for a better one
        time.sleep(_TICK)
        return None
    if message is None or message.is_error_frame or message.is_remote_frame or message.is_extended_id:
        return None
    return message

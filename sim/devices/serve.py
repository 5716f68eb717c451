"""The simulated robot as hardware: its body and all its devices, each behind its own wire."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, cast

from sim.devices.plant import Plant
from sim.devices.robot_file import write_robot_file
from zavis_bt.errors import DeviceError

if TYPE_CHECKING:
    from sim.devices.arcos import ArcosServer
    from sim.devices.camera import CameraServer
    from sim.devices.scip import ScipServer
    from sim.noise import NoiseSettings
    from sim.world import World
    from zavis_bt.types import Pose2D, RobotSpec

_P3DX = ("p3dx", "pioneer3dx")  # how the names of robots begin that answer as a Pioneer 3-DX
_DECELERATION = 1.0  # [m/s²] the base is asked for: a time-out then does not let it roll on for long


class _Server(Protocol):
    port: int

    def start(self) -> None: ...
    def close(self) -> None: ...


def _reached_at(host: str) -> str:
    """Return where a program on this computer reaches what listens at ``host``."""
    return "127.0.0.1" if host in ("", "0.0.0.0") else host


def _own_channel() -> str:
    return f"zavis-{uuid.uuid4().hex[:12]}"


@dataclass(frozen=True, slots=True)
class Places:
    """Where the devices are to be found; by default where nobody else is: free ports, and a CAN bus in this process."""

    host: str = "127.0.0.1"
    base: int = 0
    """TCP port of the base; 0 = any free one."""
    lidar: int = 0
    """The same of the LiDAR."""
    camera: int = 0
    """The same of the camera."""
    can_interface: str = "virtual"
    """Kind of CAN bus, as python-can calls it."""
    can_channel: str = field(default_factory=_own_channel)
    """Its channel: a group for ``udp_multicast``, any name for ``virtual``."""
    can_options: Mapping[str, Any] = field(default_factory=dict)
    """Further arguments for python-can. Groups of ``udp_multicast`` on one computer hear one another unless their
    ``port`` differs."""


class SimulatedDevices:
    """A robot in a world that answers on real sockets and a CAN bus: a context that opens and closes all of it.

    The parts are there to be looked at and to be broken: ``plant``, ``base``, ``serial``, ``lidar``, ``camera``,
    ``pan_tilt``.
    """

    def __init__(
        self,
        world: World,
        spec: RobotSpec,
        start: Pose2D,
        *,
        seed: int = 0,
        noise: NoiseSettings | None = None,
        places: Places | None = None,
        watchdog: float = 1.0,
        serial: bool = False,
    ) -> None:
        """Put the robot down and listen; time passes and devices answer from `start` on.

        Args:
            world: Where.
            spec: The robot's model; one whose name begins with ``p3dx`` or ``pioneer3dx`` answers as such.
            start: Its first pose in the map.
            seed: Of all randomness.
            noise: Imperfections; none by default.
            places: Where the devices are to be found.
            watchdog: The base stops if its client says nothing for so long [s]; 0 = never.
            serial: Whether to offer the base at a pseudo-terminal, too.

        Raises:
            InputError: The robot does not fit at the start.
            DeviceError: A port is taken; what was open is closed again.
        """
        from sim.devices.arcos import P3AT, P3DX, ArcosPty, Firmware
        from sim.devices.cia402 import Cia402Drives

        self.places = at = places or Places()
        self.plant = Plant(world, spec, start, seed, noise)
        firmware = Firmware(self.plant, P3DX if spec.name.startswith(_P3DX) else P3AT, watchdog=watchdog)
        self._makers = _makers(self.plant, at.host, firmware)
        self.pan_tilt = Cia402Drives(self.plant, interface=at.can_interface, channel=at.can_channel, **at.can_options)
        self.serial = ArcosPty(self.plant, firmware=firmware) if serial else None
        self._servers: dict[str, _Server] = {}
        try:
            for kind, port in (("base", at.base), ("lidar", at.lidar), ("camera", at.camera)):
                self._servers[kind] = self._makers[kind](port)
        except BaseException:
            self.close()
            raise

    def start(self) -> None:
        """Let time pass and the devices answer.

        Raises:
            DeviceError: The CAN bus cannot be opened; everything is closed again.
        """
        try:
            self._start_pan_tilt()
            self.plant.start()
            for server in (*self._servers.values(), self.serial):
                if server is not None:
                    server.start()
        except BaseException:
            self.close()
            raise

    @property
    def base(self) -> ArcosServer:
        """The base's line."""
        return cast("ArcosServer", self._servers["base"])

    @property
    def lidar(self) -> ScipServer:
        """The LiDAR's line."""
        return cast("ScipServer", self._servers["lidar"])

    @property
    def camera(self) -> CameraServer:
        """The camera's line."""
        return cast("CameraServer", self._servers["camera"])

    def cut(self, kind: str) -> None:
        """Take the line of ``base``, ``lidar`` or ``camera`` away: clients are cut off, new ones refused."""
        self._servers[kind].close()

    def reconnect(self, kind: str) -> None:
        """Listen again where a line was cut.

        Raises:
            DeviceError: Somebody else has taken its port.
        """
        self._servers[kind] = self._makers[kind](self._servers[kind].port)
        self._servers[kind].start()

    def clients(self) -> dict[str, int]:
        """Return how many programs are connected to each line, as far as the line can tell."""
        from sim.devices.arcos import Phase

        connected = self.base.firmware.phase is Phase.CLOSE
        return {"base": int(connected), "lidar": self.lidar.clients, "camera": self.camera.clients}

    def settings(self) -> dict[str, dict[str, Any]]:
        """Return the devices of a robot file that fits, by kind: ``driver`` and ``settings``."""

        def device(driver: str, **settings: Any) -> dict[str, Any]:
            return {"driver": driver, "settings": settings}

        def port(kind: str) -> str:
            return f"tcp://{_reached_at(self.places.host)}:{self._servers[kind].port}"

        bus: dict[str, Any] = {"interface": self.places.can_interface, "channel": self.places.can_channel}
        if self.places.can_options:
            bus["options"] = dict(self.places.can_options)
        return {
            "base": device("pioneer", port=port("base"), deceleration=_DECELERATION),
            "pan_tilt": device("cia402", **bus),
            "lidar": device("scip", port=port("lidar")),
            "camera": device("sim", port=port("camera")),
        }

    def robot_file(self, folder: Path, settings: Mapping[str, Mapping[str, Any]] | None = None) -> Path:
        """Write a robot file whose drivers find these devices.

        Args:
            folder: Where to put it.
            settings: By kind, further settings of its driver, or other values of those that are there.

        Returns:
            The file ``simulated.robot.yaml``.

        Raises:
            InputError: It cannot be written.
        """
        devices = self.settings()
        for kind, further in (settings or {}).items():
            devices[kind]["settings"] |= further
        path = folder / "simulated.robot.yaml"
        write_robot_file(path, self.plant.spec, devices)
        return path

    def close(self) -> None:
        """Hang up, then stop time; may be called twice."""
        for part in (*self._servers.values(), self.serial, self.pan_tilt):
            if part is not None:
                part.close()
        self.plant.close()

    def __enter__(self) -> SimulatedDevices:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _start_pan_tilt(self) -> None:
        import can

        place = f"CAN bus {self.places.can_interface} {self.places.can_channel}"
        try:
            taken = self._roll_call()
            if not taken:
                self.pan_tilt.start()
        except (can.CanError, OSError, ImportError, ValueError) as error:  # whatever the bus is made of
            why = " ".join(str(error).split()) or type(error).__name__
            raise DeviceError(f"{place}: cannot be opened: {why} (is it up? choose another with --can)") from error
        if taken:
            raise DeviceError(
                f"{place}: node {taken[0]} is there already (end the other simulator, or choose another bus with --can)"
            )

    def _roll_call(self) -> list[int]:
        """Return which of our node numbers others have on a bus that is shared with other programs."""
        import can

        from sim.devices.can_roll_call import nodes_present

        if self.places.can_interface == "virtual":
            return []
        places = self.places
        options: dict[str, Any] = {"fd": False, "hop_limit": 0} if places.can_interface == "udp_multicast" else {}
        options |= places.can_options
        with can.Bus(interface=places.can_interface, channel=places.can_channel, **options) as bus:
            return nodes_present(bus, self.pan_tilt.nodes.values())


def _makers(plant: Plant, host: str, firmware: Any) -> Mapping[str, Callable[[int], _Server]]:
    from sim.devices.arcos import ArcosServer
    from sim.devices.camera import CameraServer
    from sim.devices.scip import ScipServer

    return {
        "base": lambda port: ArcosServer(plant, host=host, port=port, firmware=firmware),
        "lidar": lambda port: ScipServer(plant, host=host, port=port),
        "camera": lambda port: CameraServer(plant, host=host, port=port),
    }

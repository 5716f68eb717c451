"""What the computer must have for a robot's devices: packages, rights, ports, buses."""

from __future__ import annotations

import getpass
import grp
import importlib.util
import os
import platform
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zavis_bt.mission import RobotFile

_PACKAGES = {"serial": "pyserial", "can": "python-can", "canopen": "canopen", "cv2": "opencv-python-headless"}
_REALSENSE = "pyrealsense2"
_NET = Path("/sys/class/net")
_CAN_TYPE = "280"  # ARPHRD_CAN


@dataclass(frozen=True, slots=True)
class Computer:
    """The computer as a robot's devices see it."""

    figures: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether all is well."""
        return not self.problems


def look_at_computer(file: RobotFile | None) -> Computer:
    """Return what this computer has, and what a robot's devices miss on it.

    Args:
        file: The robot; None looks at the computer alone.
    """
    from zavis_bt import __version__

    figures = {
        "zavis_bt": f"{__version__} on Python {platform.python_version()}, {platform.system()} {platform.machine()}",
        "serial ports": ", ".join(serial_ports()) or "none",
        "may use serial ports": "yes" if may_use_serial() else "no (sudo usermod -aG dialout $USER, then log in again)",
        "CAN interfaces": ", ".join(f"{name} ({state})" for name, state in can_interfaces().items()) or "none",
        _REALSENSE: "installed" if _installed(_REALSENSE) else "not installed (pip install 'zavis_bt[robot]')",
    }
    return Computer(figures, () if file is None else tuple(_missing(file)))


def serial_ports() -> list[str]:
    """Return the serial ports that are plugged in, by their lasting names where there are any."""
    lasting = sorted(str(path) for path in Path("/dev/serial/by-id").glob("*"))
    return lasting or sorted(str(path) for pattern in ("ttyUSB*", "ttyACM*") for path in Path("/dev").glob(pattern))


def may_use_serial() -> bool:
    """Return whether this user may open serial ports: as root, or in the group ``dialout``."""
    if os.geteuid() == 0:
        return True
    try:
        group = grp.getgrnam("dialout")
    except KeyError:  # other systems have other rules; opening the port will tell
        return True
    return group.gr_gid in os.getgroups() or getpass.getuser() in group.gr_mem


def can_interfaces() -> dict[str, str]:
    """Return the kernel's CAN interfaces and whether each is up."""
    return {path.name: _state(path) for path in sorted(_NET.glob("*")) if _read(path / "type") == _CAN_TYPE}


def _state(path: Path) -> str:
    flags = int(_read(path / "flags") or "0", 16)
    return "up" if flags & 1 else "down"


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:  # interfaces come and go
        return ""


def _installed(package: str) -> bool:
    return importlib.util.find_spec(package) is not None


def _missing(file: RobotFile) -> Iterator[str]:
    for module, package in _PACKAGES.items():
        if not _installed(module):
            yield f"the package {package} is missing (pip install {package})"
    devices = file.devices.values()
    if any(device.driver == "realsense" for device in devices) and not _installed(_REALSENSE):
        yield f"the package {_REALSENSE} is missing (pip install 'zavis_bt[robot]')"
    ports = [str(device.settings.get("port", "")) for device in devices]
    if any(port.startswith("/dev/tty") for port in ports) and not may_use_serial():
        yield "this user may not use serial ports (sudo usermod -aG dialout $USER, then log in again)"
    for device in devices:
        if device.settings.get("interface") == "socketcan":
            yield from _can_problem(str(device.settings.get("channel", "can0")))


def _can_problem(name: str) -> Iterator[str]:
    state = can_interfaces().get(name)
    if state is None:
        yield f"there is no CAN interface {name} (plug the adapter in; 'ip link' lists what is there)"
    elif state == "down":
        yield f"the CAN interface {name} is down (sudo ip link set {name} up type can bitrate 500000)"

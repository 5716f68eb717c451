"""What the computer has for a robot's devices: packages, rights, ports, buses."""

from __future__ import annotations

import getpass
import grp
import importlib.util
import os
import platform
from pathlib import Path

_REALSENSE = "pyrealsense2"
_NET = Path("/sys/class/net")
_CAN_TYPE = "280"  # ARPHRD_CAN


def look_at_computer() -> dict[str, str]:
    """Return what this computer has for devices: names and values in words."""
    from zavis_bt import __version__

    realsense = importlib.util.find_spec(_REALSENSE) is not None
    return {
        "zavis_bt": f"{__version__} on Python {platform.python_version()}, {platform.system()} {platform.machine()}",
        "serial ports": ", ".join(serial_ports()) or "none",
        "may use serial ports": "yes" if may_use_serial() else "no (sudo usermod -aG dialout $USER, then log in again)",
        "CAN interfaces": ", ".join(f"{name} ({state})" for name, state in can_interfaces().items()) or "none",
        _REALSENSE: "installed" if realsense else "not installed (only for RealSense: pip install 'zavis_bt[robot]')",
    }


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

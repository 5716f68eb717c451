"""Opening a CAN bus, with what can be wrong in plain words."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import socket
from typing import TYPE_CHECKING

from drivers.pan_tilt.objects import EMCY, HEARTBEAT, SDO_ANSWER, TPDO1, TPDO2
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.trouble import Trouble
from zavis_bt.errors import did_you_mean

if TYPE_CHECKING:
    import can

_FROM_DRIVES = (EMCY, TPDO1, TPDO2, SDO_ANSWER, HEARTBEAT)
_IP_MULTICAST_ALL = 49  # of linux/in.h
_ADAPTERS = ("slcan", "serial", "robotell", "seeedstudio")


def open_bus(settings: PanTiltSettings) -> can.BusABC:
    """Open the bus, to hear nothing but the two drives.

    Without the filter a bus that echoes, as udp_multicast does, would hand us our own frames.

    Raises:
        Trouble: It cannot be opened.
    """
    import can

    for library in ("can", "canopen"):  # what they have to say is said here, in other words
        logging.getLogger(library).setLevel(logging.CRITICAL)
    if settings.interface not in can.VALID_INTERFACES:
        known = did_you_mean(settings.interface, can.VALID_INTERFACES)
        raise Trouble(f"there is no kind of CAN interface '{settings.interface}'{known or ' (socketcan is the usual)'}")
    options = {"bitrate": settings.bitrate}
    if settings.interface == "udp_multicast":
        options |= {"fd": False, "hop_limit": 0}
    try:
        bus = can.Bus(interface=settings.interface, channel=settings.channel, **{**options, **settings.options})
    except Exception as error:  # python-can's back ends let OSError, NameError, TypeError, … through
        raise Trouble(explain(error, settings)) from error
    if settings.interface == "udp_multicast":
        _hear_own_group_only(bus)
    nodes = settings.pan_node, settings.tilt_node
    bus.set_filters(
        [{"can_id": base + node, "can_mask": 0x7FF, "extended": False} for base in _FROM_DRIVES for node in nodes]
    )
    return bus


def _hear_own_group_only(bus: can.BusABC) -> None:
    """Keep out what others send on other groups of the same port, which Linux hands to every socket otherwise."""
    with contextlib.suppress(OSError), socket.socket(fileno=os.dup(bus.fileno())) as line:
        line.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)


def explain(error: BaseException, settings: PanTiltSettings) -> str:
    """Say in one line what is wrong with the bus and what helps."""
    name = f"CAN {settings.interface} '{settings.channel}'"
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, ModuleNotFoundError):
            return f"{name}: needs the Python package '{cause.name}' (pip install it)"
        if isinstance(cause, socket.gaierror):
            return f"{name}: no such address (a multicast group such as 239.74.163.2, or a host's name)"
        if isinstance(cause, OSError) and cause.errno in _REMEDIES:
            return f"{name}: {_REMEDIES[cause.errno](settings)}"
        code = getattr(cause, "error_code", None)
        if code in _REMEDIES:
            return f"{name}: {_REMEDIES[code](settings)}"
        cause = cause.__cause__ or cause.__context__
    return f"{name}: {' '.join(str(error).split()) or type(error).__name__} (is the adapter's own library installed?)"


def _absent(settings: PanTiltSettings) -> str:
    if settings.interface == "socketcan":
        return "there is no such interface ('ip link' lists them; plug the adapter in, or load its driver)"
    return _route(settings) if settings.interface == "udp_multicast" else "there is no such device (is it plugged in?)"


def _down(settings: PanTiltSettings) -> str:
    remedy = f"sudo ip link set {settings.channel} up type can bitrate {settings.bitrate}"
    return f"the interface is down ({remedy if settings.interface == 'socketcan' else 'switch it on'})"


def _route(settings: PanTiltSettings) -> str:
    return "no way for multicast (sudo ip link set lo multicast on; sudo ip route add 239.0.0.0/8 dev lo)"


def _permission(settings: PanTiltSettings) -> str:
    group = (
        "sudo usermod -aG dialout $USER, then log in again" if settings.interface in _ADAPTERS else "run it with sudo"
    )
    return f"permission denied ({group})"


def _kernel(settings: PanTiltSettings) -> str:
    return "this kernel has no SocketCAN (sudo modprobe can_raw, or take another interface)"


def _no_port(settings: PanTiltSettings) -> str:
    return "there is no such port (plug the adapter in; 'ls /dev/serial/by-id' lists what is there)"


def _argument(settings: PanTiltSettings) -> str:
    if settings.interface == "udp_multicast":
        return "is no multicast address (take one such as 239.74.163.2)"
    return "the interface refuses these settings (is its bitrate one it can do?)"


def _gone(settings: PanTiltSettings) -> str:
    return "the adapter has gone (is its cable plugged in?)"


def _silent(settings: PanTiltSettings) -> str:
    return "nobody takes our frames (is the bus cable plugged in and terminated, and is the bitrate right?)"


def _refused(settings: PanTiltSettings) -> str:
    return "nothing listens there (is the server running?)"


_REMEDIES = {
    errno.ENODEV: _absent,
    errno.ENXIO: _gone,
    errno.EIO: _gone,
    errno.ENETDOWN: _down,
    errno.ENETUNREACH: _route,
    errno.EADDRNOTAVAIL: _route,
    errno.EPERM: _permission,
    errno.EACCES: _permission,
    errno.EAFNOSUPPORT: _kernel,
    errno.EPROTONOSUPPORT: _kernel,
    errno.ENOENT: _no_port,
    errno.EINVAL: _argument,
    errno.ENOBUFS: _silent,
    errno.ETIMEDOUT: _refused,
    errno.ECONNREFUSED: _refused,
}

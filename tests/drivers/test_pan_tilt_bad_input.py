from __future__ import annotations

import errno
import re
import socket
from typing import Any

import can
import pytest
from pan_tilt_bench import WHERE, Body, drives_on, new_bus

from drivers.pan_tilt import PanTiltSettings, open_pan_tilt
from drivers.pan_tilt.bus import explain
from zavis_bt.errors import DeviceError, InputError


def complaint(settings: dict[str, Any]) -> str:
    with pytest.raises(DeviceError) as raised:
        open_pan_tilt({"sdo_timeout": 0.1, **settings}, Body().context())
    text = str(raised.value)
    assert text.startswith(f"{WHERE}: ")
    assert "\n" not in text
    assert "(" in text
    return text


def test_an_unknown_kind_of_interface_gets_a_suggestion() -> None:
    assert "did you mean 'socketcan'" in complaint({"interface": "socketcann"})


def test_an_absent_socketcan_interface_is_told_with_the_remedy() -> None:
    text = complaint({"interface": "socketcan", "channel": "nocan9"})
    assert re.search(r"CAN socketcan 'nocan9': (there is no such interface|this kernel has no SocketCAN)", text)


def test_an_absent_serial_adapter_is_told_with_the_remedy() -> None:
    assert "/dev/serial/by-id" in complaint({"interface": "slcan", "channel": "/dev/no-such-port"})


@pytest.mark.parametrize("channel", ["10.0.0.1", "no address"])
def test_what_is_no_multicast_group_is_told(channel: str) -> None:
    assert "239.74.163.2" in complaint({"interface": "udp_multicast", "channel": channel})


def test_an_empty_bus_names_the_drive_that_is_missing() -> None:
    assert "pan (node 1) does not answer (is it powered" in complaint(new_bus())


def test_a_node_that_is_no_drive_is_told() -> None:
    bus = new_bus()
    with drives_on(bus) as (drives, _):
        drives._drives[1].node.object_dictionary[0x1000].default = 0x0003_0191
        text = complaint({**bus, "sdo_timeout": 2.0})
    assert "pan (node 1) is no CiA 402 drive (its device type is 00030191" in text


def test_a_drive_without_the_mode_asked_for_is_told() -> None:
    bus = new_bus()
    with drives_on(bus) as (drives, _):
        drives._drives[2].node.object_dictionary[0x6502].default = 0x25
        text = complaint({**bus, "sdo_timeout": 2.0})
    assert "tilt (node 2) has no mode 'cyclic position'" in text


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.ENODEV, "no such interface"),
        (errno.ENETDOWN, "sudo ip link set can7 up type can bitrate 250000"),
        (errno.EPERM, "permission denied"),
        (errno.EAFNOSUPPORT, "no SocketCAN"),
        (errno.ENOBUFS, "terminated"),
        (errno.EINVAL, "refuses these settings"),
    ],
)
def test_each_failure_of_a_bus_has_its_remedy(number: int, words: str) -> None:
    settings = PanTiltSettings(channel="can7", bitrate=250_000)
    assert words in explain(OSError(number, "whatever"), settings)
    wrapped = can.CanOperationError("sending failed", error_code=number)
    assert words in explain(wrapped, settings)


def test_multicast_without_a_way_and_missing_libraries_are_told() -> None:
    udp = PanTiltSettings(interface="udp_multicast", channel="239.1.1.1")
    assert "ip route add 239.0.0.0/8" in explain(OSError(errno.ENODEV, "x"), udp)
    assert "ip route add 239.0.0.0/8" in explain(OSError(errno.ENETUNREACH, "x"), udp)
    assert "multicast group" in explain(socket.gaierror(-2, "x"), udp)
    assert "pip install" in explain(ModuleNotFoundError("x", name="usb"), udp)
    assert "library" in explain(NameError("canGetNumberOfChannels"), udp)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"chanel": "can0"}, "did you mean 'channel'"),
        ({"pan_node": 0}, "pan_node"),
        ({"pan_node": 2, "tilt_node": 2}, "must differ"),
        ({"units_per_degree": 10, "units_per_radian": 10}, "either"),
        ({"mode": "torque"}, "cyclic"),
        ({"heartbeat": 0.4, "heartbeat_timeout": 0.5}, "twice"),
        ({"homing": {"methode": 3}}, "method"),
    ],
)
def test_wrong_settings_are_refused_in_one_line(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as raised:
        open_pan_tilt(settings, Body().context())
    assert str(raised.value).startswith(f"{WHERE}.settings")

"""Connecting to robots in every state, and to what is no robot."""

from __future__ import annotations

import contextlib
import math
import socket
import threading
from collections.abc import Iterator

import pytest
from pioneer_robot import NUMBER, ScriptedRobot, context, opened, wait_for

from drivers.pioneer import open_base
from drivers.pioneer.codec import Config, Flags, Sip, encode_command, encode_sip, encode_sync
from drivers.pioneer.handshake import judge
from zavis_bt.errors import DeviceError, InputError


def test_connecting_synchronises_opens_sets_limits_and_switches_the_motors_on() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        assert robot.syncs == [0, 1, 2]
        told = [(command.number, command.argument) for _, command in robot.heard]
        assert told[:2] == [(NUMBER.OPEN, 1), (NUMBER.CONFIG, 1)]
        limits = context().spec.limits
        turn = round(math.degrees(limits.angular_acceleration))
        for expected in (
            (NUMBER.SETV, round(limits.max_linear * 1000)),
            (NUMBER.SETA, round(limits.linear_acceleration * 1000)),
            (NUMBER.SETA, -round(limits.linear_acceleration * 1000)),
            (NUMBER.SETRV, round(math.degrees(limits.max_angular))),
            (NUMBER.SETRA, turn),
            (NUMBER.SETRA, -turn),
            (NUMBER.ENABLE, 1),
        ):
            assert expected in told
        assert base.state().fault == ""
        assert robot.velocities() == []


def test_limits_beyond_the_robots_top_are_clipped_and_reported() -> None:
    weak = Config(velocity_top=400, rotation_velocity_top=60, acceleration_top=200, watchdog=1000)
    with ScriptedRobot(config=weak) as robot, opened(robot, deceleration=5.0) as base:
        told = [(command.number, command.argument) for _, command in robot.heard]
        assert {(NUMBER.SETV, 400), (NUMBER.SETRV, 60), (NUMBER.SETA, 200), (NUMBER.SETA, -200)} <= set(told)
        problems = base.report().problems
        assert any("max_linear" in problem for problem in problems)
        assert any("max_angular_deg" in problem for problem in problems)


def test_a_robot_that_misses_the_first_syncs_is_asked_again() -> None:
    with ScriptedRobot() as robot:
        robot.sync_reply = lambda number: robot.usual_reply(number) if len(robot.syncs) > 2 else None
        with opened(robot):
            assert robot.syncs == [0, 0, 0, 1, 2]


def test_a_robot_out_of_step_is_brought_back_to_the_beginning() -> None:
    with ScriptedRobot() as robot:
        wrong = {2: encode_sync(2), 4: b"\xfa\xfb\x03\xff\x00\xff"}  # a wrong number, then 'out of step'
        robot.sync_reply = lambda number: wrong.get(len(robot.syncs)) or robot.usual_reply(number)
        with opened(robot):
            assert robot.syncs == [0, 1, 0, 1, 0, 1, 2]


def test_a_robot_still_connected_to_somebody_is_closed_and_met_anew() -> None:
    with ScriptedRobot() as robot:
        robot.sync_reply = lambda number: encode_sip(Sip()) if len(robot.syncs) == 1 else robot.usual_reply(number)
        robot.ends_on_close = False
        with opened(robot):
            assert robot.numbers()[0] == NUMBER.CLOSE


def test_a_half_open_robot_is_shaken_loose(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.pioneer.handshake._REPLY", 0.1)
    with ScriptedRobot() as robot:
        robot.sync_reply = lambda number: robot.usual_reply(number) if robot.heard else None
        with opened(robot):
            assert robot.numbers()[0] == NUMBER.OPEN


def test_a_robot_without_configuration_can_be_driven_and_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.pioneer.handshake._CONFIG_EVERY", 0.05)
    with ScriptedRobot() as robot:
        robot.config = None
        with opened(robot) as base:
            assert robot.numbers().count(NUMBER.CONFIG) == 5
            assert any("configuration" in problem for problem in base.report().problems)


def test_an_unknown_subclass_is_reported_and_can_be_set() -> None:
    with ScriptedRobot(subclass="amigo") as robot:
        with opened(robot) as base:
            assert any("amigo" in problem for problem in base.report().problems)
        assert wait_for(lambda: not robot.opened or robot.connections)
        with opened(robot, subclass="p3dx-sh") as base:
            assert base.report().problems == ()


@pytest.mark.parametrize(("watchdog", "says"), [(2000, "2000 ms"), (0, "is off")])
def test_a_watchdog_that_lets_the_base_run_is_reported_with_the_remedy(watchdog: int, says: str) -> None:
    with ScriptedRobot(config=Config(watchdog=watchdog)) as robot, opened(robot) as base:
        [problem] = base.report().problems
        assert says in problem
        assert "1000 ms" in problem


def test_the_name_plate_and_figures_are_reported() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        assert wait_for(lambda: base.report().figures["status packets"] != "unknown")
        report = base.report()
        assert (report.model, report.firmware, report.serial) == ("Pioneer p3at-sh 'tester'", "2.6", "S1")
        assert report.figures["battery"] == "12.5 V"
        assert report.figures["checksum errors"] == "0"
        assert report.problems == ()


def test_motors_that_do_not_go_on_at_once_are_asked_again() -> None:
    with ScriptedRobot() as robot:
        robot.deaf_to = {NUMBER.ENABLE}
        threading.Timer(0.15, robot.deaf_to.clear).start()
        with opened(robot) as base:
            assert base.state().fault == ""
            assert robot.numbers().count(NUMBER.ENABLE) > 1


def test_motors_that_never_go_on_are_a_fault_with_the_remedy() -> None:
    with ScriptedRobot() as robot:
        robot.deaf_to = {NUMBER.ENABLE}
        with opened(robot) as base:
            assert "MOTORS button" in base.state().fault


def test_a_stop_button_that_is_pressed_when_connecting_is_told() -> None:
    with ScriptedRobot() as robot:
        robot.deaf_to = {NUMBER.ENABLE}
        robot.sip = robot.sip._replace(flags=int(Flags.STOP_PRESSED))
        with opened(robot) as base:
            assert base.state().estop
            assert "STOP button" in base.state().fault


@contextlib.contextmanager
def other_device(answer: bytes, echo: bool = False) -> Iterator[str]:
    """Serve something that is no robot, on a TCP port."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            with contextlib.suppress(OSError):
                line, _ = server.accept()
                with line:
                    while data := line.recv(100):
                        line.sendall(data if echo else answer)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
        thread.join(10)


@pytest.mark.parametrize(
    ("answer", "echo", "says"),
    [
        (b"", False, r"no answer \(is the robot switched on"),
        (b"0E\r\n\r\n", False, r"answers, but not as a Pioneer: '0E 0E.*LiDAR"),
        (b"\x81\x00\xfe\xe0", False, "answers, but not as a Pioneer: bytes 81 00 fe e0.*baud"),
        (b"", True, "sends back what it is told"),
    ],
)
def test_what_is_no_robot_is_told_in_one_line(
    answer: bytes, echo: bool, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("drivers.pioneer.handshake._REPLY", 0.1)
    with other_device(answer, echo) as url, pytest.raises(DeviceError, match=says) as caught:
        open_base({"port": url}, context())
    message = str(caught.value)
    assert message.startswith(f"my.robot.yaml: devices.base: {url}: ")
    assert "\n" not in message


def test_a_robot_that_never_reports_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.pioneer.base._FIRST_SIP", 0.3)
    with ScriptedRobot() as robot:
        robot.sends = False
        with pytest.raises(DeviceError, match=r"silent for 0.3 s \(is the robot on"):
            open_base({"port": robot.url}, context())
        assert NUMBER.CLOSE in robot.numbers()


def test_a_closed_port_is_told() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(DeviceError, match="nothing listens there"):
        open_base({"port": f"tcp://127.0.0.1:{port}"}, context())


def test_wrong_settings_are_told() -> None:
    with pytest.raises(InputError, match=r"settings.prot: unknown setting \(did you mean 'port'\?\)"):
        open_base({"port": "tcp://x:1", "prot": 1}, context())
    with pytest.raises(InputError, match=r"settings.baud"):
        open_base({"port": "/dev/null", "baud": 1234}, context())


def test_bytes_of_a_robot_that_ignores_the_handshake_are_told_from_another_device() -> None:
    assert "like a Pioneer" in judge(encode_sip(Sip()))
    assert "other" in judge(encode_command(NUMBER.PULSE)[2:] + b"\x99\x88")

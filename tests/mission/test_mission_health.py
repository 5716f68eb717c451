"""Devices that fail in the middle of a mission: the base stops, the tree waits, and goes on or ends with the reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from faulty_robot import DEVICES, FaultyRobot
from flat_mission import Flat, Watcher

from zavis_bt.errors import DeviceError
from zavis_bt.mission import MissionSettings, SafePanTilt, SafetySettings
from zavis_bt.types import Observed, PanTiltState, Twist2D

BEGIN = 0.8
"""When the fault begins [s]: the base is at speed."""


class Trouble(Watcher):
    """Does and undoes something at times."""

    def __init__(self, begin: Callable[[], None], end: Callable[[], None] = lambda: None, lasting: float = 1e9) -> None:
        super().__init__()
        self._acts = [(BEGIN, begin), (BEGIN + lasting, end)]
        self.speed: list[tuple[float, float]] = []

    def on_tick(self, mission: Observed) -> None:
        super().on_tick(mission)
        while self._acts and mission.stamp >= self._acts[0][0] - 1e-9:
            self._acts.pop(0)[1]()


class Hurt:
    """A mission in the flat on a robot that gets hurt."""

    def __init__(self, folder: Path, node: str = "drive_and_look: {seconds: 4.0}", **safety: float) -> None:
        self.flat = Flat(folder, node, settings=MissionSettings(safety=SafetySettings(**safety)), wrap=self._wrap)
        self.truth: list[tuple[float, Twist2D]] = []
        simulated = self.flat.world

        class Truth(Watcher):
            def on_tick(watcher, mission: Observed) -> None:  # self is the mission that is hurt
                self.truth.append((simulated.clock.now(), simulated.robot.base.state().twist))

        self.flat.mission.observe(Truth())

    def _wrap(self, robot):
        self.robot = FaultyRobot(robot, _ClockOf(robot))
        return self.robot

    def hurt(self, begin: Callable[[FaultyRobot], None], end: Callable[[FaultyRobot], None], lasting: float) -> None:
        self.flat.mission.observe(Trouble(lambda: begin(self.robot), lambda: end(self.robot), lasting))

    def events(self, *kinds: str) -> list[tuple[str, object]]:
        return [(e.kind, e.data.get("device", e.data.get("devices"))) for e in self.flat.events if e.kind in kinds]

    def assert_still(self, since: float, until: float) -> None:
        speeds = [abs(twist.linear) + abs(twist.angular) for stamp, twist in self.truth if since <= stamp < until]
        assert speeds
        assert max(speeds) == 0.0
        assert self.robot.motions(since, until) == []


class _ClockOf:
    def __init__(self, robot) -> None:
        self._base = robot.base

    def now(self) -> float:
        return self._base.state().stamp

    def wait_until(self, stamp: float) -> None: ...


def silence(device: str):
    return lambda robot: robot.silent.add(device), lambda robot: robot.silent.discard(device)


def fault(device: str):
    text = "the drive reports over-temperature (let it cool)"
    return lambda robot: robot.fault.update({device: text}), lambda robot: robot.fault.pop(device)


FAULTS = {
    **{f"{device} silent": (device, silence(device)) for device in DEVICES},
    **{f"{device} fault": (device, fault(device)) for device in ("base", "pan_tilt")},
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_stops_the_base_within_half_a_second_and_the_mission_goes_on_afterwards(tmp_path, name):
    device, (begin, end) = FAULTS[name]
    hurt = Hurt(tmp_path)
    hurt.hurt(begin, end, lasting=2.0)
    result = hurt.flat.mission.run()
    assert (result.success, result.reason) == (True, "arrived")
    assert max(twist.linear for stamp, twist in hurt.truth if stamp < BEGIN) > 0.15
    hurt.assert_still(BEGIN + 0.5, BEGIN + 2.0)
    assert hurt.events("fault", "recovered") == [("fault", device), ("recovered", [device])]
    (recovered,) = (event for event in hurt.flat.events if event.kind == "recovered")
    assert 1.5 < recovered.data["seconds"] <= 2.1
    assert hurt.robot.motions(BEGIN + 2.0)


@pytest.mark.parametrize("device", DEVICES)
def test_a_device_that_stays_away_ends_the_mission_with_the_reason_in_plain_words(tmp_path, device):
    hurt = Hurt(tmp_path, "drive_and_look: {seconds: 60}", device_timeout=3.0)
    hurt.hurt(*silence(device), lasting=1e9)
    result = hurt.flat.mission.run()
    what = {"lidar": "scan", "camera": "frame"}.get(device, "word from it")
    assert not result.success
    assert result.reason == f"{device}: no {what} for 3 s (is it powered and connected?)"
    assert result.sim_seconds == pytest.approx(BEGIN + 3.3, abs=0.31)
    hurt.assert_still(BEGIN + 0.5, 100.0)
    assert hurt.flat.watcher.results == [result]
    hurt.flat.assert_stopped()


def test_faults_at_the_same_time_are_one_outage_that_ends_when_all_are_well(tmp_path):
    hurt = Hurt(tmp_path)
    for device, lasting in (("lidar", 1.0), ("camera", 2.0)):
        hurt.hurt(*silence(device), lasting=lasting)
    assert hurt.flat.mission.run().success
    assert sorted(hurt.events("fault"), key=str) == [("fault", "camera"), ("fault", "lidar")]
    assert hurt.events("recovered") == [("recovered", ["camera", "lidar"])]
    hurt.assert_still(BEGIN + 0.5, BEGIN + 2.0)


def test_time_that_the_tree_was_held_is_not_held_against_a_drive(tmp_path):
    hurt = Hurt(tmp_path, "navigate: {goal: {x: 3.6, y: 2.3, yaw: 0.0}}")
    hurt.hurt(*silence("camera"), lasting=9.0)  # longer than a drive may make no progress
    result = hurt.flat.mission.run()
    assert result.success, result.reason
    assert hurt.events("fault", "recovered") == [("fault", "camera"), ("recovered", ["camera"])]
    assert hurt.flat.world.collisions == 0


def test_a_base_that_refuses_commands_is_left_alone_for_a_while_and_then_driven_again(tmp_path):
    hurt = Hurt(tmp_path)
    hurt.hurt(lambda robot: robot.refusing.add("base"), lambda robot: robot.refusing.discard("base"), lasting=2.0)
    result = hurt.flat.mission.run()
    assert result.success
    faults = [event for event in hurt.flat.events if event.kind == "fault"]
    assert {event.data["reason"] for event in faults} == {"cannot be reached (check its cable)"}
    assert 2 <= len(faults) <= 5  # tried again now and then, not at every tick
    hurt.assert_still(BEGIN + 1.2, BEGIN + 2.0)  # by the base's own watchdog
    assert hurt.robot.motions(BEGIN + 2.0)


def test_a_base_that_goes_on_refusing_ends_the_mission(tmp_path):
    hurt = Hurt(tmp_path, "drive_and_look: {seconds: 60}", device_timeout=3.0)
    hurt.hurt(lambda robot: robot.refusing.add("base"), lambda robot: None, lasting=1e9)
    result = hurt.flat.mission.run()
    assert result.reason == "base: cannot be reached (check its cable)"
    assert result.sim_seconds < BEGIN + 5.0


def test_a_camera_move_that_was_refused_is_made_when_the_unit_can_be_reached_again(tmp_path):
    hurt = Hurt(tmp_path)
    hurt.robot.refusing.add("pan_tilt")  # from the start: DriveAndLook sends it to (3.0, 0.5) in its first tick
    hurt.hurt(lambda robot: robot.refusing.discard("pan_tilt"), lambda robot: None, lasting=1e9)
    assert hurt.flat.mission.run().success
    assert [move for _, move in hurt.robot.moves if move != "stop"] == [(3.0, 0.5)]
    assert hurt.events("fault")[0] == ("fault", "pan_tilt")


def test_a_camera_move_that_a_fault_held_up_is_made_again(tmp_path):
    hurt = Hurt(tmp_path)
    hurt.hurt(*silence("lidar"), lasting=1.0)
    assert hurt.flat.mission.run().success
    moves = [move for _, move in hurt.robot.moves]
    assert moves[0] == (3.0, 0.5)
    assert "stop" in moves[1:-1]
    assert (3.0, 0.5) in moves[moves.index("stop") :]


def test_scans_of_a_lost_base_are_not_mapped(tmp_path, monkeypatch):
    hurt, mapped = Hurt(tmp_path), []
    monkeypatch.setattr(hurt.flat.mission._mapper, "update", lambda scan, pose: mapped.append(scan.stamp))
    hurt.hurt(*silence("base"), lasting=1.0)
    hurt.flat.mission.run()
    assert not [stamp for stamp in mapped if BEGIN + 0.41 < stamp < BEGIN + 1.0]
    assert max(mapped) > BEGIN + 1.0


def test_devices_that_are_well_leave_no_trace(tmp_path):
    hurt = Hurt(tmp_path)
    assert hurt.flat.mission.run().success
    assert hurt.events("fault", "recovered", "safety") == []
    assert "stop" not in [command for _, command in hurt.robot.commands][:-2]


# -- the pan-tilt unit alone ------------------------------------------------------------------------------------------


class Unit:
    def __init__(self) -> None:
        self.moves: list[tuple[float, float] | str] = []
        self.reachable = True

    def state(self) -> PanTiltState:
        return PanTiltState(0.0, 0.0, True, 0.0)

    def angles_at(self, stamp: float) -> tuple[float, float]:
        return (0.0, 0.0)

    def move_to(self, pan: float, tilt: float) -> None:
        if not self.reachable:
            raise DeviceError("pan_tilt: bus off")
        self.moves.append((pan, tilt))

    def stop(self) -> None:
        self.moves.append("stop")


def test_an_owed_move_is_not_settled_until_it_was_made():
    unit = Unit()
    safe = SafePanTilt(unit)
    unit.reachable = False
    safe.move_to(1.0, 0.2)
    assert safe.trouble == "pan_tilt: bus off"
    assert not safe.state().settled
    unit.reachable = True
    safe.resume()
    assert unit.moves == [(1.0, 0.2)]
    assert safe.state().settled
    assert safe.trouble == ""


def test_a_stop_forgets_the_move_and_a_hold_does_not():
    unit = Unit()
    safe = SafePanTilt(unit)
    safe.move_to(1.0, 0.2)
    safe.hold()
    assert not safe.state().settled
    safe.resume()
    safe.stop()
    safe.hold()
    safe.resume()
    assert unit.moves == [(1.0, 0.2), "stop", (1.0, 0.2), "stop", "stop"]

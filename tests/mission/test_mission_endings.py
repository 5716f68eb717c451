"""However a mission ends, the base stands and the run folder is complete."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from faulty_robot import FaultyRobot
from flat_mission import Flat, Watcher

from zavis_bt.errors import DeviceError
from zavis_bt.mission import MissionSettings, SafetySettings
from zavis_bt.mission.orderly_end import OrderlyEnd
from zavis_bt.recording import RunRecorder, load_run

PATIENCE = 90.0  # for a program to start and to end on a busy machine [s]


class Recorded:
    """A mission in the flat that is recorded."""

    def __init__(self, folder: Path, node: str, **options: object) -> None:
        self.flat = Flat(folder, node, **options)
        self.recorder = RunRecorder(folder / "run", {"target": "mug"})
        self.flat.mission.observe(self.recorder, self.recorder.on_event)
        self.folder = folder / "run"

    def assert_in_order(self, reason: str) -> None:
        self.flat.assert_stopped()
        assert self.recorder.problems == []
        run = load_run(self.folder)
        assert run.status == "ended"
        assert run.result is not None
        assert run.result.reason == reason
        assert {"map.yaml", "map.pgm", "map.png", "semantic_map.json", "events.jsonl"} <= {
            file.name for file in self.folder.iterdir()
        }


def test_success(tmp_path):
    recorded = Recorded(tmp_path, "drive_and_look: {seconds: 0.5}")
    assert recorded.flat.mission.run().success
    recorded.assert_in_order("arrived")


def test_failure(tmp_path):
    recorded = Recorded(tmp_path, "parallel: {do: [drive_and_look, {sequence: [{wait: {seconds: 0.5}}, {fail: no}]}]}")
    assert not recorded.flat.mission.run().success
    run = load_run(recorded.folder)
    recorded.assert_in_order(run.result.reason)
    assert run.result.reason.endswith(": no")


def test_a_behaviour_that_raises(tmp_path):
    recorded = Recorded(tmp_path, 'drive_and_look: {seconds: 0.5, ends: "no wheel"}')
    recorded.flat.mission.run()
    recorded.assert_in_order("own/drive_and_look: ValueError: no wheel")


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (KeyboardInterrupt(), "interrupted"),
        (DeviceError("lidar: gone"), "crash: DeviceError: lidar: gone"),
        (ValueError("a bug"), "crash: ValueError: a bug"),
    ],
    ids=lambda value: type(value).__name__,
)
@pytest.mark.parametrize("place", ["read", "flush"])
def test_what_is_raised_between_the_behaviours(tmp_path, monkeypatch, error, reason, place):
    recorded = Recorded(tmp_path, "drive_and_look")
    base = recorded.flat.mission._robot.base
    usual = getattr(base, place)

    def broken(*args: float) -> None:
        if recorded.flat.watcher.ticks >= 6:
            raise error
        usual(*args)

    monkeypatch.setattr(base, place, broken)
    with pytest.raises(type(error)):
        recorded.flat.mission.run()
    recorded.assert_in_order(reason)


def test_a_lost_link(tmp_path):
    robots: list[FaultyRobot] = []

    def wrap(robot):
        class Clock:
            def now(self) -> float:
                return robot.base.state().stamp

            def wait_until(self, stamp: float) -> None: ...

        robots.append(FaultyRobot(robot, Clock()))
        return robots[0]

    settings = MissionSettings(safety=SafetySettings(device_timeout=2.0))
    recorded = Recorded(tmp_path, "drive_and_look", settings=settings, wrap=wrap)

    def cut() -> None:
        robots[0].silent.add("base")
        robots[0].refusing.add("base")
        robots[0].fault["base"] = "the link is lost (check the cable)"

    recorded.flat.mission.observe(Watcher(at=8, act=cut))
    recorded.flat.mission.run()
    recorded.assert_in_order("base: the link is lost (check the cable)")


@pytest.fixture
def attached():
    """Children take signals as in a terminal: those of a suite run by nohup would outlive SIGHUP, as they are to."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("attached")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])  # SIGINT: tests/cli
def test_a_signal_ends_a_run_as_orderly_as_any_other_way(tmp_path, name):
    folder, number = tmp_path / "run", signal.Signals[name]
    tree = tmp_path / "own.yaml"
    tree.write_text("bt: 1\nroot: own\ntrees:\n  own:\n    params: {target: str}\n    do: go_to_frontier\n")
    command = [sys.executable, "-m", "zavis_bt", "run", str(tree), "-t", "mug", "-w", "apartment", "-r", "locobot"]
    command += ["--real-time", "--record", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            deadline, events = time.monotonic() + PATIENCE, folder / "events.jsonl"
            while not (events.exists() and events.stat().st_size):  # the mission is under way
                assert process.poll() is None, process.communicate()
                assert time.monotonic() < deadline
                time.sleep(0.05)
            os.kill(process.pid, number)
            _, errors = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert process.returncode == 128 + number, errors
    assert errors.strip().splitlines()[-1] == f"ended by {name}"
    run = load_run(folder)
    assert run.status == "ended"
    assert run.result is not None
    assert run.result.reason == "interrupted"
    assert (folder / "map.png").exists()


class Loop:
    def __init__(self) -> None:
        self.reasons: list[str] = []

    def stop(self, reason: str) -> None:
        self.reasons.append(reason)


def test_a_signal_only_asks_the_loop_to_stop_and_is_passed_on_when_all_is_done():
    loop, done = Loop(), []

    def run() -> None:
        with OrderlyEnd(loop.stop) as end:
            signal.raise_signal(signal.SIGINT)
            done.append("the tick")
            end.close()
            signal.raise_signal(signal.SIGINT)
            done.append("the recording")

    with pytest.raises(KeyboardInterrupt):
        run()
    assert loop.reasons == ["interrupted"]
    assert done == ["the tick", "the recording"]


def test_a_second_signal_interrupts_the_tick():
    def run() -> None:
        with OrderlyEnd(Loop().stop):
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
            pytest.fail("the tick goes on")

    with pytest.raises(KeyboardInterrupt):
        run()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_tick_that_hangs_is_interrupted_after_a_while():
    def run() -> None:
        with OrderlyEnd(Loop().stop):
            signal.raise_signal(signal.SIGINT)
            time.sleep(PATIENCE)

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run()
    assert time.monotonic() - begin < PATIENCE


def test_an_ignored_signal_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        loop = Loop()
        with OrderlyEnd(loop.stop):
            signal.raise_signal(signal.SIGHUP)
        assert loop.reasons == []
    finally:
        signal.signal(signal.SIGHUP, before)


def test_off_the_main_thread_nothing_is_changed():
    before, seen = signal.getsignal(signal.SIGINT), []

    def run() -> None:
        with OrderlyEnd(Loop().stop):
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert seen == [before]

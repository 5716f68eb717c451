"""Base class of behaviours: ports, life cycle, containment."""

from __future__ import annotations

import logging
from typing import Any

import pytest
from py_trees.blackboard import Blackboard
from tree_kinds import Consume, Navigate, Produce

from zavis_bt.errors import DeviceError, InputError
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Pose2D, Viewpoint


class Probe(Behaviour):
    """Counts its calls."""

    distance = In(float, "how far", unit="m", default=0.5, ge=0.0, le=2.0)
    hint = In(str, "optional", default=None)
    goals = In(list[Pose2D], "where", default=[])
    length = Out(float, "driven", unit="m")

    def __init__(self, name: str = "", **inputs: object) -> None:
        super().__init__(name, **inputs)
        self.calls: list[str] = []
        self.result = Status.RUNNING
        self.error: BaseException | None = None

    def initialise(self) -> None:
        self.calls.append("initialise")

    def update(self) -> Status:
        if self.error is not None:
            raise self.error
        return self.result

    def terminate(self, new_status: Status) -> None:
        self.calls.append(f"terminate {new_status.name}")


def test_kind_is_the_class_name_in_snake_case() -> None:
    assert (Probe.kind, Navigate.kind) == ("probe", "navigate")
    assert type("GoToFrontier", (Behaviour,), {}).kind == "go_to_frontier"
    assert type("RGBDScan", (Behaviour,), {}).kind == "rgbd_scan"


def test_an_int_becomes_a_float_at_a_float_port() -> None:
    probe = Probe(distance=1)
    probe.length = 3
    assert isinstance(probe.distance, float)
    assert isinstance(probe.length, float)


def test_defaults_hold_until_bound_and_are_not_shared() -> None:
    one, other = Probe(), Probe()
    assert (one.distance, one.hint) == (0.5, None)
    one.goals.append(Pose2D(0.0, 0.0))
    assert other.goals == []


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"distance": "far"}, "probe: 'distance' takes float, not 'far'"),
        ({"distance": True}, "takes float, not True"),
        ({"distance": 3.0}, r"'distance' is 3.0 m \(at most 2 m\)"),
        ({"distance": -1}, r"at least 0 m"),
        ({"goals": [1]}, "takes Pose2D, not 1"),
        ({"way": 1}, "probe has no input 'way'"),
    ],
)
def test_wrong_inputs_are_refused_when_bound(inputs: dict[str, object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        Probe(**inputs)


def test_a_wrong_output_is_refused() -> None:
    untyped: Any = Probe()
    with pytest.raises(TypeError, match="output 'length' takes float, not 'long'"):
        untyped.length = "long"


def test_an_input_cannot_be_assigned() -> None:
    untyped: Any = Probe()
    with pytest.raises(AttributeError, match="input 'distance' cannot be assigned"):
        untyped.distance = 1.0


def test_an_input_without_value_and_an_output_before_it_is_written_say_so() -> None:
    with pytest.raises(InputError, match=r"input 'value' was not given \(float\)"):
        _ = Consume().value
    with pytest.raises(InputError, match="output 'length' has not been written"):
        _ = Probe().length


def test_a_port_of_two_types_takes_both_and_no_third() -> None:
    pose = Pose2D(1.0, 2.0)
    view = Viewpoint(pose, (0.0, 0.0, 0.0), 0.1, 0, "desk")
    assert Navigate(goal=pose).goal is pose
    assert Navigate(goal=view).goal is view
    with pytest.raises(TypeError, match=r"takes Pose2D \| Viewpoint"):
        Navigate(goal=1)


def test_a_wire_connects_output_and_input_and_converts() -> None:
    producer, consumer = Produce(), Consume()
    producer.wire({"total": "/wire_test/total"}, "/wire_test")
    consumer.wire({"value": "/wire_test/total"}, "/wire_test")
    with pytest.raises(InputError, match=r"input 'value' reads \$total, which nothing has written yet"):
        _ = consumer.value
    producer.tick_once()
    assert consumer.value == 3.0
    assert isinstance(consumer.value, float)
    assert consumer.get_input("value") == 3.0
    Blackboard.storage.pop("/wire_test/total")


def test_a_value_out_of_range_that_comes_over_a_wire_is_refused() -> None:
    probe = Probe()
    probe.wire({"distance": "/wire_test/distance"}, "/wire_test")
    Blackboard.storage["/wire_test/distance"] = 7
    with pytest.raises(InputError, match=r"input 'distance' is 7.0 m \(at most 2 m\)"):
        _ = probe.distance
    Blackboard.storage.pop("/wire_test/distance")


def test_terminate_is_called_once_for_each_start() -> None:
    probe = Probe()
    probe.stop(Status.INVALID)
    assert probe.calls == []
    probe.tick_once()
    probe.tick_once()
    probe.stop(Status.INVALID)
    probe.stop(Status.INVALID)
    assert probe.calls == ["initialise", "terminate INVALID"]
    probe.result = Status.SUCCESS
    probe.tick_once()
    probe.stop(Status.INVALID)
    assert probe.calls[2:] == ["initialise", "terminate SUCCESS"]


def test_an_exception_is_the_behaviours_failure(caplog: pytest.LogCaptureFixture) -> None:
    probe = Probe()
    probe.error = KeyError("map")
    probe.tick_once()
    assert (probe.status, probe.feedback_message) == (Status.FAILURE, "KeyError: 'map'")
    assert probe.calls == ["initialise", "terminate FAILURE"]
    assert "Traceback" in caplog.text


def test_a_known_error_is_its_message_without_traceback(caplog: pytest.LogCaptureFixture) -> None:
    probe = Probe()
    probe.error = DeviceError("base: no answer")
    probe.tick_once()
    assert probe.feedback_message == "base: no answer"
    assert caplog.text == ""


def test_an_interrupt_is_not_contained() -> None:
    probe = Probe()
    probe.error = KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt):
        probe.tick_once()
    assert probe.begun
    probe.stop(Status.INVALID)
    assert probe.calls == ["initialise", "terminate INVALID"]


@pytest.mark.parametrize("result", [None, "SUCCESS", Status.INVALID])
def test_no_status_is_a_failure(result: Any, caplog: pytest.LogCaptureFixture) -> None:
    probe = Probe()
    probe.result = result
    probe.tick_once()
    assert probe.status is Status.FAILURE
    assert "not RUNNING, SUCCESS or FAILURE" in probe.feedback_message


def test_an_exception_in_terminate_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    class Broken(Behaviour):
        def update(self) -> Status:
            return self.running()

        def terminate(self, new_status: Status) -> None:
            raise OSError("gone")

    broken = Broken()
    broken.tick_once()
    with caplog.at_level(logging.ERROR):
        broken.stop(Status.INVALID)
    assert broken.status is Status.INVALID
    assert "gone" in caplog.text


def test_same_named_classes_do_not_clash() -> None:
    def make() -> type[Behaviour]:
        class Twin(Behaviour):
            value = In(int, "v", default=1)

        return Twin

    assert make() is not make()


def test_a_port_must_not_hide_py_trees_own_names() -> None:
    with pytest.raises(TypeError, match="a port cannot be called 'status'"):
        type("Bad", (Behaviour,), {"status": In(int, "s")})


def test_ports_are_inherited() -> None:
    assert set(Navigate.in_ports) == {"ticks", "ends", "label", "goal", "tolerance"}
    assert Navigate.INPUT_PORTS["tolerance"].default_value == 0.3

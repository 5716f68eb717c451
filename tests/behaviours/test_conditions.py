from __future__ import annotations

from dataclasses import replace

import pytest
from scripted import Stage, candidate, viewpoint

from behaviours import BatteryAbove, EstopClear, Found, WithinDistance
from zavis_bt.tree import Status
from zavis_bt.types import Pose2D


def set_base(stage: Stage, **values: object) -> None:
    stage.robot.base_state = replace(stage.robot.base_state, **values)


def test_estop_clear(stage):
    condition = stage.setup(EstopClear())
    assert stage.tick(condition) is Status.SUCCESS
    set_base(stage, estop=True)
    assert stage.tick(condition) is Status.FAILURE
    assert "emergency stop" in condition.feedback_message


def test_battery_above_names_the_charge(stage):
    condition = stage.setup(BatteryAbove(level=0.3))
    assert stage.tick(condition) is Status.SUCCESS
    set_base(stage, battery=0.25)
    assert stage.tick(condition) is Status.FAILURE
    assert "25%" in condition.feedback_message


@pytest.mark.parametrize("of", [Pose2D(0.5, 0.0), viewpoint(0.5, 0.0), candidate(position=(0.5, 0.0, 2.0))])
def test_within_distance_measures_along_the_floor(stage, of):
    assert stage.tick(stage.setup(WithinDistance(of=of, distance=0.6))) is Status.SUCCESS
    assert stage.tick(stage.setup(WithinDistance(of=of, distance=0.4))) is Status.FAILURE


def test_found_needs_a_candidate(stage):
    assert stage.tick(stage.setup(Found(candidate=candidate()))) is Status.SUCCESS
    missing = stage.setup(Found(otherwise="searched everything"))
    assert stage.tick(missing) is Status.FAILURE
    assert missing.feedback_message == "searched everything"

from __future__ import annotations

import math
import threading
import time

import numpy as np
import pytest
from arcos_bench import CENTRE, HALL, PIONEER, wait_for

from sim.devices.plant import Plant
from sim.world import World
from zavis_bt.errors import InputError
from zavis_bt.types import Pose2D


def test_time_stands_still_until_the_start_and_after_the_end() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    time.sleep(0.05)
    assert plant.now == 0.0
    plant.start()
    wait_for(lambda: plant.now > 0.1)
    plant.close()
    end = plant.now
    time.sleep(0.05)
    assert plant.now == end
    plant.close()


def test_time_passes_at_the_wall_clocks_pace() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    begun = time.monotonic()
    plant.start()
    while plant.now < 0.5:  # a loaded machine may fall behind
        assert plant.now <= time.monotonic() - begun + 0.03  # but never ahead by more than the first step
        assert time.monotonic() - begun < 20.0
        time.sleep(0.005)
    plant.close()


def test_controllers_are_called_in_order_once_before_each_step() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    calls: list[tuple[str, float]] = []
    for name in ("one", "two"):
        plant.controllers.append(lambda now, name=name: calls.append((name, now)))
    for _ in range(3):
        plant.step()
    assert calls == [(name, pytest.approx(step / 50)) for step in range(3) for name in ("one", "two")]
    assert plant.now == pytest.approx(0.06)


def test_a_slow_controller_slows_the_world_down_and_is_not_called_more_often() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    times: list[float] = []

    def dawdle(now: float) -> None:
        times.append(now)
        if len(times) < 4:
            time.sleep(0.3)

    plant.controllers.append(dawdle)
    begun = time.monotonic()
    plant.start()
    wait_for(lambda: len(times) >= 12)
    plant.close()
    assert np.diff(times) == pytest.approx(0.02)
    assert plant.now < time.monotonic() - begun - 0.3  # what is far behind is not caught up with


def test_what_a_controller_drives_is_approached_from_the_next_step_on() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    plant.drive(0.5, -1.0, 0.5, 2.0)
    plant.step()
    assert (plant.motion.linear, plant.motion.angular) == pytest.approx((0.01, -0.04))
    for _ in range(100):
        plant.step()
    assert (plant.motion.linear, plant.motion.angular) == pytest.approx((0.5, -1.0))


def test_a_controller_may_close_the_plant() -> None:
    plant = Plant(HALL, PIONEER, CENTRE)
    called = threading.Event()
    plant.controllers.append(lambda now: (plant.close(), called.set()))
    plant.start()
    assert called.wait(20.0)
    plant.close()


def test_rays_start_at_their_mount_and_turn_with_the_base(room: World) -> None:
    plant = Plant(room, PIONEER, Pose2D(2.0, 1.5, math.pi / 2))
    directions = np.array([0.0, math.pi / 2, math.pi, -math.pi / 2])
    ranges = plant.probe(Pose2D(0.2, 0.0), directions, 10.0)
    np.testing.assert_allclose(ranges, [4.0 - 1.7, 2.0, 1.7, 3.0], atol=1e-9)
    np.testing.assert_array_equal(plant.probe(Pose2D(0.2, 0.0), directions, 2.5), [*ranges[:3], math.inf])


def test_a_sweep_is_what_the_lidar_sees(room: World) -> None:
    plant = Plant(room, PIONEER, Pose2D(2.0, 1.5, 0.0))
    ranges = plant.sweep(3, -math.pi / 2, math.pi / 2)
    np.testing.assert_allclose(ranges, [1.5, 5.0 - 2.16, 2.5], atol=1e-9)


def test_the_camera_looks_where_the_joints_point(room: World) -> None:
    plant = Plant(room, PIONEER, Pose2D(2.0, 1.5, 0.0))
    plant.joints = lambda stamp: (math.pi / 2, 0.0)
    optical = plant.frame().transform_camera_to_map
    np.testing.assert_allclose(optical[:3, 2], [0.0, 1.0, 0.0], atol=1e-9)


def test_a_robot_that_does_not_fit_is_refused(room: World) -> None:
    with pytest.raises(InputError, match="does not fit"):
        Plant(room, PIONEER, Pose2D(0.1, 0.1))

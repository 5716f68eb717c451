from __future__ import annotations

import dataclasses
import math
import time

import numpy as np
import pytest

from sim import Simulation
from sim.noise import NoiseSettings, stream
from sim.world import Furniture, World
from zavis_bt.errors import InputError
from zavis_bt.protocols import Base, Camera, Clock, Lidar, PanTilt, Robot
from zavis_bt.types import FREE, OCCUPIED, Footprint, GridMap, Pose2D, RobotSpec, Twist2D

NOISE = NoiseSettings(0.01, 0.1, 0.01, 0.01, 0.001, 0.001)
START = Pose2D(1.0, 2.0, 0.0)


def history(simulation: Simulation, *, period: float = 0.1, watch: bool = True) -> list[object]:
    """What a robot that circles sees at whole seconds."""
    seen: list[object] = []
    for step in range(0, 200, round(period * 50)):
        if step % 50 == 0:
            simulation.robot.base.command(Twist2D(0.4, 0.1 * step / 50))
            simulation.robot.pan_tilt.move_to(0.3 * step / 50, 0.1)
            scan, state = simulation.robot.lidar.scan(), simulation.robot.base.state()
            seen += [state, scan.ranges.tolist(), scan.stamp, simulation.robot.pan_tilt.state(), simulation.truth]
            seen.append(simulation.robot.camera.frame().transform_camera_to_map.tolist())
        elif watch:
            simulation.robot.lidar.scan()
            simulation.robot.camera.frame()
        simulation.clock.wait_until(step / 50 + period)
    return seen


def accept(robot: Robot, clock: Clock) -> tuple[Base, PanTilt, Lidar, Camera, Clock]:
    """The type checker holds the simulated robot against the borders here."""
    return robot.base, robot.pan_tilt, robot.lidar, robot.camera, clock


def test_the_simulated_robot_is_a_robot(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START)
    accept(simulation.robot, simulation.clock)
    assert simulation.robot.spec is spec


def test_the_same_commands_give_the_same_run(room: World, spec: RobotSpec) -> None:
    one, two = (history(Simulation(room, spec, START, 7, noise=NOISE)) for _ in range(2))
    np.testing.assert_equal(one, two)
    np.testing.assert_equal(len(one), 24)


def test_another_seed_gives_another_run(room: World, spec: RobotSpec) -> None:
    one, two = (Simulation(room, spec, START, seed, noise=NOISE) for seed in (1, 2))
    assert one.robot.lidar.scan().ranges.tolist() != two.robot.lidar.scan().ranges.tolist()


def test_a_run_does_not_depend_on_who_watches_or_how_finely_it_waits(room: World, spec: RobotSpec) -> None:
    reference = history(Simulation(room, spec, START, 7, noise=NOISE, watchdog=2.0))
    unwatched = history(Simulation(room, spec, START, 7, noise=NOISE, watchdog=2.0), watch=False)
    finer = history(Simulation(room, spec, START, 7, noise=NOISE, watchdog=2.0), period=0.02)
    np.testing.assert_equal(unwatched, reference)
    np.testing.assert_equal(finer, reference)


def test_odometry_is_the_truth_by_default(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START)
    history(simulation)
    assert simulation.robot.base.state().pose == simulation.truth
    assert simulation.path_length > 0.5


def test_odometry_error_makes_the_pose_drift_from_the_truth(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START, noise=NOISE)
    assert simulation.robot.base.state().pose == START
    history(simulation)
    assert 0 < simulation.robot.base.state().pose.distance(simulation.truth) < 1


def test_without_commands_the_base_slows_down_to_rest(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START, watchdog=0.5)
    simulation.robot.base.command(Twist2D(0.6, 0.0))
    simulation.clock.wait_until(0.5)
    assert simulation.robot.base.state().twist.linear == pytest.approx(0.5)
    simulation.clock.wait_until(0.8)
    assert simulation.robot.base.state().twist.linear == pytest.approx(0.2)
    simulation.clock.wait_until(2.0)
    assert simulation.robot.base.state().twist == Twist2D(0.0, 0.0)
    assert simulation.path_length == pytest.approx(0.25)


def test_commands_are_clipped_to_the_limits(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, Pose2D(2.5, 2.0), watchdog=9.0)
    simulation.robot.base.command(Twist2D(-9.0, 99.0))
    simulation.clock.wait_until(1.0)
    assert simulation.robot.base.state().twist == Twist2D(-0.3, 1.8)
    with pytest.raises(ValueError, match="not a velocity"):
        simulation.robot.base.command(Twist2D(math.nan, 0.0))


def test_the_emergency_stop_holds_until_released(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START)
    base = simulation.robot.base
    base.press_estop()
    base.command(Twist2D(0.5, 0.0))
    simulation.clock.wait_until(0.4)
    assert base.state().estop
    assert simulation.truth == START
    base.press_estop(False)
    base.command(Twist2D(0.5, 0.0))
    simulation.clock.wait_until(0.8)
    assert simulation.truth.x > START.x


def test_driving_on_into_a_wall_is_one_collision(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, Pose2D(4.5, 2.0))
    for tick in range(30):
        simulation.robot.base.command(Twist2D(0.6, 0.0))
        simulation.clock.wait_until(tick * 0.1)
    state = simulation.robot.base.state()
    assert simulation.collisions == 1
    assert state.bumper
    assert state.stalled
    assert simulation.truth.x < 5.0 - 0.1


def test_a_scan_is_taken_where_the_base_was_at_its_stamp(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START, watchdog=9.0)
    assert simulation.robot.lidar.scan().stamp == 0.0
    simulation.robot.base.command(Twist2D(0.6, 0.0))
    simulation.clock.wait_until(1.0)
    there = simulation.truth
    simulation.clock.wait_until(1.08)
    scan = simulation.robot.lidar.scan()
    assert scan.stamp == 1.0
    assert scan is simulation.robot.lidar.scan()
    assert scan.ranges[90] == pytest.approx(5.0 - there.x - 0.1)  # the sensor is 0.1 m ahead
    assert scan.ranges[0] == pytest.approx(2.0)
    assert not scan.ranges.flags.writeable
    assert np.allclose(scan.angles[[0, 90, 180]], [-math.pi / 2, 0, math.pi / 2])


def test_a_full_circle_has_no_doubled_beam_and_looks_backwards_first(room: World, spec: RobotSpec) -> None:
    lidar = dataclasses.replace(spec.lidar, beams=360, field_of_view=math.tau, mount=Pose2D(0, 0))
    scan = Simulation(room, dataclasses.replace(spec, lidar=lidar), START).robot.lidar.scan()
    assert scan.angles[-1] == pytest.approx(math.pi - math.tau / 360)
    assert scan.ranges[0] == pytest.approx(1.0)
    assert scan.ranges[180] == pytest.approx(4.0)


def test_dropouts_and_noise_have_their_size(room: World, spec: RobotSpec) -> None:
    noisy = Simulation(room, spec, START, noise=NoiseSettings(range_sigma=0.02, range_dropout=0.2))
    exact = Simulation(room, spec, START).robot.lidar.scan().ranges
    errors = []
    for tick in range(50):
        noisy.clock.wait_until(tick * 0.1)
        errors.append(noisy.robot.lidar.scan().ranges - exact)
    errors_all = np.concatenate(errors)
    assert np.isinf(errors_all).mean() == pytest.approx(0.2, abs=0.02)
    assert errors_all[np.isfinite(errors_all)].std() == pytest.approx(0.02, rel=0.05)


def test_a_frame_is_taken_where_base_and_camera_were_at_its_stamp(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START)
    simulation.robot.pan_tilt.move_to(math.pi / 2, 0.0)
    simulation.clock.wait_until(3.1)
    frame = simulation.robot.camera.frame()
    assert frame.stamp == 3.0
    assert frame is simulation.robot.camera.frame()
    np.testing.assert_allclose(frame.transform_camera_to_map[:3, 2], [0, 1, 0], atol=1e-12)  # looks along y
    np.testing.assert_allclose(frame.transform_camera_to_map[:3, 3], [1, 2, 0.9], atol=1e-12)


def test_close_stops_all_motion_and_may_be_called_twice(room: World, spec: RobotSpec) -> None:
    simulation = Simulation(room, spec, START, watchdog=9.0)
    simulation.robot.base.command(Twist2D(0.6, 0.5))
    simulation.robot.pan_tilt.move_to(3.0, 0.0)
    simulation.clock.wait_until(0.5)
    simulation.robot.close()
    simulation.robot.close()
    simulation.clock.wait_until(3.0)
    assert simulation.robot.base.state().twist == Twist2D()
    assert 0 < simulation.robot.pan_tilt.state().pan < 2.0


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (Pose2D(0.05, 2.0), "does not fit"),
        (Pose2D(7.0, 2.0), "outside the map"),
        (Pose2D(-9.0, 2.0), "outside the map"),
    ],
)
def test_an_impossible_start_is_an_input_error(room: World, spec: RobotSpec, start: Pose2D, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        Simulation(room, spec, start)
    assert "\n" not in str(caught.value)


def test_a_rectangle_starts_where_it_fits_with_its_heading(spec: RobotSpec) -> None:
    occupied = np.ones((60, 15), dtype=np.bool_)
    occupied[1:-1, 1:-1] = False
    grid = GridMap(np.where(occupied, OCCUPIED, FREE).astype(np.int8), 0.05, (0.0, 0.0))
    world, long = World("w", grid, 2.5), dataclasses.replace(spec, footprint=Footprint(0.9, 0.5))
    Simulation(world, long, Pose2D(0.375, 1.5, math.pi / 2))
    with pytest.raises(InputError, match="does not fit"):
        Simulation(world, long, Pose2D(0.375, 1.5, 0.0))


def test_furniture_blocks_the_lidar_as_walls_do(spec: RobotSpec) -> None:
    states = np.full((80, 100), FREE, dtype=np.int8)
    states[35:45, 60:70] = OCCUPIED
    grid = GridMap(states, 0.05, (0.0, 0.0))
    world = World("w", grid, 2.5, (Furniture("table_1", "table", 3.25, 2.0, 0.0, 0.45, 0.45, 0.4),))
    assert Simulation(world, spec, START).robot.lidar.scan().ranges[90] == pytest.approx(3.0 - 1.1)


def test_streams_of_random_numbers_depend_on_seed_and_name_only() -> None:
    assert stream(3, "a").integers(2**60) == stream(3, "a").integers(2**60) == 267173045749063340
    assert stream(3, "a").random() != stream(3, "b").random()
    assert stream(3, "a").random() != stream(4, "a").random()


@pytest.mark.parametrize("settings", [{"range_sigma": -1.0}, {"range_dropout": 1.5}, {"range_sigma": math.nan}])
def test_impossible_noise_is_an_input_error(settings: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(settings))):
        NoiseSettings(**settings)


def test_a_negative_seed_is_an_input_error(room: World, spec: RobotSpec) -> None:
    with pytest.raises(InputError, match="seed"):
        Simulation(room, spec, START, -1)


def test_waiting_for_the_past_changes_nothing(room: World, spec: RobotSpec) -> None:
    clock = Simulation(room, spec, START).clock
    clock.wait_until(0.3)
    clock.wait_until(0.1)
    assert clock.now() == 0.3
    clock.wait_until(0.301)
    assert clock.now() == 0.32


def test_real_time_passes_as_fast_as_on_the_wall(room: World, spec: RobotSpec) -> None:
    clock = Simulation(room, spec, START, real_time=True).clock
    begun = time.monotonic()
    for tick in range(1, 11):
        clock.wait_until(tick * 0.02)
    assert 0.19 < time.monotonic() - begun < 0.6

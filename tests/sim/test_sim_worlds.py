from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivers import builtin_robot, builtin_robots
from sim import Simulation, load_world
from sim.reach import passable, reachable, warnings
from sim.world import Furniture, World, mark_touched
from sim.worlds import builtin_world, builtin_worlds, resolve_world, write_starter
from sim.worlds.draw import apartment, flat
from sim.worlds.paint import write_world
from zavis_bt.errors import InputError
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.types import FREE, OCCUPIED, GridMap, Pose2D

PIONEER_RADIUS = 0.356


def test_there_are_an_apartment_and_a_flat() -> None:
    assert builtin_worlds() == ("apartment", "flat")


@pytest.mark.parametrize("plan", [apartment(), flat()], ids=lambda plan: plan.name)
def test_the_files_are_what_is_drawn(plan, tmp_path: Path) -> None:
    write_world(plan, tmp_path)
    for suffix in (".world.yaml", ".yaml", ".pgm"):
        drawn, kept = tmp_path / f"{plan.name}{suffix}", builtin_world(plan.name).parent / f"{plan.name}{suffix}"
        assert drawn.read_bytes() == kept.read_bytes()


def test_colours_and_looks_survive_writing_and_reading(tmp_path: Path) -> None:
    plan = flat()
    desk, mug = replace(plan.furniture[0], colour="white", appearance=3), replace(plan.objects[0], colour="red")
    plan = replace(plan, furniture=(desk, *plan.furniture[1:]), objects=(mug, *plan.objects[1:]))
    world = load_world(write_world(plan, tmp_path))
    assert (world.furniture[0].colour, world.furniture[0].appearance) == ("white", 3)
    assert (world.objects[0].colour, world.objects[0].appearance) == ("red", None)


@pytest.mark.parametrize("name", ["apartment", "flat"])
def test_built_in_worlds_are_without_warning_even_for_a_pioneer(name: str) -> None:
    world = load_world(builtin_world(name))
    assert list(warnings(world, PIONEER_RADIUS)) == []
    assert list(warnings(world, 0.18)) == []


@pytest.mark.parametrize("robot", builtin_robots())
@pytest.mark.parametrize("name", ["apartment", "flat"])
def test_every_robot_can_begin_at_every_start(name: str, robot: str) -> None:
    world = load_world(builtin_world(name))
    for start in world.starts:
        Simulation(world, load_robot(builtin_robot(robot)).spec, start)


@pytest.mark.parametrize("name", ["apartment", "flat"])
def test_furniture_in_the_map_and_its_boxes_agree_and_touch_no_wall(name: str) -> None:
    world = load_world(builtin_world(name))
    for piece in world.furniture:
        cells = np.zeros(world.grid.shape, dtype=np.bool_)
        mark_touched(cells, world.grid, piece)
        assert world.occupied[cells].all()
    inside = np.zeros(world.grid.shape, dtype=np.bool_)
    inside[3:-3, 3:-3] = True
    assert world.walls[~inside].all()  # the outer wall is wall all round


@pytest.mark.parametrize("name", ["apartment", "flat"])
def test_objects_lie_on_their_furniture(name: str) -> None:
    world = load_world(builtin_world(name))
    bearers = {piece.id: piece for piece in world.furniture}
    for thing in world.objects:
        if thing.on is None:
            assert thing.z == 0
            continue
        bearer = bearers[thing.on]
        local = Pose2D(bearer.x, bearer.y, bearer.yaw).inverse() @ Pose2D(thing.x, thing.y)
        assert abs(local.x) < bearer.length / 2, thing.id
        assert abs(local.y) < bearer.width / 2, thing.id
        assert thing.z == pytest.approx(bearer.height)


def test_the_apartment_has_a_red_wallet_among_much_else() -> None:
    world = load_world(builtin_world("apartment"))
    assert [thing.colour for thing in world.objects if thing.category == "wallet"] == ["red"]
    assert len(world.furniture) >= 20
    assert len(world.objects) >= 25


def test_a_world_is_found_by_name_path_or_path_without_its_ending(tmp_path: Path) -> None:
    path = write_starter("home", tmp_path)
    assert resolve_world("flat") == builtin_world("flat")
    assert resolve_world(path) == resolve_world(tmp_path / "home") == path
    with pytest.raises(InputError, match="did you mean 'apartment'"):
        resolve_world("appartment")
    with pytest.raises(InputError, match=r"did you mean '.*home.world.yaml'"):
        resolve_world(tmp_path / "hme.world.yaml")


def test_a_starter_world_is_right_and_nothing_is_overwritten(tmp_path: Path) -> None:
    world = load_world(write_starter("home", tmp_path))
    assert world.name == "home"
    assert list(warnings(world, 0.18)) == []
    with pytest.raises(InputError, match="exists already"):
        write_starter("home", tmp_path)
    (tmp_path / "other.pgm").touch()
    with pytest.raises(InputError, match="exists already"):
        write_starter("other", tmp_path)
    with pytest.raises(InputError, match="is not a name"):
        write_starter("../x", tmp_path)
    with pytest.raises(InputError, match="cannot be written"):
        write_starter("home", tmp_path / "none")


def world_of(picture: list[str], **rest: Any) -> World:
    states = np.array([[FREE if mark == "." else OCCUPIED for mark in line] for line in reversed(picture)], np.int8)
    return World("w", GridMap(states, 0.5, (0.0, 0.0)), 2.5, **rest)


DIVIDED = ["########", "#..##..#", "#..##..#", "########"]


def test_what_is_cut_off_is_not_reachable() -> None:
    world = world_of(DIVIDED, starts=(Pose2D(1.0, 1.0),))
    assert passable(world, 0.4).sum() == 8
    assert reachable(world, 0.4)[:, :4].sum() == reachable(world, 0.4).sum() == 4


@pytest.mark.parametrize(
    ("picture", "rest", "message"),
    [
        (DIVIDED, {"starts": (Pose2D(1.0, 1.0), Pose2D(3.0, 1.0))}, "start 2 at .3, 1.: cut off"),
        (DIVIDED, {"starts": (Pose2D(0.6, 1.0),)}, None),
        (["....", "....", "...."], {}, "free cells at its edge"),
        (DIVIDED, {"furniture": (Furniture("bed_1", "bed", 3.0, 1.0, 0.0, 0.3, 0.3, 1.0),)}, "the map is free where"),
        (
            DIVIDED,
            {"starts": (Pose2D(1.0, 1.0),), "furniture": (Furniture("bed_1", "bed", 3.8, 1.0, 0.0, 0.3, 0.3, 1.0),)},
            "furniture 'bed_1': no place",
        ),
    ],
)
def test_warnings_name_what_is_out_of_reach(picture: list[str], rest: dict[str, object], message: str | None) -> None:
    found = list(warnings(world_of(picture, **rest), 0.2))
    assert (found == []) == (message is None)
    if message is not None:
        assert any(re.search(message, line) for line in found)


def test_a_start_that_is_too_tight_is_warned_of() -> None:
    world = world_of(DIVIDED, starts=(Pose2D(1.0, 1.0),))
    assert any("does not fit" in line for line in warnings(world, 1.1))


def test_passable_cells_are_those_where_a_disc_fits() -> None:
    world = load_world(builtin_world("flat"))
    cells = np.argwhere(np.ones(world.grid.shape, dtype=np.bool_))[::37]
    fits = [world.fits(x, y, 0.18) for x, y in world.grid.to_points(cells)]
    assert passable(world, 0.18)[cells[:, 0], cells[:, 1]].tolist() == fits

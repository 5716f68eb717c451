from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sim.world_file import inspect_world, load_world, read_objects
from zavis_bt.errors import InputError
from zavis_bt.mapping.map_server import save_map
from zavis_bt.types import FREE, OCCUPIED, GridMap

GOOD = """\
format: zavis-world/1
name: small
map: small.yaml
furniture:
  - {id: bed_1, category: bed, x: 0.5, y: 0.5, yaw_deg: 90, size: [0.4, 0.2], height: 0.5}
objects:
  - {id: mug_1, category: mug, x: 0.5, y: 0.5, z: 0.5, size: [0.1, 0.1, 0.1], on: bed_1, colour: red}
starts:
  - [1.5, 0.5, 180]
"""


@pytest.fixture
def write(tmp_path: Path):
    states = np.full((10, 20), FREE, dtype=np.int8)
    states[4:6, 3:7] = OCCUPIED
    save_map(tmp_path / "small.yaml", GridMap(states, 0.1, (0.0, 0.0)))

    def write(text: str) -> Path:
        path = tmp_path / "small.world.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_a_world_file_becomes_values_in_si_units(write) -> None:
    world = load_world(write(GOOD))
    (bed,), (mug,), (start,) = world.furniture, world.objects, world.starts
    assert (bed.id, bed.category, bed.length, bed.width, bed.height) == ("bed_1", "bed", 0.4, 0.2, 0.5)
    assert bed.yaw == pytest.approx(math.pi / 2)
    assert (mug.on, mug.colour, mug.size) == ("bed_1", "red", (0.1, 0.1, 0.1))
    assert (start.x, start.y, start.yaw) == (1.5, 0.5, pytest.approx(math.pi))
    assert world.wall_height == 2.5
    assert (bed.colour, bed.appearance, mug.appearance) == (None, None, None)
    assert world.grid.shape == (10, 20)


def test_a_world_may_say_how_things_look(write) -> None:
    text = GOOD.replace("height: 0.5}", "height: 0.5, colour: blue, appearance: 7}")
    world = load_world(write(text.replace("colour: red}", "colour: red, appearance: 0}")))
    assert (world.furniture[0].colour, world.furniture[0].appearance) == ("blue", 7)
    assert (world.objects[0].colour, world.objects[0].appearance) == ("red", 0)


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("zavis-world/1", "zavis-world/2", 1, "format: should be 'zavis-world/1'"),
        ("map: small.yaml", "map: big.yaml", 3, "map: no file .*big.yaml"),
        ("height: 0.5", "heigth: 0.5", 5, r"unknown key 'furniture\[0\].heigth' \(did you mean 'height'\?\)"),
        ("size: [0.4, 0.2]", "size: [-0.4, 0.2]", 5, r"size\[0\]: should be greater than 0, not -0.4"),
        ("x: 0.5, y: 0.5, yaw", "x: 9.5, y: 0.5, yaw", 5, "'bed_1' at .9.5, 0.5. is outside the map"),
        ("category: mug, x: 0.5", "category: mug, x: .nan", 7, "finite"),
        ("height: 0.5}", "height: 0.5, colour: ''}", 5, r"colour: .* at least 1 character"),
        ("height: 0.5}", "height: 0.5, appearance: -1}", 5, r"appearance: should be greater than or equal to 0"),
        ("colour: red}", "appearance: red}", 7, r"appearance: should be a valid integer"),
        ("colour: red}", "color: red}", 7, r"unknown key .*color.*did you mean 'colour'"),
        ("on: bed_1", "on: bed1", 7, r"on unknown furniture 'bed1' \(did you mean 'bed_1'\?\)"),
        ("[1.5, 0.5, 180]", "[0.5, 0.5, 180]", 9, "start .0.5, 0.5. is in an obstacle"),
        ("[1.5, 0.5, 180]", "[1.5, 5, 180]", 9, "start .1.5, 5. is outside the map"),
        ("name: small", "", 1, "key 'name' is missing"),
        ("name: small", "name: small\nname: other", 3, "key 'name' occurs twice"),
        ("starts:", "starts: [", 9, "is not YAML"),
        (GOOD, "just words", 1, "should hold keys and values"),
        (GOOD, "", 1, "should hold keys and values"),
    ],
)
def test_a_fault_is_one_line_with_file_and_line(write, old: str, new: str, line: int, message: str) -> None:
    path = write(GOOD.replace(old, new))
    with pytest.raises(InputError, match=message) as caught:
        load_world(path)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(path))
    named = str(caught.value).removeprefix(f"{path}:").split(":")[0]
    assert named == str(line) or "is not YAML" in message


def test_a_doubled_id_names_both_lines(write) -> None:
    path = write(GOOD.replace("objects:", GOOD.splitlines()[4] + "\nobjects:"))
    with pytest.raises(InputError, match=r":6: furniture id 'bed_1' occurs twice \(first in line 5\)"):
        load_world(path)


def test_all_faults_can_be_named_at_once(write) -> None:
    world, faults = inspect_world(write(GOOD.replace("on: bed_1", "on: x").replace("[1.5, 0.5", "[0.5, 0.5")))
    assert world is None
    assert len(faults) == 2


def test_a_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        load_world(tmp_path / "none.world.yaml")


def test_an_episodes_objects_are_checked_alike() -> None:
    entry = {"id": "cd_1", "category": "cd", "x": 1, "y": 2, "z": 0.5, "size": [0.1, 0.1, 0.01], "on": None}
    (thing,) = read_objects([entry], "episodes.jsonl:1")
    assert (thing.category, thing.on) == ("cd", None)
    with pytest.raises(InputError, match=r"episodes.jsonl:1: objects\[0\]: key 'z' is missing"):
        read_objects([{key: value for key, value in entry.items() if key != "z"}], "episodes.jsonl:1")


@pytest.mark.parametrize("group", ["ithor", "ithor_apartments"])
def test_every_real_world_loads_and_every_episodes_start_fits(shared: Path, group: str) -> None:
    folder = shared / "worlds" / group
    worlds = {path.name: load_world(path) for path in sorted(folder.glob("*.world.yaml"))}
    episodes = [json.loads(line) for line in (folder / "episodes.jsonl").read_text().splitlines()]
    assert worlds
    assert episodes
    for number, episode in enumerate(episodes):
        x, y, _ = episode["start"]
        assert worlds[episode["world"]].fits(x, y, 0.18), episode["id"]
        assert len(read_objects(episode["objects"], f"episodes:{number}")) == len(episode["objects"])

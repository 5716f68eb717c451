from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from zavis_bt.bench import load_episodes
from zavis_bt.errors import InputError


def line(**changes: Any) -> dict[str, Any]:
    return {
        "id": "e1",
        "group": "bedroom",
        "world": "room.world.yaml",
        "start": [1.0, -2, 90],
        "target": {"category": "mug", "instances": ["mug_1"]},
        "shortest_path_length": 1.5,
        "objects": [
            {"id": "mug_1", "category": "mug", "x": 1, "y": 2.5, "z": 0.7, "size": [0.1, 0.1, 0.1], "on": "desk_1"},
            {"id": "box_1", "category": "box", "x": 0, "y": 0.5, "z": 0.0, "size": [0.3, 0.2, 0.1], "on": None},
        ],
    } | changes


@pytest.fixture
def write(tmp_path: Path) -> Any:
    (tmp_path / "room.world.yaml").touch()

    def write(*lines: dict[str, Any] | str) -> Path:
        path = tmp_path / "episodes.jsonl"
        path.write_text("".join((text if isinstance(text, str) else json.dumps(text)) + "\n" for text in lines))
        return path

    return write


def test_an_episode_has_si_units_and_a_world_beside_its_file(write: Any, tmp_path: Path) -> None:
    (episode,) = load_episodes(write(line()))
    assert (episode.start.x, episode.start.y, episode.start.yaw) == (1.0, -2.0, pytest.approx(math.pi / 2))
    assert episode.world == tmp_path / "room.world.yaml"
    assert episode.target_positions() == ((1.0, 2.5),)
    assert episode.objects[0].on == "desk_1"


def test_the_shortest_path_may_be_unknown(write: Any) -> None:
    unknown = line(id="e2")
    del unknown["shortest_path_length"]
    episodes = load_episodes(write(line(shortest_path_length=None), "", unknown))
    assert [episode.shortest_path_length for episode in episodes] == [None, None]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("{", r"episodes.jsonl:1: is not JSON: .* \(one object a line\)"),
        ("[]", r"episodes.jsonl:1: should be an object"),
        (line(grupp="x"), r":1: unknown key 'grupp' \(did you mean 'group'\?\)"),
        (line(target={"category": "mug", "instances": []}), r"target.instances: .*at least 1"),
        (line(target={"category": "mug", "instances": ["mug_2"]}), r"no object has the id 'mug_2'.*'mug_1'"),
        (line(target={"category": "mug", "instances": ["box_1"]}), r"'box_1' is of category 'box' \(not 'mug'\)"),
        (
            line(target={"category": "mug", "instance": ["mug_1"]}),
            r"unknown key 'target.instance' \(did you mean 'instances'",
        ),
        (line(start=[1, 2]), r"key 'start\[2\]' is missing"),
        (line(start=[math.nan, 0, 0]), r"start\[0\]: should be a finite number, not nan"),
        (line(start=["1", 0, 0]), r"start\[0\]: should be a valid number, not '1\'"),
        (line(shortest_path_length=-1), r"shortest_path_length: .*greater than or equal to 0"),
        (line(objects=[*line()["objects"], line()["objects"][0]]), r"id 'mug_1' occurs twice"),
        (line(objects=[line()["objects"][0] | {"colour": "red"}]), r"unknown key 'objects\[0\].colour\'"),
        (line(world="hall.world.yaml"), r"world: no such file: .*hall.world.yaml"),
        (line(id=""), r"id: .*at least 1"),
    ],
)
def test_a_fault_is_shown_with_its_line_and_keys(write: Any, wrong: dict[str, Any] | str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_episodes(write(wrong))


def test_an_id_may_not_return(write: Any) -> None:
    with pytest.raises(InputError, match=r":3: id 'e1' stands in line 1 already"):
        load_episodes(write(line(), line(id="e2"), line()))


def test_the_first_ten_faults_are_shown_at_once(write: Any) -> None:
    path = write(*(line(id=f"e{k}", group=k) for k in range(14)))
    with pytest.raises(InputError) as caught:
        load_episodes(path)
    shown = str(caught.value).splitlines()
    assert [text.split(":")[1] for text in shown[:10]] == [str(k) for k in range(1, 11)]
    assert shown[10:] == [f"{path}: and more faults after these"]


@pytest.mark.parametrize("content", [b"", b"\n\n", b"\xff\xfe\x00"])
def test_a_file_without_episodes_is_an_error(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "episodes.jsonl"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"episodes.jsonl: (holds no episodes|is not UTF-8)"):
        load_episodes(path)


def test_a_missing_file_and_a_folder_are_errors(tmp_path: Path) -> None:
    for path in (tmp_path / "none.jsonl", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            load_episodes(path)


def test_real_episodes_load(shared: Path) -> None:
    episodes = [
        episode
        for name in ("ithor", "ithor_apartments")
        for episode in load_episodes(shared / "worlds" / name / "episodes.jsonl")
    ]
    assert len(episodes) == 360
    assert all(episode.target_positions() for episode in episodes)

"""Broken input through the command line: one line with place and remedy, and nothing moves."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from good_files import EPISODE, ROBOT, WORLD, assert_refused, bench, other, run, zavis

pytestmark = pytest.mark.usefixtures("_good_files")


def changed(file: str, old: str, new: str) -> Callable[[], object]:
    """Return what replaces a text of a file."""

    def change() -> None:
        text = Path(file).read_text()
        assert old in text
        Path(file).write_text(text.replace(old, new, 1))

    return change


def tree(do: str) -> Callable[[], object]:
    """Return what writes a tree of one node, in line 6."""
    return lambda: Path("t.yaml").write_text(
        f"bt: 1\nroot: m\ntrees:\n  m:\n    params: {{target: str}}\n    do: {do}\n"
    )


def tree_file(text: str) -> Callable[[], object]:
    return lambda: Path("t.yaml").write_text(text)


def second_line(line: object) -> Callable[[], object]:
    """Return what adds an episode; text is written as it is."""
    text = line if isinstance(line, str) else json.dumps(line)
    return lambda: Path("e.jsonl").write_text(json.dumps(EPISODE) + "\n" + text + "\n")


# What is done to good files, and how the one line begins that says so.
WORLDS = {
    "format": (
        changed("w.world.yaml", "world/1", "world/9"),
        r"w.world.yaml:1: format: should be 'zavis-world/1', not",
    ),
    "unknown key": (
        changed("w.world.yaml", "furniture:", "furnitur:"),
        r"w.world.yaml:4: unknown key 'furnitur' \(did you mean 'furniture'\?\)",
    ),
    "missing key": (changed("w.world.yaml", "map: home.yaml\n", ""), "w.world.yaml:1: key 'map' is missing"),
    "negative size": (changed("w.world.yaml", "[0.5, 0.5]", "[0.5, -1]"), r"w.world.yaml:5: .*size\[1\]: should be gr"),
    "text for a number": (
        changed("w.world.yaml", "2.25", "left"),
        "w.world.yaml:5: .*x: should be a number, not 'left'",
    ),
    "not finite": (changed("w.world.yaml", "2.25", ".nan"), "w.world.yaml:5: .*x: should be a finite number, not nan"),
    "mapping for a list": (changed("w.world.yaml", "- [1, 1, 0]", "x: 1"), "w.world.yaml:8: starts: should be a list"),
    "short start": (
        changed("w.world.yaml", "[1, 1, 0]", "[1, 1]"),
        r"w.world.yaml:9: key 'starts\[0\]\[2\]' is missing",
    ),
    "unknown bearer": (
        changed("w.world.yaml", "on: desk_1", "on: desk"),
        r"w.world.yaml:7: object 'mug_1' is on unknown furniture 'desk' \(did you mean 'desk_1'\?\)",
    ),
    "object outside": (
        changed("w.world.yaml", "x: 2.2,", "x: 22,"),
        r"w.world.yaml:7: objects 'mug_1' at \(22, 2.2\) is outside the map \(x 0 to 5, y 0 to 4\)",
    ),
    "start in an obstacle": (
        changed("w.world.yaml", "[1, 1, 0]", "[2.2, 2.2, 0]"),
        r"w.world.yaml:9: start \(2.2, 2.2\) is in an obstacle \(a free cell is needed\)",
    ),
    "id twice": (
        changed(
            "w.world.yaml", "starts:", "  - {id: mug_1, category: cup, x: 1, y: 1, z: 0, size: [1, 1, 1]}\nstarts:"
        ),
        r"w.world.yaml:8: objects id 'mug_1' occurs twice \(first in line 7\)",
    ),
    "key twice": (changed("w.world.yaml", "name: home", "name: a\nname: b"), "w.world.yaml:3: key 'name' occurs twice"),
    "syntax": (changed("w.world.yaml", "[1, 1, 0]", "[1, 1, 0"), "w.world.yaml:10: is not YAML: expected ',' or ']'"),
    "empty": (changed("w.world.yaml", WORLD, ""), r"w.world.yaml:1: should hold keys and values \(format, name"),
    "map is missing": (
        changed("w.world.yaml", "home.yaml", "hme.yaml"),
        r"w.world.yaml:3: map: no file hme.yaml \(a map",
    ),
    "map without cells' size": (changed("home.yaml", "0.05", "0"), "home.yaml:3: resolution: should be greater than 0"),
    "map rotated": (
        changed("home.yaml", "[0.0, 0.0, 0.0]", "[0, 0, 1]"),
        r"home.yaml:\d: origin is rotated by 1 rad \(rotated maps are not supported; write 0\)",
    ),
    "map syntax": (changed("home.yaml", "0.0]", "0.0"), "home.yaml:5: is not YAML: expected ',' or ']'"),
    "image is missing": (changed("home.yaml", "home.pgm", "hme.pgm"), "hme.pgm: no such file"),
    "image is text": (lambda: Path("home.pgm").write_text("hello"), r"home.pgm: not a PGM image \(a header"),
}
ROBOTS = {
    "format": (changed("r.robot.yaml", "robot/1", "robot/9"), "r.robot.yaml:2: format: should be 'zavis-robot/1', not"),
    "unknown key": (
        changed("r.robot.yaml", "beams: 360", "beans: 360"),
        r"r.robot.yaml:12: unknown key 'lidar.beans' \(did you mean 'beams'\?\)",
    ),
    "negative radius": (
        changed("r.robot.yaml", "0.18", "-1"),
        "r.robot.yaml:4: footprint.radius: should be greater than",
    ),
    "text for a number": (
        changed("r.robot.yaml", "0.6 ", "fast "),
        "r.robot.yaml:6: limits.max_linear: should be a numb",
    ),
    "ranges reversed": (
        changed("r.robot.yaml", "range_min: 0.05", "range_min: 20"),
        "r.robot.yaml:11: lidar: range_min m",
    ),
    "syntax": (changed("r.robot.yaml", "[640, 480]", "[640, 480"), r"r.robot.yaml:\d+: is not YAML: expected"),
    "list": (changed("r.robot.yaml", ROBOT, "[1]"), r"r.robot.yaml:1: should hold keys and values \(format"),
}
TREES = {
    "unknown kind": (tree("scna"), r"t.yaml:6:9: error\[kind\]: unknown kind 'scna' \(did you mean 'scan'\?\)"),
    "misspelt argument": (
        tree("{scan: {target: $target, turn: 1}}"),
        r"t.yaml:6:34: error\[argument\]: 'scan' has no argument 'turn' \(did you mean 'turns'\?\)",
    ),
    "unknown variable": (
        tree("{scan: {target: $tarket}}"),
        r"t.yaml:6:25: error\[name\]: unknown variable '\$tarket' \(",
    ),
    "type": (tree("{back_up: {distance: far}}"), r"t.yaml:6:30: error\[type\]: 'distance' takes float, not 'far'"),
    "range": (tree("{wait: {seconds: -1}}"), r"t.yaml:6:26: error\[range\]: 'seconds' is -1.0 s \(at least 0 s\)"),
    "missing argument": (tree("scan"), r"t.yaml:6:9: error\[missing-argument\]: 'scan' needs 'target': what"),
    "no kind": (tree("{retry: 3}"), r"t.yaml:6:9: error\[kind\]: no kind beside 'retry' \("),
    "itself": (tree("{m: {target: $target}}"), r"t.yaml:6:10: error\[recursion\]: tree 'm' contains itself: m → m \("),
    "syntax": (changed("t.yaml", "root: m", "root: [m"), r"t.yaml:3:\d+: error\[syntax\]: expected ',' or ']'"),
    "tab": (changed("t.yaml", "root: m", "\troot: m"), r"t.yaml:2:1: error\[syntax\]: found character '\\t'"),
    "newer format": (changed("t.yaml", "bt: 1", "bt: 2"), r"t.yaml:1:5: error\[version\]: format 2 is newer than this"),
    "unknown root": (
        changed("t.yaml", "root: m", "root: n"),
        r"t.yaml:2:7: error\[root\]: there is no tree 'n' \(one of: m\)",
    ),
    "missing include": (
        changed("t.yaml", "root: m", "include: [safety.yaml]\nroot: m"),
        r"t.yaml:2:11: error\[include\]: safety.yaml: cannot be read: No such file or directory \(",
    ),
    "empty": (tree_file(""), r"t.yaml:1:1: error\[structure\]: a tree file is a mapping with 'bt', 'root' and 'trees'"),
}
EPISODES = {
    "not JSON": (second_line('{"id": '), r"e.jsonl:2: is not JSON: .* \(one object a line\)"),
    "list": (second_line([1]), "e.jsonl:2: should be an object"),
    "unknown key": (second_line(other(strat=1)), r"e.jsonl:2: unknown key 'strat' \(did you mean 'start'\?\)"),
    "missing key": (
        second_line({key: value for key, value in other().items() if key != "start"}),
        "e.jsonl:2: key 'start' is missing",
    ),
    "short start": (second_line(other(start=[1, 1])), r"e.jsonl:2: key 'start\[2\]' is missing"),
    "not finite": (second_line(other(start=[float("nan"), 1, 0])), r"e.jsonl:2: start\[0\]: should be a finite number"),
    "negative length": (
        second_line(other(shortest_path_length=-1)),
        "e.jsonl:2: shortest_path_length: should be greater",
    ),
    "no such instance": (
        second_line(other(target={"category": "mug", "instances": ["mug_2"]})),
        r"e.jsonl:2: target.instances: no object has the id 'mug_2' \(did you mean 'mug_1'\?\)",
    ),
    "other category": (
        second_line(other(target={"category": "cup", "instances": ["mug_1"]})),
        r"e.jsonl:2: target.instances: 'mug_1' is of category 'mug' \(not 'cup'\)",
    ),
    "no such world": (
        second_line(other(world="no.yaml")),
        r"e.jsonl:2: world: no such file: no.yaml \(a path relative",
    ),
    "id twice": (second_line(other(id="e1")), r"e.jsonl:2: id 'e1' stands in line 1 already \(give every"),
    "none": (lambda: Path("e.jsonl").write_text("\n"), r"e.jsonl: holds no episodes \(one JSON object a line\)"),
}


def test_the_files_are_good_before_they_are_broken():
    assert zavis("world", "check", "w.world.yaml").exit_code == 0
    assert zavis("tree", "check", "t.yaml").exit_code == 0
    assert run().exit_code == 0


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize(("spoil", "says"), WORLDS.values(), ids=WORLDS)
def test_a_broken_world_is_refused_in_one_line(spoil, says):
    spoil()
    assert_refused(zavis("world", "check", "w.world.yaml"), says)
    assert_refused(run(), says)


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize(("spoil", "says"), ROBOTS.values(), ids=ROBOTS)
def test_a_broken_robot_is_refused_in_one_line(spoil, says):
    spoil()
    assert_refused(run(), says)
    assert_refused(bench("--robot", "r.robot.yaml"), says)


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize(("spoil", "says"), TREES.values(), ids=TREES)
def test_a_broken_tree_is_refused_in_one_line(spoil, says):
    spoil()
    assert_refused(zavis("tree", "check", "t.yaml"), says)
    assert_refused(run(), says)
    assert_refused(bench("--method", "t.yaml"), says)


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize(("spoil", "says"), EPISODES.values(), ids=EPISODES)
def test_broken_episodes_are_refused_in_one_line(spoil, says):
    spoil()
    assert_refused(bench(), says)


@pytest.mark.usefixtures("_nothing_moves")
def test_nothing_is_suggested_that_would_not_do(tmp_path):
    (tmp_path / "alone").mkdir()
    (tmp_path / "alone" / "t.yaml").write_text("bt: 1\ninclude: [no.yaml]\nroot: m\ntrees: {m: {do: succeed}}\n")
    included = zavis("tree", "check", "alone/t.yaml").output.strip()
    assert included.endswith("error[include]: alone/no.yaml: cannot be read: No such file or directory")
    (tmp_path / "folder.world.yaml").mkdir()
    assert "did you mean 'folder" not in run(world="folder.world.yaml").output
    tree("{sequence: [m]}")()
    assert "6:21: error[missing-argument]: 'm' needs 'target'\n" in zavis("tree", "check", "t.yaml").output


@pytest.mark.usefixtures("_nothing_moves")
def test_a_tree_with_several_faults_has_a_line_for_each():
    tree("{sequence: [scna, {wait: {seconds: -1}}, {scan: {target: $target, turn: 1}}]}")()
    result = zavis("tree", "check", "t.yaml")
    assert result.exit_code == 1
    assert [re.match(r"t.yaml:6:\d+: error\[(\w+)\]", line)[1] for line in result.output.splitlines()] == [
        "kind",
        "range",
        "argument",
    ]

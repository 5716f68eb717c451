"""Mocks: missions without a robot."""

from __future__ import annotations

from pathlib import Path

import pytest
from tree_kinds import REGISTRY, SAFETY, SEARCH, Bench, ManualClock, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import Status, check_tree, load_tree

MOCKS = """\
bt: 1
mocks:
  navigate: {delay: 1.0, reason: driving, outputs: {path_length: 2}}
  generate_waypoints:
    outputs: {waypoints: [{pose: [1, 2], look_at: [1, 3, 0.5], radius: 0.2, landmark: 0, label: desk}]}
  confirm:
    - {status: failure, reason: not mine}
    - success
  safety.estop_clear: success
"""


def test_a_mission_runs_on_its_mocks(tmp_path: Path) -> None:
    write(tmp_path, SAFETY, "safety.yaml")
    mocks = write(tmp_path, MOCKS, "mocks.yaml")
    tree = load_tree(write(tmp_path, SEARCH), REGISTRY, {"target": "mug"}, mocks=mocks)
    clock = ManualClock()
    tree.setup({"clock": clock})
    while tree.tick() is Status.RUNNING and clock.time < 10:
        clock.time += 0.1
    assert tree.status is Status.SUCCESS
    assert clock.time == pytest.approx(2.2, abs=0.25)
    kinds = {state.id: state for state in tree.nodes()}
    assert "safety.estop_clear/estop_released" not in kinds
    assert tree.variables["search/guard.do/mission.waypoints"][0].pose.y == 2.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bt: 1\nmocks: {navgate: success}\n", r"2:9: error\[kind\]: unknown kind 'navgate' \(did you mean 'navigate'"),
        ("bt: 1\nmocks: {navigate: sucess}\n", r"2:19: error\[type\]: 'sucess' is no status \(did you mean 'success'"),
        ("bt: 1\nmocks: {scan: {delay: -1}}\n", r"2:23: error\[range\]: 'delay' is -1.0 s \(at least 0 s\)"),
        ("bt: 1\nmocks: {scan: {dely: 1}}\n", r"error\[structure\]: unknown key 'dely' in a take"),
        ("bt: 1\nmocks: {scan: {outputs: {x: 1}}}\n", r"error\[argument\]: 'scan' has no output 'x'"),
        ("bt: 1\nmocks: {produce: {outputs: {total: x}}}\n", r"error\[type\]: 'total' takes int, not 'x'"),
        ("bt: 1\nmocks: {scan: []}\n", "a script needs at least one entry"),
        ("bt: 7\nmocks: {}\n", r"1:5: error\[version\]"),
        ("mocks: {}\n", "a file of mocks is 'bt: 1' and 'mocks'"),
        ("bt: 1\nmocks: [", r"error\[syntax\]"),
    ],
)
def test_faulty_mocks_are_reported(tmp_path: Path, text: str, message: str) -> None:
    write(tmp_path, SAFETY, "safety.yaml")
    with pytest.raises(TreeError, match=message):
        check_tree(write(tmp_path, SEARCH), REGISTRY, mocks=write(tmp_path, text, "mocks.yaml"))


def test_a_running_mock_never_ends(tmp_path: Path) -> None:
    mocks = write(tmp_path, "bt: 1\nmocks: {scan: running}\n", "mocks.yaml")
    path = write(tmp_path, "bt: 1\nroot: m\ntrees: {m: {do: scan}}\n")
    mission = Bench(load_tree(path, REGISTRY, mocks=mocks))
    assert mission.tick(20) is Status.RUNNING

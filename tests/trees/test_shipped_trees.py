"""The trees that come along: without fault, in canonical form, and what they do when their parts succeed or fail."""

from __future__ import annotations

import inspect
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
from typer.testing import CliRunner

import behaviours
from zavis_bt.cli.files import resolve_tree
from zavis_bt.cli.main import app
from zavis_bt.tree import Behaviour, Registry, Runner, Status, check_tree, load_tree, read_inputs
from zavis_bt.tree.formatting import format_text
from zavis_bt.tree.mocks import Mock

FOLDER = Path(__file__).parents[2] / "trees"
TREES = sorted(FOLDER.glob("*.yaml"))
REGISTRY = Registry.from_entry_points()

KINDS = [getattr(behaviours, name) for name in behaviours.__all__]
PORTS = [(kind, name, port) for kind in KINDS for name, port in (kind.in_ports | kind.out_ports).items()]

HERE = "{pose: [1, 2, 0], look_at: [1, 3, 0.5], radius: 0.2, landmark: 0, label: desk}"
THERE = "{pose: [4, 2, 0], look_at: [4, 3, 0.5], radius: 0.2, landmark: 1, label: sofa}"
ALONE = {kind.kind: "success" for kind in KINDS} | {"scan": "{delay: 2.0}", "navigate": "{delay: 5.0}"}
"""Mocks of all kinds: everything works out at once, but looking around and driving take time."""
NOTHING = {
    "confirm": "failure",
    "found": "{status: failure, reason: not found}",
    "forget_visits": "[success, {status: failure, reason: searched everything}]",
}


def landmarks(*rounds: str) -> dict[str, str]:
    """Mock the waypoints of successive calls at one place in the tree; afterwards there are none."""
    takes = [*(f"{{outputs: {{waypoints: [{each}]}}}}" for each in rounds), "{status: failure, reason: none left}"]
    return {"generate_waypoints": f"[{', '.join(takes)}]"}


class Clock:
    """Time passes when somebody waits."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        self.time = max(self.time, stamp)


@dataclass(frozen=True)
class Ended:
    """How a mission on mocks ended."""

    status: Status
    reason: str
    seconds: float
    started: Counter[str]
    """How often each kind was started."""


def run(tree: str, folder: Path, *changes: dict[str, str]) -> Ended:
    """Run a shipped tree with every kind mocked."""
    mocks = {kind: take for each in (ALONE, *changes) for kind, take in each.items()}
    path = folder / "mocks.yaml"
    path.write_text("bt: 1\nmocks:\n" + "".join(f"  {kind}: {take}\n" for kind, take in mocks.items()))
    mission, clock = load_tree(resolve_tree(tree), REGISTRY, {"target": "mug"}, mocks=path), Clock()
    mission.setup({"clock": clock})
    runner = Runner(mission, clock, after=[lambda: runner.stop("it does not end") if clock.time > 900 else None])
    outcome = runner.run()
    started: Counter[str] = Counter()
    for node in mission.root.iterate():
        if isinstance(node, Mock):
            started[type(node).__name__.removeprefix("Mock_")] += node.runs
    return Ended(outcome.status, outcome.reason, clock.time, started)


# -- their form ------------------------------------------------------------------------------------------------------


def test_the_three_methods_come_along():
    assert {"search", "nearest", "frontier_only"} <= {path.stem for path in TREES}


@pytest.mark.parametrize("path", TREES, ids=lambda path: path.stem)
def test_a_shipped_tree_has_no_fault(path):
    check_tree(path, REGISTRY)


@pytest.mark.parametrize("path", TREES, ids=lambda path: path.stem)
def test_a_shipped_tree_is_in_canonical_form(path):
    text = path.read_text(encoding="utf-8")
    assert format_text(text, str(path)) == text


def test_the_commands_agree():
    files = [str(path) for path in TREES]
    assert CliRunner().invoke(app, ["tree", "check", *files]).exit_code == 0
    assert CliRunner().invoke(app, ["tree", "fmt", "--check", *files]).exit_code == 0


@pytest.mark.parametrize("path", TREES, ids=lambda path: path.stem)
def test_a_shipped_tree_needs_nothing_but_a_target_and_says_what_it_is(path):
    inputs = read_inputs(path, REGISTRY)
    assert [item.name for item in inputs if item.required] == ["target"]
    assert next(item for item in inputs if item.name == "target").doc
    lines = path.read_text(encoding="utf-8").splitlines()
    assert any(line.startswith("# ") and "$schema" not in line for line in lines)


# -- what they are made of -------------------------------------------------------------------------------------------


def test_every_public_behaviour_can_be_used_in_trees():
    assert all(issubclass(kind, Behaviour) for kind in KINDS)
    assert {kind.kind for kind in KINDS} <= set(REGISTRY)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.kind)
def test_every_kind_says_what_it_does(kind):
    doc = inspect.cleandoc(vars(kind)["__doc__"])
    assert doc.splitlines()[0].endswith(".")


@pytest.mark.parametrize(("kind", "name", "port"), PORTS, ids=[f"{kind.kind}.{name}" for kind, name, _ in PORTS])
def test_every_port_says_what_it_carries(kind, name, port):
    assert port.description.strip()


# -- what they do, without a robot -----------------------------------------------------------------------------------


@pytest.mark.parametrize("tree", ["search", "nearest", "frontier_only"])
def test_what_the_first_scan_shows_is_confirmed_without_driving(tmp_path, tree):
    ended = run(tree, tmp_path)
    assert ended.status is Status.SUCCESS
    assert ended.started["scan"] == ended.started["confirm"] == ended.started["found"] == 1
    assert ended.started["navigate"] == ended.started["go_to_frontier"] == 0
    assert ended.seconds == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("tree", ["search", "nearest"])
def test_landmarks_are_visited_looked_at_and_asked_about_before_the_map_is_widened(tmp_path, tree):
    nothing_left = {"go_to_frontier": "{status: failure, reason: explored}"}
    ended = run(tree, tmp_path, NOTHING, landmarks(f"{HERE}, {THERE}"), nothing_left)
    started = ended.started
    assert ended.status is Status.FAILURE
    assert ended.reason == "not found"
    # Both as likely landmarks, and both again as unlikely ones once all is explored.
    assert started["navigate"] == started["look"] == started["detect"] == 4
    assert ended.seconds == pytest.approx(2 + 4 * 5, abs=4)


@pytest.mark.parametrize("tree", ["search", "nearest", "frontier_only"])
def test_every_frontier_is_followed_by_a_scan_until_none_is_left(tmp_path, tree):
    frontiers = {"go_to_frontier": "[success, success, success, {status: failure, reason: explored}]"}
    ended = run(tree, tmp_path, NOTHING, landmarks(), frontiers)
    assert (ended.status, ended.reason) == (Status.FAILURE, "not found")
    assert ended.started["scan"] == 1 + 3
    assert ended.started["found"] == 1


def test_what_a_later_scan_shows_is_confirmed(tmp_path):
    ended = run("search", tmp_path, landmarks(), {"confirm": "[failure, failure, success]"})
    assert ended.status is Status.SUCCESS
    assert ended.started["scan"] == ended.started["confirm"] == 3


def test_a_landmark_that_cannot_be_reached_is_tried_twice_and_left_for_the_next(tmp_path):
    blocked = {"navigate": "[{status: failure, reason: blocked}, {status: failure, reason: blocked}, {delay: 5.0}]"}
    ends = {"go_to_frontier": "failure"}
    ended = run("search", tmp_path, NOTHING, landmarks(f"{HERE}, {THERE}"), blocked, ends)
    assert ended.status is Status.FAILURE
    assert ended.started["back_up"] >= 1
    assert 1 <= ended.started["look"] == ended.started["detect"] < ended.started["navigate"]


@pytest.mark.parametrize("guard", ["estop_clear", "battery_above"])
def test_the_search_ends_when_it_is_not_safe_to_go_on(tmp_path, guard):
    late = {guard: f"[{', '.join(['success'] * 10)}, {{status: failure, reason: unsafe}}]"}
    ended = run("search", tmp_path, NOTHING, late)
    assert ended.status is Status.FAILURE
    assert ended.reason == "emergency stop or low battery"
    assert ended.seconds == pytest.approx(1.0, abs=0.2)
    assert ended.started["navigate"] == 0


def test_driving_that_never_ends_is_given_up(tmp_path):
    stuck = {"navigate": "running", "go_to_frontier": "failure"}
    ended = run("search", tmp_path, NOTHING, landmarks(HERE), stuck)
    assert (ended.status, ended.reason) == (Status.FAILURE, "not found")
    assert ended.started["navigate"] == 4  # twice with a time limit, and twice again once all is explored
    assert ended.seconds == pytest.approx(2 + 4 * 120, abs=10)

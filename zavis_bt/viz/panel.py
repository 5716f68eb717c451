"""What the page says in words: the tree, and how the mission stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from zavis_bt.recording.tree_text import first_line
from zavis_bt.types import MissionResult, NodeState, Observed


def tree_rows(nodes: Sequence[NodeState]) -> list[list[Any]]:
    """Return depth, name, kind, status and reason of each node."""
    return [[node.depth, node.name, node.kind, node.status.value, first_line(node.reason)] for node in nodes]


def facts(mission: Observed) -> list[list[str]]:
    """Return the lines of numbers: what, and how much."""
    pose, twist = mission.base.pose, mission.base.twist
    driven = float(np.linalg.norm(np.diff(mission.trajectory, axis=0), axis=1).sum())
    return [
        ["time", f"{mission.stamp:.1f} s"],
        ["driven", f"{driven:.1f} m"],
        ["speed", f"{twist.linear:.2f} m/s"],
        ["battery", f"{100 * mission.base.battery:.0f} %"],
        ["landmarks", str(len(mission.landmarks))],
        ["candidates", str(len(mission.candidates))],
        ["viewpoints", f"{len(mission.visited)} visited, {len(mission.viewpoints)} ahead"],
        ["pose", f"{pose.x:.2f} m, {pose.y:.2f} m, {math.degrees(pose.yaw):.0f}°"],
    ]


def verdict(result: MissionResult) -> dict[str, str]:
    """Return how the mission ended."""
    outcome = "found" if result.success else "not found"
    text = result.reason if result.reason not in ("found", "") else f"after {result.path_length:.1f} m"
    return {"outcome": outcome, "text": first_line(text), "status": "SUCCESS" if result.success else "FAILURE"}

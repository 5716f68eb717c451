"""The tree as text."""

from __future__ import annotations

from collections.abc import Sequence

from zavis_bt.types import NodeState, NodeStatus

_MARKS = {NodeStatus.SUCCESS: "✓", NodeStatus.FAILURE: "✗", NodeStatus.RUNNING: "→", NodeStatus.INVALID: "·"}


def first_line(text: str, longest: int = 160) -> str:
    """Return the first line of a text that is not empty, cut to a length: reasons can be whole error reports."""
    line = next((line.strip() for line in text.splitlines() if line.strip()), "")
    return line if len(line) <= longest else line[: longest - 1].rstrip() + "…"


def tree_text(nodes: Sequence[NodeState]) -> str:
    """Return one line a node, indented by depth: status, name, kind where the name does not say it, reason."""
    return "".join(f"{'  ' * node.depth}{_MARKS[node.status]} {_described(node)}\n" for node in nodes)


def _described(node: NodeState) -> str:
    kind = f" ({node.kind})" if node.kind != node.name else ""
    reason = f": {first_line(node.reason)}" if node.reason else ""
    return f"{node.name}{kind}{reason}"

"""The tree as text."""

from __future__ import annotations

from collections.abc import Sequence

from zavis_bt.types import NodeState, NodeStatus

_MARKS = {NodeStatus.SUCCESS: "✓", NodeStatus.FAILURE: "✗", NodeStatus.RUNNING: "→", NodeStatus.INVALID: "·"}


def tree_text(nodes: Sequence[NodeState]) -> str:
    """Return one line a node, indented by depth: status, name, kind where the name does not say it, reason."""
    return "".join(f"{'  ' * node.depth}{_MARKS[node.status]} {_described(node)}\n" for node in nodes)


def _described(node: NodeState) -> str:
    kind = f" ({node.kind})" if node.kind != node.name else ""
    reason = f": {node.reason}" if node.reason else ""
    return f"{node.name}{kind}{reason}"

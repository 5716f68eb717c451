"""Which node decided an outcome."""

from __future__ import annotations

import py_trees
from py_trees.common import Status

Node = py_trees.behaviour.Behaviour


def deciding_path(root: Node) -> list[Node]:
    """Return the nodes from the root down to the deepest one that decided the root's status.

    A composite hands the decision to the child that ended it; a decorator to its child, unless the child was stopped
    (a timeout) or has nothing to do with it.
    """
    path = [root]
    while (child := _decider(path[-1])) is not None:
        path.append(child)
    return path


def _decider(node: Node) -> Node | None:
    if isinstance(node, py_trees.composites.Composite):
        child = node.current_child
        if child is not None and child.status in (node.status, Status.FAILURE):
            return child
        return next((child for child in node.children if child.status is node.status), None)
    if isinstance(node, py_trees.decorators.Decorator):
        return node.decorated if node.decorated.status is not Status.INVALID else None
    return None

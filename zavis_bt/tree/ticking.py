"""Ticking without the tour."""

from __future__ import annotations

from collections.abc import Iterator

import py_trees

Node = py_trees.behaviour.Behaviour


def alone(node: Node) -> Node:
    """Make a node's tick yield the node alone, and return it.

    py_trees hands every ticked node up through all its ancestors, for visitors that walk along. Nobody does here (the
    tree is looked at after the tick), and in a deep tree the tour costs more than the ticks.
    """
    through = node.tick

    def tick() -> Iterator[Node]:
        for _ in through():
            pass
        yield node

    node.tick = tick  # type: ignore[method-assign]  # composites call the instance's
    return node

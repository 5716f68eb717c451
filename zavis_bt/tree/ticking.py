"""Ticking without the tour."""

from __future__ import annotations

from collections.abc import Iterator

import py_trees
from py_trees.common import Status
from py_trees.decorators import Decorator

Node = py_trees.behaviour.Behaviour


def alone(node: Node) -> Node:
    """Make a node's tick yield the node alone, and return it.

    py_trees hands every ticked node up through all its ancestors, for visitors that walk along. Nobody does here (the
    tree is looked at after the tick), and in a deep tree the tour costs more than the ticks.
    """
    if isinstance(node, Decorator) and type(node).tick is Decorator.tick:
        return _plain_decorator(node)
    through = node.tick

    def tick() -> Iterator[Node]:
        for _ in through():
            pass
        yield node

    node.tick = tick  # type: ignore[method-assign]  # composites call the instance's
    return node


def _plain_decorator(node: Decorator) -> Decorator:
    """Give a decorator py_trees' own tick without its log line and its search through the list of all states."""

    def tick() -> Iterator[Node]:
        if node.status is not Status.RUNNING:
            node.initialise()
        for _ in node.decorated.tick():
            pass
        status = node.update()
        if status is not Status.RUNNING:
            node.stop(status)
        node.status = status
        yield node

    node.tick = tick  # type: ignore[method-assign]  # composites call the instance's
    return node

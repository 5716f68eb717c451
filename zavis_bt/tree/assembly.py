"""py_trees objects for the built-in kinds that hold other nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import py_trees
from py_trees.common import ParallelPolicy

from zavis_bt.tree.composites import ForEach, Guard, ReactiveSelector, Recovery
from zavis_bt.tree.condition import parse_condition
from zavis_bt.tree.decorators import Condition, Repeat, Retry, Timeout, When
from zavis_bt.tree.nodes import label
from zavis_bt.tree.scope import Binding, Scope, Variable
from zavis_bt.tree.spec import NodeSpec
from zavis_bt.tree.ticking import alone

Node = py_trees.behaviour.Behaviour


@dataclass(frozen=True, slots=True)
class Parts:
    """What a control node is made of."""

    spec: NodeSpec
    name: str
    given: Mapping[str, Any]
    """Arguments that are known at load."""
    slots: Mapping[str, list[Node]]
    """Children that are built already."""
    scope: Scope
    items: Binding | None = None
    """What a loop goes through."""

    @property
    def do(self) -> Node:
        """The only child of the slot ``do``."""
        return self.slots["do"][0]


def assemble(parts: Parts) -> Node:
    """Return the node of a built-in kind."""
    return alone(_ASSEMBLERS[parts.spec.kind](parts))


def _sequence(parts: Parts) -> Node:
    memory = parts.spec.kind == "sequence"
    return py_trees.composites.Sequence(parts.name, memory=memory, children=parts.slots["do"])


def _parallel(parts: Parts) -> Node:
    children, until = parts.slots["do"], parts.given["until"]
    # py_trees' default, synchronised, would skip a monitor for good once it has succeeded.
    policy: ParallelPolicy.Base = ParallelPolicy.SuccessOnAll(synchronise=False)
    if until == "any":
        policy = ParallelPolicy.SuccessOnOne()
    elif until != "all":
        names = [until] if isinstance(until, str) else until
        pairs = zip(children, parts.spec.children["do"], strict=True)
        chosen = [child for child, written in pairs if label(written) in names]
        policy = ParallelPolicy.SuccessOnSelected(chosen, synchronise=False)
    return py_trees.composites.Parallel(parts.name, policy, children)


def _guard(parts: Parts) -> Node:
    otherwise = parts.slots["else"][0] if "else" in parts.slots else None
    return Guard(parts.name, parts.slots["while"], parts.do, otherwise)


def _for_each(parts: Parts) -> Node:
    assert parts.items is not None
    item = cast(Variable, parts.scope[parts.given["as"]])
    return ForEach(parts.name, parts.do, parts.items, item, parts.given["until"])


def _when(parts: Parts) -> Node:
    text = str(parts.spec.arguments["condition"].value)
    check = parse_condition(text).compile()
    if "do" in parts.slots:
        return When(parts.name, parts.do, check, text, parts.scope)
    return cast(Node, Condition(parts.name, check, text, parts.scope))


def _retry(parts: Parts) -> Node:
    if "recover" in parts.slots:
        return Recovery(parts.name, parts.do, parts.slots["recover"][0], parts.given["attempts"])
    return Retry(parts.name, parts.do, parts.given["attempts"])


def _repeat(parts: Parts) -> Node:
    times = parts.given["times"]
    return Repeat(parts.name, parts.do, -1 if times == "forever" else times)


_ASSEMBLERS: Mapping[str, Callable[[Parts], Node]] = {
    "sequence": _sequence,
    "reactive_sequence": _sequence,
    "selector": lambda parts: py_trees.composites.Selector(parts.name, memory=True, children=parts.slots["do"]),
    "reactive_selector": lambda parts: ReactiveSelector(parts.name, parts.slots["do"]),
    "parallel": _parallel,
    "guard": _guard,
    "for_each": _for_each,
    "when": _when,
    "retry": _retry,
    "repeat": _repeat,
    "timeout": lambda parts: Timeout(parts.name, parts.do, parts.given["seconds"]),
    "invert": lambda parts: py_trees.decorators.Inverter(parts.name, parts.do),
    "force_success": lambda parts: py_trees.decorators.FailureIsSuccess(parts.name, parts.do),
    "force_failure": lambda parts: py_trees.decorators.SuccessIsFailure(parts.name, parts.do),
}

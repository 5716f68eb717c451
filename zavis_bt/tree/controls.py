"""The built-in kinds that hold other nodes, and the modifiers that are short for some of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from zavis_bt.tree.ports import MISSING, Port
from zavis_bt.tree.spec import Signature


@dataclass(frozen=True, slots=True)
class Slot:
    """A place for children."""

    name: str
    many: bool = False
    required: bool = True


@dataclass(frozen=True, slots=True)
class Control:
    """A built-in kind: its arguments, where its children go, and what a bare value after its name means."""

    kind: str
    doc: str
    slots: tuple[Slot, ...]
    inputs: Mapping[str, Port] = field(default_factory=dict)
    runtime: frozenset[str] = frozenset()
    """Inputs that may come from variables; the others must be known when the tree is loaded."""
    shorthand: str = ""
    """Slot or input that a bare value stands for."""

    @property
    def signature(self) -> Signature:
        """Its interface."""
        return Signature(self.kind, self.doc, self.inputs, {}, frozenset(self.inputs) - self.runtime)

    def slot(self, name: str) -> Slot | None:
        """Return the slot of that name."""
        return next((slot for slot in self.slots if slot.name == name), None)


def _input(type_: Any, doc: str, default: Any = MISSING, **limits: Any) -> Port:
    return Port(type_, default is MISSING, doc, None if default is MISSING else default, **limits)


_MANY = (Slot("do", many=True),)
_ONE = (Slot("do"),)
_SECONDS = _input(float, "on the mission's clock", unit="s", gt=0.0)

CONTROLS: Mapping[str, Control] = {
    control.kind: control
    for control in (
        Control(
            "sequence",
            "Run the children in turn while they succeed; a running child keeps its place over ticks.",
            _MANY,
            shorthand="do",
        ),
        Control(
            "selector",
            "Run the children in turn until one succeeds; a running child keeps its place over ticks.",
            _MANY,
            shorthand="do",
        ),
        Control("reactive_sequence", "A sequence that starts over at each tick.", _MANY, shorthand="do"),
        Control(
            "reactive_selector",
            "A selector that starts over at each tick. The running child is stopped before an action of higher "
            "priority starts.",
            _MANY,
            shorthand="do",
        ),
        Control(
            "parallel",
            "Tick all children at each tick; fails as soon as one fails.",
            _MANY,
            {"until": _input(str | list[str], "succeed when all, any or the named children have succeeded", "all")},
        ),
        Control(
            "guard",
            "Run `do` while the conditions hold, which are checked at every tick. When one fails, `do` is stopped "
            "and then `else` runs (without it the guard fails). What `do` or `else` returns is the outcome.",
            (Slot("while", many=True), Slot("do"), Slot("else", required=False)),
        ),
        Control(
            "for_each",
            "Run `do` for each item, one after another. `until: success` ends at the first success and fails when "
            "there is none; `until: failure` ends at the first failure and succeeds when there is none; `until: all` "
            "takes every item, whatever comes, and succeeds. Without items `success` fails, the others succeed.",
            _ONE,
            {
                "items": _input(list[Any], "what to go through, as it is when the loop starts"),
                "as": _input(str, "variable that holds the item, inside `do`"),
                "until": _input(str, "what ends the loop", "failure", choices=("success", "failure", "all")),
            },
            runtime=frozenset(("items",)),
        ),
        Control(
            "when",
            "Compare, for example `$battery > 0.3 and $round < 5`. With `do` (or beside another kind): checked when "
            "the node starts, which fails if it does not hold.",
            (Slot("do", required=False),),
            {"condition": _input(str, "comparisons of $variables and constants, joined by and, or, not")},
            shorthand="condition",
        ),
        Control(
            "repeat",
            "Run `do` again and again while it succeeds.",
            _ONE,
            {"times": _input(int | Literal["forever"], "how often it must succeed", ge=1)},
            shorthand="times",
        ),
        Control(
            "retry",
            "Run `do` until it succeeds, at most `attempts` times; `recover` runs in between, whatever it returns.",
            (Slot("do"), Slot("recover", required=False)),
            {"attempts": _input(int, "how often to try", ge=1)},
            shorthand="attempts",
        ),
        Control(
            "timeout",
            "Stop `do` and fail when it takes longer.",
            _ONE,
            {"seconds": _SECONDS},
            shorthand="seconds",
        ),
        Control("invert", "Turn success into failure and failure into success.", _ONE, shorthand="do"),
        Control("force_success", "Succeed when `do` has ended, however it ended.", _ONE, shorthand="do"),
        Control("force_failure", "Fail when `do` has ended, however it ended.", _ONE, shorthand="do"),
    )
}

MODIFIERS = ("timeout", "retry", "repeat", "when")
"""Kinds that may stand beside another kind, the innermost first."""

DECORATIONS = ("name", "save", "recover", "do")
"""Further keys beside a kind: they say something of the node itself, of its `retry` or of its block."""

SET = "set"
"""The kind whose arguments are variables."""
SET_DOC = "Give variables a value: a constant or another variable's, for example `set: {round: 0}`."

LEAF_SHORTHAND: Mapping[str, str] = {"succeed": "reason", "fail": "reason", "wait": "seconds"}
"""Argument that a bare value stands for."""

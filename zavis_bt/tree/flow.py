"""The fourth stage of checks: what flows through variables, and whether it is there when it is read.

The analysis follows the order in which nodes can run. A leaf that has ended counts as having written what it saves,
whether it succeeded or failed; a variable is reported only where a way leads that passes no writer at all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.condition import parse_condition
from zavis_bt.tree.controls import SET
from zavis_bt.tree.datatypes import assignable, type_name
from zavis_bt.tree.includes import Library
from zavis_bt.tree.ports import Port
from zavis_bt.tree.spec import Argument, NodeSpec, Reference, TreeSpec
from zavis_bt.tree.variables import Symbol, symbols_of

Names = frozenset[str]


@dataclass(frozen=True, slots=True)
class Ends:
    """Variables surely written when a node has succeeded or failed; None if it never does."""

    success: Names | None
    failure: Names | None


def meet(*ways: Names | None) -> Names | None:
    """Return what is written on every way that can be taken."""
    taken = [way for way in ways if way is not None]
    return frozenset.intersection(*taken) if taken else None


def check_flow(tree: TreeSpec, library: Library) -> None:
    """Check every variable of a tree: known, of a fitting type, written before it is read, read at all."""
    _Flow(tree, library).check()


class _Flow:
    def __init__(self, tree: TreeSpec, library: Library) -> None:
        self._tree = tree
        self._library = library
        self._faults = library.faults
        self._symbols = symbols_of(tree, library)
        self._everything: Names = frozenset(self._symbols)
        self._read: set[str] = set()
        self._writers: dict[str, Argument] = {}
        self._rules: Mapping[str, Callable[[NodeSpec, Names], Ends]] = {
            "sequence": self._sequence,
            "reactive_sequence": self._sequence,
            "selector": self._selector,
            "reactive_selector": self._selector,
            "parallel": self._parallel,
            "guard": self._guard,
            "for_each": self._for_each,
            "when": self._when,
            "retry": self._retry,
            "timeout": self._timeout,
            "invert": self._invert,
            "force_success": lambda node, before: Ends(self._any(node, before), None),
            "force_failure": lambda node, before: Ends(None, self._any(node, before)),
        }

    def check(self) -> None:
        if self._tree.do is None:
            return
        given = (*self._tree.params, *self._tree.inputs, *self._library.globals)
        self._visit(self._tree.do, frozenset(given))
        for name, argument in self._writers.items():
            if self._symbols[name].role == "variable" and name not in self._read:
                self._faults.add(argument.key, "unused", f"'{name}' is written but never read (leave it out)")
        for name, declared in self._tree.outputs.items():
            if name not in self._writers:
                what = f"nothing writes the output '{name}' (save: {{…: {name}}} in a node of '{self._tree.name}')"
                self._faults.add(declared.mark, "unwritten", what)

    def _visit(self, node: NodeSpec, before: Names) -> Ends:
        self._read_arguments(node, before)
        rule = self._rules.get(node.kind)
        if rule is not None:
            return rule(node, before)
        if "do" in node.children:
            return self._do(node, before)
        return self._leaf(node, before)

    def _leaf(self, node: NodeSpec, before: Names) -> Ends:
        signature = self._library.signature(node.kind, self._tree.file)
        outputs = signature.outputs if signature else {}
        written = {str(argument.value): argument for argument in node.save.values()}
        self._read.update(str(argument.value) for port, argument in node.save.items() if port not in outputs)
        if node.kind == SET:
            written = dict(node.arguments)
        for name, argument in written.items():
            if name in self._symbols:
                self._writers.setdefault(name, argument)
        after = before.union(written)
        return Ends(None if node.kind == "fail" else after, None if node.kind in ("succeed", "wait", SET) else after)

    def _do(self, node: NodeSpec, before: Names) -> Ends:
        ends = Ends(before, before)
        for child in node.children.get("do", ()):
            ends = self._visit(child, before)
        return ends

    def _any(self, node: NodeSpec, before: Names) -> Names | None:
        ends = self._do(node, before)
        return meet(ends.success, ends.failure)

    def _sequence(self, node: NodeSpec, before: Names) -> Ends:
        now: Names | None = before
        failures = []
        for child in node.children.get("do", ()):
            ends = self._visit(child, self._everything if now is None else now)
            failures.append(None if now is None else ends.failure)
            now = None if now is None else ends.success
        return Ends(now, meet(*failures))

    def _selector(self, node: NodeSpec, before: Names) -> Ends:
        now: Names | None = before
        successes = []
        for child in node.children.get("do", ()):
            ends = self._visit(child, self._everything if now is None else now)
            successes.append(None if now is None else ends.success)
            now = None if now is None else ends.failure
        return Ends(meet(*successes), now)

    def _parallel(self, node: NodeSpec, before: Names) -> Ends:
        now = before
        for child in node.children.get("do", ()):
            ends = self._visit(child, now)  # children tick in order, so a later one may read an earlier one's output
            now |= meet(ends.success, ends.failure) or frozenset()
        until = node.arguments.get("until")
        return Ends(now if until is None or until.value != "any" else before, before)

    def _guard(self, node: NodeSpec, before: Names) -> Ends:
        now = before
        for child in node.children.get("while", ()):
            now = self._visit(child, now).success or now
        ends = self._do(node, now)
        if "else" not in node.children:
            return Ends(ends.success, before)
        others = [self._visit(child, before) for child in node.children["else"]]
        successes, failures = [other.success for other in others], [other.failure for other in others]
        return Ends(meet(ends.success, *successes), meet(ends.failure, *failures))

    def _for_each(self, node: NodeSpec, before: Names) -> Ends:
        item = {str(node.arguments["as"].value)} if "as" in node.arguments else set()
        ends = self._do(node, before | item)
        until = node.arguments["until"].value if "until" in node.arguments else "failure"
        success = None if ends.success is None else ends.success - item
        failure = None if ends.failure is None else ends.failure - item
        if until == "success":
            return Ends(success, before)
        return Ends(before, None if until == "all" else failure)

    def _when(self, node: NodeSpec, before: Names) -> Ends:
        if "do" not in node.children:
            return Ends(before, before)
        ends = self._do(node, before)
        return Ends(ends.success, before)

    def _retry(self, node: NodeSpec, before: Names) -> Ends:
        ends = self._do(node, before)
        for child in node.children.get("recover", ()):
            self._visit(child, self._everything if ends.failure is None else ends.failure)
        return ends

    def _timeout(self, node: NodeSpec, before: Names) -> Ends:
        return Ends(self._do(node, before).success, before)

    def _invert(self, node: NodeSpec, before: Names) -> Ends:
        ends = self._do(node, before)
        return Ends(ends.failure, ends.success)

    def _read_arguments(self, node: NodeSpec, before: Names) -> None:
        signature = self._library.signature(node.kind, self._tree.file)
        for name, argument in node.arguments.items():
            if node.kind == "when":
                self._read_condition(argument, before)
            elif isinstance(argument.value, Reference):
                port = signature.inputs.get(name) if signature else None
                self._read_name(argument.value.name, argument, before, optional=bool(port and not port.required))
                if port is not None and argument.value.name in self._symbols:
                    self._check_type(name, port, argument, self._symbols[argument.value.name])

    def _read_condition(self, argument: Argument, before: Names) -> None:
        try:
            condition = parse_condition(str(argument.value))
        except InputError:  # reported by the second stage
            return
        for name in condition.names:
            self._read_name(name, argument, before)
        types = {name: symbol.type for name, symbol in self._symbols.items()}
        for fault in condition.type_faults(types):
            self._faults.add(argument.mark, "type", fault)

    def _read_name(self, name: str, argument: Argument, before: Names, optional: bool = False) -> None:
        self._read.add(name)
        if name not in self._symbols:
            near = did_you_mean(f"${name}", _dollars(self._symbols))
            self._faults.add(argument.mark, "name", f"unknown variable '${name}'{near or ' (save writes one)'}")
        elif name not in before and not optional:
            symbol = self._symbols[name]
            what = f"'${name}' is known only inside the loop of line {symbol.mark.line} (save what it finds)"
            if symbol.role != "item":
                where = f"a way to here leaves out line {symbol.mark.line}, which writes it"
                what = f"'${name}' is read before it is written: {where} (or `set` a first value)"
            self._faults.add(argument.mark, "unwritten", what)

    def _check_type(self, name: str, port: Port, argument: Argument, symbol: Symbol) -> None:
        if port.unit and symbol.unit and port.unit != symbol.unit:
            self._faults.add(
                argument.mark, "type", f"'{name}' is in {port.unit}, but {argument.value} is in {symbol.unit}"
            )
        elif not assignable(symbol.type, port.value_type):
            what = f"'{name}' takes {type_name(port.value_type)}, but {argument.value} is {symbol.text}"
            self._faults.add(argument.mark, "type", what)


def _dollars(names: Iterable[str]) -> list[str]:
    return [f"${name}" for name in names]

"""From nodes as written to py_trees objects: trees are instantiated, names bound, ports wired."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

import py_trees

from zavis_bt.tree.arguments import value_fault
from zavis_bt.tree.assembly import Parts, assemble
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.controls import CONTROLS, SET
from zavis_bt.tree.decorators import Assign, Call
from zavis_bt.tree.faults import Mark
from zavis_bt.tree.includes import Library
from zavis_bt.tree.ports import Port
from zavis_bt.tree.scope import UNSET, Binding, Constant, Scope, Variable
from zavis_bt.tree.spec import Argument, FileSpec, NodeSpec, Reference, TreeSpec
from zavis_bt.tree.ticking import alone
from zavis_bt.tree.variables import symbols_of

Node = py_trees.behaviour.Behaviour


@dataclass(frozen=True, slots=True)
class Built:
    """A node of a built tree."""

    id: str
    kind: str
    depth: int
    mark: Mark
    """Where it is written."""
    node: Node


class Builder:
    """Builds one tree with everything below it."""

    def __init__(self, library: Library, mocks: Mapping[str, type[Behaviour]], namespace: str) -> None:
        """Prepare to build.

        Args:
            library: Files and kinds, already checked.
            mocks: Behaviours that take the place of kinds.
            namespace: Blackboard namespace of this tree, beginning with a slash.
        """
        self._library = library
        self._faults = library.faults
        self._mocks = mocks
        self._namespace = namespace
        self._calls: Counter[str] = Counter()
        self._instances = 0
        self.built: list[Built] = []
        self.globals = Scope(f"{namespace}/globals")
        for name, declared in library.globals.items():
            self._declare(self.globals, name, declared.port.value_type)
            if not declared.port.required:
                cast(Variable, self.globals[name]).write(declared.port.default_value)
        self.scopes: dict[str, Scope] = {}

    def build(self, tree: TreeSpec, values: Mapping[str, Any]) -> Node:
        """Return the root node; faults that only values show go to the library's collector.

        Args:
            tree: The root tree.
            values: Its params and inputs.
        """
        self._count(tree)
        bindings: dict[str, Binding] = {name: Constant(value) for name, value in values.items()}
        return self._tree(tree, tree.title, tree.title, tree.name, tree.mark, bindings, 0)

    def _count(self, tree: TreeSpec) -> None:
        self._calls[tree.title] += 1
        for node in tree.do.walk() if tree.do else ():
            called = tree.file.scope.get(node.kind)
            if called is not None and node.kind not in self._mocks:
                self._count(called)

    def _tree(
        self, tree: TreeSpec, id_: str, kind: str, name: str, mark: Mark, given: dict[str, Binding], depth: int
    ) -> Node:
        self._instances += 1
        scope = Scope(f"{self._namespace}/{self._instances}_{_key(tree.title)}", dict(self.globals.bindings))
        scope.bindings.update(given)
        for symbol in symbols_of(tree, self._library).values():
            if symbol.name not in scope.bindings:
                scope.own.append(self._declare(scope, symbol.name, symbol.type))
        self.scopes[id_] = scope
        position = self._reserve()
        prefix = tree.title if self._calls[tree.title] == 1 else id_
        assert tree.do is not None
        child = _Instance(self, tree, scope, prefix).node(tree.do, depth + 1)
        return self._place(position, alone(Call(name, child, scope.own)), id_, kind, depth, mark)

    def _declare(self, scope: Scope, name: str, type_: Any) -> Variable:
        scope.bindings[name] = variable = Variable(name, f"{scope.namespace}/{name}", type_)
        return variable

    def _reserve(self) -> int:
        self.built.append(cast(Built, None))
        return len(self.built) - 1

    def _place(self, position: int, node: Node, id_: str, kind: str, depth: int, mark: Mark) -> Node:
        self.built[position] = Built(id_, kind, depth, mark, node)
        return node


class _Instance:
    """Builds the nodes of one instance of a tree."""

    def __init__(self, builder: Builder, tree: TreeSpec, scope: Scope, prefix: str) -> None:
        self._builder = builder
        self._tree = tree
        self._file: FileSpec = tree.file
        self._scope = scope
        self._prefix = prefix

    def node(self, spec: NodeSpec, depth: int) -> Node:
        """Return the node and, below it, its children."""
        id_ = self._prefix + spec.id[len(self._tree.name) :]
        name = spec.name or spec.kind
        called = self._file.scope.get(spec.kind)
        mock = self._builder._mocks.get(called.title if called else spec.kind)
        if called is not None and mock is None:
            return self._call(called, spec, id_, name, depth)
        position = self._builder._reserve()
        if mock is not None or spec.kind in self._builder._library.behaviours:
            node = self._leaf(mock or self._builder._library.behaviours[spec.kind], spec, name)
        elif spec.kind == SET:
            node = cast(
                Node, Assign(name, [(self._variable(key), self._bind(key, a)) for key, a in spec.arguments.items()])
            )
        else:
            node = self._control(spec, name, depth)
        return self._builder._place(position, node, id_, spec.kind, depth, spec.mark)

    def _call(self, called: TreeSpec, spec: NodeSpec, id_: str, name: str, depth: int) -> Node:
        given: dict[str, Binding] = {}
        for port_name, declared in (called.params | called.inputs).items():
            argument = spec.arguments.get(port_name)
            if argument is None:
                given[port_name] = Constant(declared.port.default_value)
            else:
                given[port_name] = self._argument(port_name, declared.port, argument)
        for port_name, argument in spec.save.items():
            given[port_name] = self._scope[str(argument.value)]
        return self._builder._tree(called, id_, spec.kind, name, spec.mark, given, depth)

    def _argument(self, name: str, port: Port, argument: Argument) -> Binding:
        """Return what an argument stands for, its value checked if it is constant."""
        source: Any = argument.value
        if isinstance(source, Reference):
            binding = self._scope[source.name]
            if isinstance(binding, Variable) or binding.value is UNSET:
                return binding
            return Constant(self._through(name, port, argument, binding.value))
        value, found = value_fault(port, name, argument.element, source)
        if found:
            self._builder._faults.add(*found)
        return Constant(value)

    def _through(self, name: str, port: Port, argument: Argument, value: Any) -> Any:
        """Return a value that came through a param, which only now can be checked."""
        try:
            return port.check(value)
        except (TypeError, ValueError) as error:
            self._builder._faults.add(argument.mark, "range", f"'{name}' {error}, from {argument.value}")
            return value

    def _leaf(self, class_: type[Behaviour], spec: NodeSpec, name: str) -> Node:
        behaviour = class_(name)
        wires = {}
        for port, argument in spec.arguments.items():
            binding = self._argument(port, class_.in_ports[port], argument)
            if isinstance(binding, Variable):
                wires[port] = binding.key
            elif binding.value is not UNSET:
                behaviour.constants[port] = binding.value
        wires.update({port: self._variable(str(argument.value)).key for port, argument in spec.save.items()})
        behaviour.wire(wires, self._scope.namespace)
        return cast(Node, behaviour)

    def _variable(self, name: str) -> Variable:
        return cast(Variable, self._scope[name])

    def _bind(self, name: str, argument: Argument) -> Binding:
        """Return what ``set`` writes: another name's value, or a constant of the declared type."""
        if isinstance(argument.value, Reference):
            return self._scope[argument.value.name]
        declared = self._tree.outputs.get(name) or self._builder._library.globals.get(name)
        return self._argument(name, declared.port, argument) if declared else Constant(argument.value)

    def _control(self, spec: NodeSpec, name: str, depth: int) -> Node:
        inputs = CONTROLS[spec.kind].inputs
        given: dict[str, Any] = {}
        for key, port in inputs.items():
            argument = spec.arguments.get(key)
            binding = self._argument(key, port, argument) if argument and spec.kind != "when" else None
            value = binding.value if isinstance(binding, Constant) else port.default_value
            given[key] = 1 if value is UNSET else value
        slots = {slot: [self.node(child, depth + 1) for child in nodes] for slot, nodes in spec.children.items()}
        items = spec.arguments.get("items")
        loop = self._argument("items", inputs["items"], items) if items else None
        return assemble(Parts(spec, name, given, slots, self._scope, loop))


def _key(title: str) -> str:
    """Return a tree's title as the blackboard allows it: a dot there leads into an object."""
    return title.replace(".", "_")

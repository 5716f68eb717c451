"""A loaded tree: the py_trees root, and what the outside sees of it."""

from __future__ import annotations

import inspect
import itertools
import weakref
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import py_trees
from py_trees.blackboard import Blackboard
from py_trees.common import Status

from zavis_bt.errors import did_you_mean
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.builder import Built
from zavis_bt.tree.failure import deciding_path
from zavis_bt.tree.faults import Faults
from zavis_bt.tree.scope import Scope, Variable
from zavis_bt.types import NodeState, NodeStatus

_numbers = itertools.count(1)


def new_namespace() -> str:
    """Return a blackboard namespace that no other tree of this process has."""
    return f"/zavis_bt_{next(_numbers)}"


class Tree:
    """A mission tree, ready for `setup` and ticks.

    Its variables live in a namespace of py_trees' blackboard that is its own, and are removed together with it.
    """

    def __init__(
        self, root: py_trees.behaviour.Behaviour, built: list[Built], scopes: Mapping[str, Scope], namespace: str
    ):
        """Take what the builder made.

        Args:
            root: py_trees' root.
            built: Every node, depth first.
            scopes: Names of every tree instance by its id; the globals under ``globals``.
            namespace: Blackboard namespace.
        """
        self.root = root
        self.namespace = namespace
        self.source: object = None
        """What it was made from; a tree made from an equal source does the same."""
        self._built = built
        self._scopes = scopes
        self._nodes = [entry.node for entry in built]
        self._leaves = [node for node in self._nodes if isinstance(node, Behaviour)]
        self._seen: list[tuple[Status, str]] = []
        self._version = 0
        self._states: tuple[NodeState, ...] = ()
        self._states_version = -1
        clients = [client for node in self._nodes for client in node.blackboards]
        weakref.finalize(self, _release, namespace, clients)

    def setup(self, resources: Mapping[str, object]) -> None:
        """Give every node the resources that its ``setup`` names.

        Raises:
            TreeError: Resources are missing; one line for each.
            Exception: Whatever a ``setup`` raises itself.
        """
        faults = Faults()
        calls: list[Callable[[], None]] = []
        for entry in self._built:
            wanted = _resources_of(entry.node)
            missing = [name for name, optional in wanted.items() if name not in resources and not optional]
            for name in missing:
                near = did_you_mean(name, resources) if resources else ""
                faults.add(entry.mark, "resource", f"'{entry.kind}' needs the resource '{name}'{near}")
            given = {name: resources[name] for name in wanted if name in resources}
            calls.append(_bound(entry.node, given))
        faults.raise_if_any()
        for call in calls:
            call()

    def tick(self) -> Status:
        """Tick the root once and return its status."""
        for _ in self.root.tick():
            pass
        return self.root.status

    def stop(self) -> None:
        """Stop whatever runs; does nothing when nothing does."""
        try:
            if self.root.status is Status.RUNNING:
                self.root.stop(Status.INVALID)
        finally:
            # A tick that was cut short leaves nodes begun which their parents do not know to be running.
            for leaf in self._leaves:
                if leaf.begun:
                    leaf.stop(Status.INVALID)

    @property
    def status(self) -> Status:
        """The root's status."""
        return self.root.status

    @property
    def reason(self) -> str:
        """Why the root has its status: what the deepest node that decided it says, or the nearest above it."""
        path = deciding_path(self.root)
        return next((node.feedback_message for node in reversed(path) if node.feedback_message), "")

    def failure(self) -> NodeState | None:
        """Return the node that decided the failure, with the reason; None if the tree has not failed."""
        return self.decider() if self.status is Status.FAILURE else None

    def decider(self) -> NodeState:
        """Return the deepest node that decided the root's status, with the reason."""
        deepest = deciding_path(self.root)[-1]
        state = next(state for state, node in zip(self.nodes(), self._nodes, strict=True) if node is deepest)
        return NodeState(state.id, state.name, state.kind, state.depth, state.status, self.reason)

    @property
    def version(self) -> int:
        """Grows when any node's status or reason has changed."""
        now = [(node.status, node.feedback_message) for node in self._nodes]
        if now != self._seen:
            self._seen = now
            self._version += 1
        return self._version

    def nodes(self) -> tuple[NodeState, ...]:
        """Return every node's state, depth first; the same object until something changes."""
        version = self.version
        if version != self._states_version:
            self._states_version = version
            self._states = tuple(self._fresh_states())
        return self._states

    def _fresh_states(self) -> Iterator[NodeState]:
        old = self._states or (None,) * len(self._built)
        for state, entry in zip(old, self._built, strict=True):
            node = entry.node
            status, reason = NodeStatus(node.status.value), node.feedback_message
            if state is None or state.status != status or state.reason != reason:
                state = NodeState(entry.id, node.name, entry.kind, entry.depth, status, reason)
            yield state

    @property
    def variables(self) -> Mapping[str, Any]:
        """What is written at present, as ``tree id.name``, globals by their name alone."""
        found = {}
        for id_, scope in self._scopes.items():
            for name, binding in scope.bindings.items():
                if not isinstance(binding, Variable) or binding.key not in Blackboard.storage:
                    continue
                if binding.key.startswith(f"{scope.namespace}/"):  # not another tree's
                    found[name if id_ == "globals" else f"{id_}.{name}"] = binding.read()
        return found

    def write(self, name: str, value: Any) -> None:
        """Write a global variable.

        Raises:
            KeyError: There is no such global.
            TypeError: The value has another type.
        """
        variable = self._scopes["globals"][name]
        assert isinstance(variable, Variable)
        variable.write(value)


def _resources_of(node: py_trees.behaviour.Behaviour) -> dict[str, bool]:
    """Return the names of the resources a node's ``setup`` takes, and whether they are optional."""
    parameters = inspect.signature(node.setup).parameters.values()
    named = [parameter for parameter in parameters if parameter.kind is parameter.KEYWORD_ONLY]
    return {parameter.name: parameter.default is not parameter.empty for parameter in named}


def _bound(node: py_trees.behaviour.Behaviour, given: Mapping[str, object]) -> Callable[[], None]:
    return lambda: node.setup(**given)


def _release(namespace: str, clients: list[py_trees.blackboard.Client]) -> None:
    """Remove a tree's traces from py_trees' blackboard, which is one for the whole process."""
    for client in clients:
        if client.id() in Blackboard.clients:
            client.unregister(clear=True)
    for key in [key for key in Blackboard.storage if key.startswith(f"{namespace}/")]:
        del Blackboard.storage[key]

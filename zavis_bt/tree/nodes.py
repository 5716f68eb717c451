"""From YAML to nodes: which key is the kind, what stands beside it, and in which order modifiers nest."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from zavis_bt.errors import did_you_mean
from zavis_bt.tree.controls import CONTROLS, DECORATIONS, LEAF_SHORTHAND, MODIFIERS, SET, Control, Slot
from zavis_bt.tree.document import Element, Items, Scalar, Table
from zavis_bt.tree.faults import Faults, Mark
from zavis_bt.tree.spec import Argument, NodeSpec, Reference

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
"""Names of variables, params and ports."""


def label(node: NodeSpec) -> str:
    """Return how people call a node: its name or kind, whatever modifiers stand around it."""
    while not node.name and node.kind in MODIFIERS and node.children.get("do"):
        node = node.children["do"][0]
    return node.name or node.kind


class NodeParser:
    """Reads the nodes of one file."""

    def __init__(self, kinds: Collection[str], faults: Faults) -> None:
        """Read nodes whose kinds are among ``kinds``; what is wrong goes to ``faults``."""
        self._kinds = kinds
        self._faults = faults

    def node(self, element: Element, base: str) -> NodeSpec | None:
        """Return the node that an element describes, or None if it describes none.

        Args:
            element: A bare word or a mapping.
            base: Path of the place in the file; the node's id is this and its kind.
        """
        if isinstance(element, Scalar) and isinstance(element.value, str):
            return self._bare_word(element.value, element.mark, base)
        if not isinstance(element, Table) or not element.entries:
            self._faults.add(element.mark, "structure", "a node is a kind, such as 'scan' or 'scan: {turns: 1}'")
            return None
        kind = self._kind(element)
        return self._decorated(kind, element, base) if kind else None

    def _bare_word(self, kind: str, mark: Mark, base: str) -> NodeSpec | None:
        if kind not in self._kinds:
            self._unknown(kind, mark)
        return self._body(kind, None, mark, f"{base}/{kind}", {})

    def _unknown(self, kind: str, mark: Mark) -> None:
        near = did_you_mean(kind, [*self._kinds, *MODIFIERS])
        self._faults.add(mark, "kind", f"unknown kind '{kind}'{near}")

    def _kind(self, table: Table) -> str | None:
        """Return the key that is the node's kind."""
        beside = (*MODIFIERS, *DECORATIONS)
        candidates = [key for key in table if key not in beside]
        known = [key for key in candidates if key in self._kinds]
        if len(known) > 1:
            names = " and ".join(f"'{key}'" for key in known)
            self._faults.add(
                table.keys[known[1]], "kind", f"two kinds in one node: {names} (each is an item of a list)"
            )
            return None
        for key in candidates:
            if known and key not in known:
                near = did_you_mean(key, beside)
                self._faults.add(table.keys[key], "modifier", f"unknown modifier '{key}' beside '{known[0]}'{near}")
            elif not known:
                self._unknown(key, table.keys[key])
        # A misspelt kind stays a node, so that what it saves is not reported as unknown as well.
        return (known or candidates)[0] if candidates else self._long_form(table)

    def _long_form(self, table: Table) -> str | None:
        """Return the modifier that is the kind here, since it has a block of its own or only compares."""
        blocks = [key for key in MODIFIERS if isinstance(value := table.get(key), Table) and "do" in value.entries]
        if not blocks:
            present = [key for key in MODIFIERS if key in table.entries]
            blocks = present[:1] if "do" in table.entries else [key for key in present if key == "when"]
        if len(blocks) == 1:
            return blocks[0]
        keys = ", ".join(f"'{key}'" for key in table)
        self._faults.add(table.mark, "kind", f"no kind beside {keys} (a node is a kind, such as 'scan: {{turns: 1}}')")
        return None

    def _decorated(self, kind: str, table: Table, base: str) -> NodeSpec | None:
        blocks: dict[str, Element] = {key: table.entries[key] for key in ("do", "recover") if key in table.entries}
        control = CONTROLS.get(kind)
        own = {key: blocks.pop(key) for key in tuple(blocks) if control and control.slot(key)}
        outer = [key for key in MODIFIERS if key in table.entries and key != kind]
        recover = blocks.pop("recover", None) if "retry" in outer else None
        for key in blocks if kind in self._kinds else ():
            needs = "'retry'" if key == "recover" else "a kind with a block, such as 'for_each'"
            self._faults.add(table.keys[key], "modifier", f"'{key}' belongs to {needs}, not to '{kind}'")
        node = self._body(kind, table.entries[kind], table.keys[kind], f"{base}/{kind}", own)
        if node is None:
            return None
        node = self._named(node, table)
        for modifier in outer:
            own = {"recover": recover} if modifier == "retry" and recover is not None else {}
            mark = table.keys[modifier]
            wrapped = self._body(modifier, table.entries[modifier], mark, f"{base}/{modifier}", own, node)
            node = wrapped or node
        return node

    def _named(self, node: NodeSpec, table: Table) -> NodeSpec:
        name = ""
        if (element := table.get("name")) is not None:
            if isinstance(element, Scalar) and isinstance(element.value, str) and element.value:
                name = element.value
            else:
                self._faults.add(element.mark, "modifier", "'name' is a text")
        save = self._save(table.get("save"), table)
        return NodeSpec(node.kind, node.id, node.mark, name, node.arguments, node.children, save)

    def _save(self, element: Element | None, table: Table) -> dict[str, Argument]:
        if element is None:
            return {}
        if not isinstance(element, Table):
            self._faults.add(element.mark, "modifier", "'save' maps output ports to variables, such as {path: path}")
            return {}
        saved = {}
        for port, target in element.entries.items():
            name = target.value if isinstance(target, Scalar) else None
            if isinstance(name, str) and NAME.fullmatch(name):
                saved[port] = Argument(name, target, element.keys[port])
            else:
                self._faults.add(target.mark, "modifier", f"'{port}' is saved to the name of a variable, without $")
        return saved

    def _body(
        self,
        kind: str,
        element: Element | None,
        mark: Mark,
        path: str,
        beside: dict[str, Element],
        inner: NodeSpec | None = None,
    ) -> NodeSpec | None:
        """Return the node of a kind from what stands after the kind's name and beside it."""
        if isinstance(element, Scalar) and element.value is None:
            element = None
        control = CONTROLS.get(kind)
        if control is None:
            return NodeSpec(kind, path, mark, arguments=self._leaf_arguments(kind, element))
        given = self._control_parts(control, element)
        if given is None:
            return None
        keys, elements = given
        elements.update(beside)
        children: dict[str, tuple[NodeSpec, ...]] = {"do": (inner,)} if inner is not None else {}
        for slot in control.slots:
            if slot.name in elements and slot.name not in children:
                children[slot.name] = self._children(slot, elements[slot.name], path, slot.name in beside)
            elif slot.required and slot.name not in children:
                self._faults.add(mark, "structure", f"'{kind}' needs '{slot.name}'")
        arguments = {key: self._argument(elements[key], keys[key]) for key in keys if not control.slot(key)}
        return NodeSpec(kind, path, mark, arguments=arguments, children=children)

    def _control_parts(
        self, control: Control, element: Element | None
    ) -> tuple[dict[str, Mark], dict[str, Element]] | None:
        """Return places and elements of a control's arguments and slots."""
        if element is None:
            return {}, {}
        names = {*control.inputs, *(slot.name for slot in control.slots)}
        slot = control.slot(control.shorthand)
        if isinstance(element, Table) and (slot is None or set(element.entries) <= names):
            return dict(element.keys), dict(element.entries)
        if control.shorthand and (isinstance(element, Items) == bool(slot and slot.many)):
            return {control.shorthand: element.mark}, {control.shorthand: element}
        form = "a list of nodes" if slot and slot.many else f"a mapping with {', '.join(sorted(names))}"
        self._faults.add(element.mark, "structure", f"'{control.kind}' takes {form}")
        return None

    def _children(self, slot: Slot, element: Element, path: str, beside: bool) -> tuple[NodeSpec, ...]:
        if slot.name == "recover" and beside:
            path = path.rpartition("/")[0] + "/recover"
            found = [self.node(element, path)]
        elif not slot.many:
            found = [self.node(element, f"{path}.{slot.name}")]
        elif isinstance(element, Items):
            stem = path if slot.name == "do" else f"{path}.{slot.name}"
            found = [self.node(item, f"{stem}.{index}") for index, item in enumerate(element.items)]
        else:
            found = [self.node(element, f"{path}.{slot.name}")]
        if not found:
            self._faults.add(element.mark, "structure", f"'{slot.name}' has no nodes")
        return tuple(node for node in found if node is not None)

    def _leaf_arguments(self, kind: str, element: Element | None) -> dict[str, Argument]:
        if element is None:
            return {}
        if isinstance(element, Table):
            return {key: self._argument(value, element.keys[key]) for key, value in element.entries.items()}
        if kind not in self._kinds:
            return {}
        shorthand = LEAF_SHORTHAND.get(kind)
        if shorthand and isinstance(element, Scalar):
            return {shorthand: self._argument(element, element.mark)}
        example = "{round: 0}" if kind == SET else "{target: $target}"
        self._faults.add(element.mark, "structure", f"arguments of '{kind}' are a mapping, such as {example}")
        return {}

    def _argument(self, element: Element, key: Mark) -> Argument:
        return Argument(self._value(element), element, key)

    def _value(self, element: Element) -> Any:
        value = element.plain
        if not isinstance(value, str) or not value.startswith("$"):
            return value
        if value.startswith("$$"):
            return value[1:]
        if NAME.fullmatch(value[1:]):
            return Reference(value[1:])
        # A comparison begins with $ as well; whoever takes the text says what is wrong with it.
        return value

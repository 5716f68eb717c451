"""The second and third stage of checks: arguments against ports, names against what exists."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.arguments import value_fault
from zavis_bt.tree.condition import parse_condition
from zavis_bt.tree.controls import SET
from zavis_bt.tree.document import Element, Items, Scalar, Table
from zavis_bt.tree.faults import Faults
from zavis_bt.tree.includes import Library
from zavis_bt.tree.nodes import NAME, label
from zavis_bt.tree.spec import Argument, FileSpec, NodeSpec, Reference, Signature, TreeSpec

WRITTEN_OUT = (("for_each", "as"), ("for_each", "until"), ("parallel", "until"))
"""Arguments that shape the tree and the analysis of its data."""


def check_file_root(file: FileSpec, faults: Faults) -> None:
    """Check that the main file names one of its trees as the root."""
    names = file.trees
    if not file.root:
        example = f" (such as root: {next(iter(names))})" if names else ""
        faults.add(file.mark, "root", f"'root' is missing, the tree to run{example}")
    elif file.root not in names:
        faults.add(
            file.root_mark or file.mark, "root", f"there is no tree '{file.root}'{did_you_mean(file.root, names)}"
        )


def check_recursion(library: Library) -> None:
    """Check that no tree contains itself."""
    done: set[int] = set()
    for tree in library.trees:
        _descend(tree, (), done, library.faults)


def _descend(tree: TreeSpec, chain: tuple[TreeSpec, ...], done: set[int], faults: Faults) -> None:
    if id(tree) in done or tree.do is None:
        return
    for node in tree.do.walk():
        called = tree.file.scope.get(node.kind)
        if called is None:
            continue
        around = (*chain, tree)
        if any(called is outer for outer in around):
            start = next(index for index, outer in enumerate(around) if outer is called)
            way = " → ".join(part.title for part in (*around[start:], called))
            faults.add(
                node.mark, "recursion", f"tree '{called.title}' contains itself: {way} (repeat with retry or repeat)"
            )
        else:
            _descend(called, around, done, faults)
    done.add(id(tree))


def check_arguments(tree: TreeSpec, library: Library) -> None:
    """Check the arguments and saved outputs of every node of a tree."""
    for node in tree.do.walk() if tree.do else ():
        signature = library.signature(node.kind, tree.file)
        if signature is not None:
            _check_node(node, signature, tree, library)


def _check_node(node: NodeSpec, signature: Signature, tree: TreeSpec, library: Library) -> None:
    faults = library.faults
    if node.kind == SET:
        _check_set(node, tree, library)
    else:
        for name, argument in node.arguments.items():
            _check_argument(name, argument, node, signature, tree, faults)
    if node.kind == "parallel" and "until" in node.arguments:
        _check_until(node.arguments["until"], node, faults)
    for name, port in signature.inputs.items():
        if port.required and name not in node.arguments:
            meaning = f": {port.description}" if port.description else ""
            faults.add(node.mark, "missing-argument", f"'{node.kind}' needs '{name}'{meaning}")
    for name, argument in node.save.items():
        if name not in signature.outputs:
            near = did_you_mean(name, signature.outputs) if signature.outputs else " (it has none)"
            near = " ('save' stands beside the node that has the output, here inside 'do')" if node.children else near
            faults.add(argument.key, "argument", f"'{node.kind}' has no output '{name}'{near}")


def _check_set(node: NodeSpec, tree: TreeSpec, library: Library) -> None:
    for name, argument in node.arguments.items():
        declared = tree.outputs.get(name) or library.globals.get(name)
        if not NAME.fullmatch(name):
            what = f"'{name}' is no name of a variable (letters, digits, underscores)"
            library.faults.add(argument.key, "name", what)
        elif declared is not None and not isinstance(argument.value, Reference):
            _, found = value_fault(declared.port, name, argument.element, argument.value)
            if found:
                library.faults.add(*found)


def _check_until(argument: Argument, node: NodeSpec, faults: Faults) -> None:
    """Check that a parallel ends with children it has."""
    names = [label(child) for child in node.children.get("do", ())]
    wanted = argument.element.items if isinstance(argument.element, Items) else (argument.element,)
    accepted = names if isinstance(argument.element, Items) else [*names, "all", "any"]
    for item in wanted:
        if isinstance(item.plain, str) and item.plain not in accepted:
            near = did_you_mean(item.plain, accepted)
            faults.add(item.mark, "name", f"no child of this parallel is called '{item.plain}'{near}")
    if not wanted:
        faults.add(argument.mark, "range", f"'until' is empty (all, any or names: {', '.join(names)})")


def _check_argument(
    name: str, argument: Argument, node: NodeSpec, signature: Signature, tree: TreeSpec, faults: Faults
) -> None:
    port = signature.inputs.get(name)
    if port is None:
        near = did_you_mean(name, signature.inputs) if signature.inputs else " (it takes none)"
        faults.add(argument.key, "argument", f"'{node.kind}' has no argument '{name}'{near}")
    elif node.kind == "when":
        _check_condition(argument, faults)
    elif (node.kind, name) in WRITTEN_OUT and isinstance(argument.value, Reference):
        faults.add(
            argument.mark, "reference", f"'{name}' of '{node.kind}' is written out, not taken from {argument.value}"
        )
    elif (node.kind, name) == ("for_each", "as") and not NAME.fullmatch(str(argument.value)):
        faults.add(argument.mark, "name", f"{argument.value!r} is no name of a variable (letters, digits, underscores)")
    elif isinstance(argument.value, Reference):
        _check_constant(name, argument, node, signature, tree, faults)
    elif _looks_like_reference(argument):
        faults.add(
            argument.mark, "reference", f"'{argument.element.plain}' is no variable (write $$ for a dollar sign)"
        )
    elif (inner := _reference_inside(argument.element)) is not None:
        faults.add(inner.mark, "reference", f"'{inner.value}' stands inside a value (only a whole argument can)")
    else:
        _, found = value_fault(port, name, argument.element, argument.value)
        if found:
            faults.add(*found)


def _reference_inside(element: Element) -> Scalar | None:
    """Return the first text in a list or mapping that looks like a variable."""
    parts: Iterable[Element] = ()
    if isinstance(element, Items):
        parts = element.items
    elif isinstance(element, Table):
        parts = element.entries.values()
    for part in parts:
        if isinstance(part, Scalar) and str(part.value).startswith("$"):
            return part
        if (inner := _reference_inside(part)) is not None:
            return inner
    return None


def _looks_like_reference(argument: Argument) -> bool:
    written = argument.element.plain
    return isinstance(written, str) and written.startswith("$") and not written.startswith("$$")


def _check_constant(
    name: str, argument: Argument, node: NodeSpec, signature: Signature, tree: TreeSpec, faults: Faults
) -> None:
    """Check that what must be known at load does not come from a variable."""
    source = argument.value.name
    if (
        name in signature.constants
        and source not in tree.params
        and (source in tree.inputs or not _unknown(source, tree))
    ):
        faults.add(
            argument.mark,
            "reference",
            f"'{name}' of '{node.kind}' must be known when the tree is loaded, but ${source} changes at run time "
            f"(declare '{name}' under 'in', or '{source}' under 'params')",
        )


def _unknown(name: str, tree: TreeSpec) -> bool:
    return name not in {variable for node in (tree.do.walk() if tree.do else ()) for variable in written_by(node)}


def written_by(node: NodeSpec) -> Iterator[str]:
    """Yield the variables a node writes or declares."""
    yield from (str(argument.value) for argument in node.save.values())
    if node.kind == SET:
        yield from node.arguments
    if node.kind == "for_each" and "as" in node.arguments:
        yield str(node.arguments["as"].value)


def _check_condition(argument: Argument, faults: Faults) -> None:
    text = str(argument.value)
    try:
        if not isinstance(argument.value, str | Reference):
            raise InputError(f"{argument.element.plain!r} is no comparison (such as $battery > 0.3)")
        parse_condition(text)
    except InputError as error:
        faults.add(argument.mark, "condition", str(error))

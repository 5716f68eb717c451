"""The one form of a tree file: same content, same comments, canonical indentation and order of modifiers."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError

from zavis_bt.errors import InputError
from zavis_bt.tree.controls import CONTROLS, MODIFIERS
from zavis_bt.tree.document import parse_document

WIDTH = 200
PASSES = 4
"""How often a text may have to go through ruamel until it stays as it is (comments move to their columns)."""

_UNWRITABLE = (ValueError, TypeError, AttributeError, AssertionError, NotImplementedError)
"""What ruamel raises for what it reads but cannot write."""

_RANK = {
    key: rank for rank, key in enumerate(("do", "name", "save", "timeout", "retry", "recover", "repeat", "when"), 1)
}


def format_text(text: str, name: str = "tree") -> str:
    """Return a tree file in its canonical form; applying it twice changes nothing.

    Args:
        text: Content of the file.
        name: How messages call it.

    Raises:
        TreeError: The text is no well-formed YAML.
        InputError: It cannot be written in this form without changing what it says.
    """
    before, faults = parse_document(text, name)
    faults.raise_if_any()
    for _ in range(PASSES):
        formatted = _round_trip(text, name)
        if formatted == text:
            break
        text = formatted
    after, _ = parse_document(text, name)
    if before is None or after is None or before.plain != after.plain:
        raise InputError(f"{name}: cannot be formatted without changing what it says")
    return text


def _round_trip(text: str, name: str) -> str:
    yaml = YAML(typ="rt", pure=True)
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.width = WIDTH
    yaml.preserve_quotes = True
    out = StringIO()
    try:
        document = yaml.load(text)
        for node in _nodes_of(document):
            _reorder(node)
        yaml.dump(document, out)
    except (YAMLError, *_UNWRITABLE) as error:
        raise InputError(f"{name}: cannot be formatted: {' '.join(str(error).split())}") from error
    return out.getvalue()


def _nodes_of(document: Any) -> Iterator[CommentedMap]:
    trees = document.get("trees") if isinstance(document, CommentedMap) else None
    for tree in trees.values() if isinstance(trees, CommentedMap) else ():
        if isinstance(tree, CommentedMap) and "do" in tree:
            yield from _nodes(tree["do"])


def _nodes(value: Any) -> Iterator[CommentedMap]:
    """Yield the nodes at and below a place where a node, or a list of nodes, stands."""
    if isinstance(value, CommentedSeq):
        for item in value:
            yield from _nodes(item)
    elif isinstance(value, CommentedMap):
        yield value
        for key, inner in value.items():
            if key in ("do", "recover"):
                yield from _nodes(inner)
            elif key in CONTROLS:
                yield from _inside(key, inner)


def _inside(kind: str, value: Any) -> Iterator[CommentedMap]:
    control = CONTROLS[kind]
    slots = {slot.name for slot in control.slots}
    if isinstance(value, CommentedMap) and (
        control.shorthand not in slots or set(value) <= slots | set(control.inputs)
    ):
        for slot in slots & set(value):
            yield from _nodes(value[slot])
    else:
        yield from _nodes(value)


def _reorder(node: CommentedMap) -> None:
    """Put a node's kind first and its modifiers in the order in which they nest, the innermost first."""
    kinds = [key for key in node if key not in _RANK] or [key for key in MODIFIERS if _holds_block(node.get(key))]
    wanted = sorted(node, key=lambda key: 0 if key in kinds else _RANK[key])
    if wanted == list(node) or _has_lines_of_comment(node):
        return
    for key in wanted:
        node.move_to_end(key)


def _holds_block(value: Any) -> bool:
    return isinstance(value, CommentedMap) and "do" in value


def _has_lines_of_comment(value: Any) -> bool:
    """Return whether a comment or blank line of its own would lose its place if keys moved."""
    if not isinstance(value, CommentedMap | CommentedSeq):
        return False
    parts = value.values() if isinstance(value, CommentedMap) else value
    if any("\n" in token.value.rstrip("\n") or token.value.count("\n") > 1 for token in _tokens(value.ca)):
        return True
    return any(_has_lines_of_comment(part) for part in parts)


def _tokens(comments: Any) -> Iterator[Any]:
    groups = [comments.comment or [], *comments.items.values(), comments.end or []]
    for group in groups:
        for entry in group:
            for token in entry if isinstance(entry, list) else [entry]:
                if token is not None:
                    yield token

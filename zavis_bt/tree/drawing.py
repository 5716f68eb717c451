"""Trees as text, Graphviz and HTML."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence

import py_trees

from zavis_bt.tree.tree import Tree
from zavis_bt.types import NodeState

_PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>{title}</title>
<style>body {{ font: 14px/1.5 monospace; margin: 2em }}</style></head>
<body><h1>{title}</h1>
{body}
</body></html>
"""


def text_lines(nodes: Sequence[NodeState]) -> Iterator[tuple[str, NodeState]]:
    """Yield a line with branches and name for each node, depth first, together with the node."""
    open_: list[bool] = []  # for each depth: whether a sibling follows
    for index, node in enumerate(nodes):
        del open_[node.depth :]
        open_.append(_sibling_follows(nodes, index))
        stems = "".join("│  " if follows else "   " for follows in open_[1:-1])
        branch = ("├─ " if open_[-1] else "└─ ") if node.depth else ""
        kind = f" ({node.kind})" if node.name != node.kind else ""
        yield f"{stems}{branch}{node.name}{kind}", node


def _sibling_follows(nodes: Sequence[NodeState], index: int) -> bool:
    for node in nodes[index + 1 :]:
        if node.depth <= nodes[index].depth:
            return node.depth == nodes[index].depth
    return False


def text_tree(nodes: Sequence[NodeState]) -> str:
    """Return the tree as text, each line ending with the node's id."""
    lines = list(text_lines(nodes))
    width = max((len(line) for line, _ in lines), default=0)
    return "\n".join(f"{line.ljust(width)}  {node.id}" for line, node in lines)


def dot_tree(tree: Tree) -> str:
    """Return the tree in Graphviz' language."""
    return str(py_trees.display.dot_tree(tree.root).to_string())


def html_tree(tree: Tree, title: str) -> str:
    """Return the tree as a page of its own."""
    body = py_trees.display.xhtml_tree(tree.root, show_status=True)
    return _PAGE.format(title=html.escape(title), body=body)

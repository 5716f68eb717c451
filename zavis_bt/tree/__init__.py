"""Mission trees: YAML documents, their checks, the py_trees objects made from them, and the loop that ticks them."""

from py_trees.common import Status

from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.inputs import TreeInput, parse_input
from zavis_bt.tree.loader import check_tree, load_tree, read_inputs
from zavis_bt.tree.ports import In, Out, Port
from zavis_bt.tree.registry import Registry
from zavis_bt.tree.runner import Outcome, Runner
from zavis_bt.tree.tree import Tree

__all__ = [
    "Behaviour",
    "In",
    "Out",
    "Outcome",
    "Port",
    "Registry",
    "Runner",
    "Status",
    "Tree",
    "TreeInput",
    "check_tree",
    "load_tree",
    "parse_input",
    "read_inputs",
]

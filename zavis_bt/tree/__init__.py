"""Mission trees: YAML documents, their checks, the py_trees objects made from them, and the loop that ticks them."""

from py_trees.common import Status

from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.ports import In, Out
from zavis_bt.tree.registry import Registry

__all__ = ["Behaviour", "In", "Out", "Registry", "Status"]

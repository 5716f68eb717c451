"""Where to stand, in which order, and how to get there."""

from zavis_bt.planning.costmap import Costmap, Costmaps
from zavis_bt.planning.dwa import DwaPlanner, DwaSettings
from zavis_bt.planning.errors import PlanningError
from zavis_bt.planning.follower import FollowStatus, PathFollower, Progress
from zavis_bt.planning.geodesic import GeodesicField
from zavis_bt.planning.navigator import Navigator
from zavis_bt.planning.order import ORDERS, cost, greedy_order, make_order, nearest_order
from zavis_bt.planning.planner import PLANNERS, GlobalPlanner, make_planner
from zavis_bt.planning.recovery import BackUpMove, TurnMove, choose_recovery
from zavis_bt.planning.viewpoints import generate_viewpoints

__all__ = [
    "ORDERS",
    "PLANNERS",
    "BackUpMove",
    "Costmap",
    "Costmaps",
    "DwaPlanner",
    "DwaSettings",
    "FollowStatus",
    "GeodesicField",
    "GlobalPlanner",
    "Navigator",
    "PathFollower",
    "PlanningError",
    "Progress",
    "TurnMove",
    "choose_recovery",
    "cost",
    "generate_viewpoints",
    "greedy_order",
    "make_order",
    "make_planner",
    "nearest_order",
]

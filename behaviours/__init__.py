"""Reusable behaviours, one a file. A tree file uses each by its name in snake case."""

from behaviours.back_up import BackUp
from behaviours.battery_above import BatteryAbove
from behaviours.confirm import Confirm
from behaviours.detect import Detect
from behaviours.estop_clear import EstopClear
from behaviours.forget_visits import ForgetVisits
from behaviours.found import Found
from behaviours.generate_waypoints import GenerateWaypoints
from behaviours.go_to_frontier import GoToFrontier
from behaviours.look import Look
from behaviours.navigate import Navigate
from behaviours.scan import Scan
from behaviours.within_distance import WithinDistance

__all__ = [
    "BackUp",
    "BatteryAbove",
    "Confirm",
    "Detect",
    "EstopClear",
    "ForgetVisits",
    "Found",
    "GenerateWaypoints",
    "GoToFrontier",
    "Look",
    "Navigate",
    "Scan",
    "WithinDistance",
]

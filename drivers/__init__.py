"""Drivers of real devices, and profiles of robots (``robots/*.robot.yaml``)."""

from drivers.profiles import builtin_robot, builtin_robots

__all__ = ["builtin_robot", "builtin_robots"]

"""Worlds that come with the package, and how to find and begin one."""

from sim.worlds.builtin import builtin_world, builtin_worlds, resolve_world
from sim.worlds.starter import write_starter

__all__ = ["builtin_world", "builtin_worlds", "resolve_world", "write_starter"]

"""Simulated worlds and robots: the same borders as the real devices, in lock step or in real time."""

from sim.world import Furniture, World, WorldObject

__all__ = ["Furniture", "World", "WorldObject"]

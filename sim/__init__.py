"""Simulated worlds and robots: the same borders as the real devices, in lock step or in real time."""

from typing import TYPE_CHECKING, Any

from sim.world import Furniture, World, WorldObject
from sim.world_file import inspect_world, load_world, read_objects

if TYPE_CHECKING:
    from sim.noise import NoiseSettings
    from sim.simulation import Simulation

__all__ = [
    "Furniture",
    "NoiseSettings",
    "Simulation",
    "World",
    "WorldObject",
    "inspect_world",
    "load_world",
    "read_objects",
]


def __getattr__(name: str) -> Any:
    # The simulation brings the compiler, which those who only read world files need not wait for.
    if name == "Simulation":
        from sim.simulation import Simulation

        return Simulation
    if name == "NoiseSettings":
        from sim.noise import NoiseSettings

        return NoiseSettings
    raise AttributeError(f"module 'sim' has no attribute '{name}'")

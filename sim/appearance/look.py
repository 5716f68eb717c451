"""How one thing looks: drawn once from a seed, the same ever after."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from sim.appearance.palette import MATERIALS, SLOTS, accent_of, basic_of, rgb_of, trim_of
from sim.appearance.shape import Shape
from zavis_bt.types import FloatArray

_JITTER = 0.09  # of the brightness of drawn colours
_WARP = 0.16  # of the exponents that change proportions


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """One draw of what a shape leaves open."""

    variant: int
    """Which of the shape's variants."""
    colours: FloatArray
    """(slots, 3) r, g, b from 0 to 255, in the order of `SLOTS`."""
    colour: str | None
    """Basic name of the body's colour."""
    finish: str
    """Pattern of the body."""
    warp: tuple[float, float]
    """Exponents that bend x and y, and z: 1 leaves the proportions as they are."""
    seed: int
    """Of its patterns."""

    @classmethod
    def drawn(cls, shape: Shape, rng: np.random.Generator, colour: str | None = None) -> Look:
        """Draw a look.

        Args:
            shape: What is left open.
            rng: Source of the draws.
            colour: Name of the body's colour; drawn from the shape's palette if None, or if no colour has the name.
        """
        variant = int(rng.integers(len(shape.variants)))
        names = {slot: _pick(shape.palette.get(slot, MATERIALS.get(slot, ())), rng) for slot in SLOTS}
        body = colour if colour is not None and rgb_of(colour) is not None else names["body"]
        names["body"] = body
        finish = _pick(shape.finishes, rng)
        colours = np.empty((len(SLOTS), 3))
        for number, slot in enumerate(SLOTS):
            rgb = rgb_of(names[slot]) if names[slot] else None
            colours[number] = np.array(rgb or (0, 0, 0)) * (1 + _JITTER * rng.uniform(-1, 0.6))
        if not shape.palette.get("trim"):
            colours[SLOTS.index("trim")] = trim_of(colours[0])
        if not shape.palette.get("accent"):
            colours[SLOTS.index("accent")] = accent_of(colours[0], rng)
        warp = 1 + _WARP * rng.uniform(-1, 1), 1 + _WARP * rng.uniform(-1, 1)
        return cls(variant, colours, basic_of(body), finish, warp, int(rng.integers(1 << 20)))


def stream_of(world: str, thing: str, appearance: int | None) -> np.random.Generator:
    """Return the source of a thing's look: of its number if it has one, else of its own and the world's name."""
    text = f"{world}/{thing}" if appearance is None else f"#{appearance}"
    digest = hashlib.blake2b(text.encode(), digest_size=8).digest()
    return np.random.default_rng(int.from_bytes(digest, "little"))


def _pick(names: tuple[str, ...], rng: np.random.Generator) -> str:
    return names[int(rng.integers(len(names)))] if names else ""

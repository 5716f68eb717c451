"""How one thing looks: drawn once from a seed, the same ever after."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sim.appearance.catalogue import shape_of
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
    """Basic name of the body's colour; None if no part shows it."""
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
        chances = iter(rng.random(len(SLOTS) * 2 + 8).tolist())
        variant = int(next(chances) * len(shape.variants))
        finish = shape.finishes[int(next(chances) * len(shape.finishes))]
        names = {slot: options[int(next(chances) * len(options))] for slot, options in _options(shape)}
        if colour is not None and rgb_of(colour) is not None:
            names["body"] = colour
        colours = np.array([(names[slot] and rgb_of(names[slot])) or (0, 0, 0) for slot in SLOTS], dtype=np.float64)
        colours *= np.array([[1 + _JITTER * (1.6 * next(chances) - 1)] for _ in SLOTS])
        if not names["trim"]:
            colours[SLOTS.index("trim")] = trim_of(colours[0])
        if not names["accent"]:
            colours[SLOTS.index("accent")] = accent_of(colours[0], next(chances))
        warp = 1 + _WARP * (2 * next(chances) - 1), 1 + _WARP * (2 * next(chances) - 1)
        shown = any(part.paint == "body" for part in shape.variants[variant])
        basic = basic_of(names["body"]) if shown else None
        return cls(variant, colours, basic, finish, warp, int(next(chances) * (1 << 20)))


@lru_cache(maxsize=4096)
def look_of(category: str, colour: str | None, world: str, thing: str, appearance: int | None) -> Look:
    """Return how a thing of a world looks.

    Args:
        category: What it is.
        colour: Of its body, None to draw it.
        world: Name of the world.
        thing: Its id.
        appearance: Seed of the look; None makes it follow from id and world.
    """
    text = f"{world}/{thing}" if appearance is None else f"{category}#{appearance}"
    digest = hashlib.blake2b(text.encode(), digest_size=8).digest()
    return Look.drawn(shape_of(category), np.random.default_rng(int.from_bytes(digest, "little")), colour)


def _options(shape: Shape) -> list[tuple[str, tuple[str, ...]]]:
    """Return the colours each slot is drawn from; an empty name stands for one that follows from the body's."""
    return [(slot, shape.palette.get(slot) or MATERIALS.get(slot) or ("",)) for slot in SLOTS]

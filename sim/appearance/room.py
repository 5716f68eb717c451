"""How a room looks: patterns of walls and floor, and its lamp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.render_shade import AMBIENT, DIFFUSE, FLOOR_LOOK, LAMP, ROOM, SKIRTING, SKY, TINT, WALL_LOOK
from sim.render_texture import TEXTURES
from zavis_bt.types import FloatArray

Colour = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Covering:
    """What a wall or a floor is covered with."""

    first: Colour
    """r, g, b from 0 to 255."""
    second: Colour
    pattern: str = "plain"
    """One of `sim.render_texture.TEXTURES`."""
    repeat: tuple[float, float] = (1.0, 1.0)
    """Per metre, along x and y of the floor, or along and up a wall."""
    seed: int = 0

    def columns(self) -> list[float]:
        """Return it as the renderer has it."""
        return [*self.first, *self.second, TEXTURES.index(self.pattern), *self.repeat, self.seed]


@dataclass(frozen=True, slots=True)
class RoomLook:
    """Walls, floor and light; by default a bright room with a tiled floor."""

    wall: Covering = Covering((214, 208, 196), (196, 188, 174))
    floor: Covering = Covering((172, 146, 116), (164, 138, 109), "checks", (2.5, 2.5))
    skirting: Colour = (176, 168, 156)
    skirting_height: float = 0.0
    """[m]"""
    lamp: Colour = (-0.45, -0.28, 0.85)
    """Direction towards the lamp, map frame, of any length."""
    ambient: float = 0.55
    """Light that is everywhere."""
    diffuse: float = 0.5
    """Light that the lamp adds to what faces it."""
    tint: Colour = (1.0, 1.0, 1.0)
    """Colour of the light."""

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> RoomLook:
        """Draw a room: paint, wallpaper or bricks, boards, tiles or carpet, and light from dim to bright."""
        angle, slope = rng.uniform(-np.pi, np.pi), rng.uniform(0.35, 1.3)
        lamp = np.cos(angle) * np.cos(slope), np.sin(angle) * np.cos(slope), np.sin(slope)
        warm, strength = rng.uniform(-0.07, 0.07), rng.uniform(0.6, 1.15)
        ambient = rng.uniform(0.4, 0.65)
        return cls(
            _wall(rng),
            _floor(rng),
            skirting=_grey(rng, 60, 245),
            skirting_height=float(rng.choice([0.0, 0.06, 0.1])),
            lamp=(float(lamp[0]), float(lamp[1]), float(lamp[2])),
            ambient=strength * ambient,
            diffuse=strength * (1.08 - ambient),
            tint=(1 + max(warm, 0.0), 1.0, 1 - warm),
        )

    def columns(self) -> FloatArray:
        """Return it as the renderer has it: (1, ROOM), see `sim.render_shade`."""
        columns = np.zeros((1, ROOM))
        columns[0, LAMP : LAMP + 3] = np.array(self.lamp) / np.linalg.norm(self.lamp)
        columns[0, AMBIENT], columns[0, DIFFUSE] = self.ambient, self.diffuse
        columns[0, TINT : TINT + 3] = self.tint
        columns[0, WALL_LOOK : WALL_LOOK + 10] = self.wall.columns()
        columns[0, FLOOR_LOOK : FLOOR_LOOK + 10] = self.floor.columns()
        columns[0, SKIRTING : SKIRTING + 4] = [*self.skirting, self.skirting_height]
        columns[0, SKY : SKY + 3] = 226, 232, 238
        columns.setflags(write=False)
        return columns


def _wall(rng: np.random.Generator) -> Covering:
    first = _pale(rng)
    second = _darker(first, rng.uniform(0.82, 0.95))
    kind = str(rng.choice(["plain", "plain", "plain", "stripes", "dots", "bands", "bricks", "marble", "checks"]))
    repeat = {
        "stripes": (rng.uniform(2, 9), 1.0),
        "bands": (1.0, 0.45),
        "bricks": (rng.uniform(3, 5), rng.uniform(9, 13)),
        "dots": (rng.uniform(3, 8),) * 2,
        "checks": (rng.uniform(3, 8),) * 2,
    }.get(kind, (0.7, 0.7))
    if kind == "bricks" and rng.random() < 0.5:
        first, second = (158.0, 84.0, 66.0), (206.0, 196.0, 184.0)
    return Covering(first, second, kind, (float(repeat[0]), float(repeat[1])), int(rng.integers(1 << 16)))


def _floor(rng: np.random.Generator) -> Covering:
    kind = str(rng.choice(["planks", "planks", "checks", "grid", "leather", "speckle", "marble", "plain"]))
    if kind == "planks":
        wood = np.array([(186, 146, 100), (150, 108, 70), (118, 80, 54), (206, 176, 134)][rng.integers(4)])
        first: Colour = _as_colour(wood * rng.uniform(0.85, 1.1))
        along, across = rng.uniform(0.6, 1.2), rng.uniform(6, 12)
        return Covering(first, _darker(first, 0.6), kind, (along, across), int(rng.integers(1 << 16)))
    first = _pale(rng, 0.3, 0.88)
    second = _darker(first, rng.uniform(0.6, 0.95) if kind == "checks" else rng.uniform(0.75, 0.92))
    side = rng.uniform(1.5, 5) if kind in ("checks", "grid") else rng.uniform(8, 30) if kind != "marble" else 1.0
    return Covering(first, second, kind, (float(side), float(side)), int(rng.integers(1 << 16)))


def _pale(rng: np.random.Generator, low: float = 0.62, high: float = 0.96) -> Colour:
    """Return a colour of little saturation."""
    value = 255 * rng.uniform(low, high)
    return _as_colour(value * (1 - rng.uniform(0, 0.22) * rng.random(3)))


def _grey(rng: np.random.Generator, low: float, high: float) -> Colour:
    return _as_colour(np.full(3, rng.uniform(low, high)) * (1 - 0.08 * rng.random(3)))


def _darker(colour: Colour, share: float) -> Colour:
    return _as_colour(np.array(colour) * share)


def _as_colour(values: FloatArray) -> Colour:
    red, green, blue = np.clip(values, 0, 255).tolist()
    return red, green, blue

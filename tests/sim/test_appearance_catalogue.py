from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import pytest

from sim.appearance import SHAPES, SYNONYMS, shape_of
from sim.appearance.contact_sheet import contact_sheet, portrait
from sim.appearance.palette import SLOTS, rgb_of
from sim.render_paint import COLOURS
from sim.render_texture import TEXTURES
from sim.scene import Scene
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FREE, GridMap

IN_WORLDS = """
    sofa, armchair, bed, desk, coffee table, side table, dining table, dresser, shelf, chair, floor lamp, garbage
    can, tv stand, safe, ottoman, cabinet, drawer, countertop, obstacle, fridge, stool, credit card, key chain,
    laptop, pillow, cell phone, book, pencil, pen, cd, remote control, alarm clock, statue, box, vase, bowl, mug,
    newspaper, watch, tissue box, basket ball, teddy bear, watering can, baseball bat, tennis racket, plate, cloth,
    boots, candle, wallet, soap bar, towel, toilet paper, wine bottle
"""
GRID = GridMap(np.full((40, 40), FREE, dtype=np.int8), 0.25, (-5.0, -5.0))


def alone(category: str, number: int = 0, colour: str | None = None, size: tuple | None = None) -> Scene:
    thing = WorldObject("a", category, 0.0, 0.0, 0.0, size or shape_of(category).size, None, colour, number)
    return Scene.of(World("alone", GRID, 2.5, (), (thing,)))


def extents(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of the parts, along the axes of the map."""
    frames = scene.parts.frames
    reach = np.abs(frames[:, 3:].reshape(-1, 3, 3)).sum(axis=1)
    return (frames[:, :3] - reach).min(axis=0), (frames[:, :3] + reach).max(axis=0)


@cache
def picture(category: str, number: int, pixels: int = 24) -> np.ndarray:
    return portrait(category, pixels, number).astype(float)


@cache
def mask(category: str, number: int) -> np.ndarray:
    image = picture(category, number, 32)
    return np.abs(image - image[0, 0]).max(axis=2) > 12


@pytest.mark.parametrize("category", [" ".join(name.split()) for name in IN_WORLDS.split(",")])
def test_what_worlds_hold_has_a_shape(category):
    assert category in SHAPES or category in SYNONYMS


def test_synonyms_lead_to_shapes():
    assert not set(SYNONYMS) & set(SHAPES)
    assert set(SYNONYMS.values()) <= set(SHAPES)
    assert shape_of("Couch") is shape_of("sofa")
    assert shape_of("kitchen_chair") is shape_of("chair")
    assert len(SHAPES) >= 60


@pytest.mark.parametrize("category", sorted(SHAPES))
def test_tables_name_only_what_there_is(category):
    shape = SHAPES[category]
    for part in itertools.chain(*shape.variants):
        assert part.paint in SLOTS
        assert all(low < high for low, high in (part.x, part.y, part.z))
        assert max(part.taper) <= 1.0
        if part.pattern is not None:
            assert part.pattern.name in TEXTURES
            assert part.pattern.ink in SLOTS
    assert set(shape.palette) <= set(SLOTS)
    assert all(rgb_of(name) for names in shape.palette.values() for name in names)
    assert set(shape.finishes) <= set(TEXTURES)


@pytest.mark.parametrize("category", sorted(SHAPES))
def test_a_shape_fills_its_box_and_no_more(category):
    length, width, height = SHAPES[category].size
    half = np.array([max(length, width)] * 2) / 2
    for number in range(4):
        low, high = extents(alone(category, number))
        top = height + SHAPES[category].rise
        assert (low[:2] > -half * 1.06).all()
        assert (high[:2] < half * 1.06).all()
        assert low[2] > -0.25 * height - 1e-9  # balls may be sunk into the ground
        assert high[2] < top * 1.03
        filled = np.sort((high - low)[:2])
        assert (filled > 0.9 * np.sort([length, width])).all(), number
        assert high[2] > 0.9 * top


@pytest.mark.parametrize("category", ["sofa", "bed", "desk", "chair"])
def test_things_stand_on_the_height_that_furniture_says(category):
    piece = Furniture("a", category, 0.0, 0.0, 0.0, *SHAPES[category].size, None, 1)
    low, high = extents(Scene.of(World("alone", GRID, 2.5, (piece,))))
    assert low[2] == pytest.approx(0.0, abs=1e-6)
    assert high[2] == pytest.approx(piece.height + SHAPES[category].rise, rel=0.03)


def test_lying_things_may_stand_and_standing_ones_may_lie():
    flat, upright = alone("book", size=(0.2, 0.15, 0.03)), alone("book", size=(0.2, 0.03, 0.15))
    assert (extents(flat)[1] * 2)[:2] == pytest.approx([0.2, 0.15], rel=0.05)
    assert (extents(upright)[1] * 2)[1] == pytest.approx(0.03, rel=0.05)
    low, high = extents(alone("baseball bat", size=(0.9, 0.07, 0.07)))
    assert high[0] - low[0] == pytest.approx(0.9, rel=0.02)


def test_something_never_heard_of_has_a_shape_of_its_own():
    assert shape_of("quux") == shape_of("quux")
    assert shape_of("quux").variants != shape_of("frobnicator").variants
    assert picture("quux", 0).std() > 5


def test_silhouettes_of_different_things_differ():
    names = [
        "mug",
        "chair",
        "floor lamp",
        "teddy bear",
        "laptop",
        "scissors",
        "plant",
        "bottle",
        "tennis racket",
        "sofa",
    ]
    for one, other in itertools.combinations(names, 2):
        a, b = mask(one, 0), mask(other, 0)
        assert (a & b).sum() / (a | b).sum() < 0.8, (one, other)


def test_a_nearest_neighbour_tells_categories_apart_at_24_pixels():
    # The catalogue's looks vary in colour, so shades of grey of the mean-free picture are compared.
    names = sorted(SHAPES)[::2]

    def features(number: int) -> np.ndarray:
        grey = np.array([np.abs(picture(name, number) - picture(name, number)[0, 0]).max(axis=2) for name in names])
        flat = np.sqrt(grey).reshape(len(names), -1)
        return flat / np.linalg.norm(flat, axis=1, keepdims=True)

    known = np.stack([features(number) for number in (0, 3, 6, 9, 12)])
    likeness = (known @ features(15).T).max(axis=0)  # [known, asked], the same bearing as all of these
    right = (likeness.argmax(axis=0) == np.arange(len(names))).mean()
    assert right > 0.6, right
    assert right > 20 / len(names)


@pytest.mark.parametrize("colour", ["red", "green", "blue", "yellow", "purple", "orange"])
def test_a_named_colour_is_the_hue_one_sees(colour):
    import colorsys

    expected = colorsys.rgb_to_hsv(*(value / 255 for value in COLOURS[colour]))[0]
    for category in ("mug", "wallet", "sofa", "chair", "book", "pillow", "vase", "boots", "remote control", "backpack"):
        for number in range(3):
            image = portrait(category, 32, number, colour).astype(float)
            shown = image[np.abs(image - image[0, 0]).max(axis=2) > 40]
            hue, saturation, _ = colorsys.rgb_to_hsv(*(shown.mean(axis=0) / 255))
            away = abs((hue - expected + 0.5) % 1.0 - 0.5)
            assert away < 0.06, (category, number)
            assert saturation > 0.15, (category, number)


def test_a_contact_sheet_has_a_cell_for_each_category():
    sheet = contact_sheet(["mug", "desk", "book"], pixels=24, looks=2, columns=2)
    assert sheet.shape == (2 * (24 + 16 + 4), 2 * (2 * 24 + 8), 3)

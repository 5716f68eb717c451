"""Shapes of tables, cupboards and what else stands on the floor."""

from __future__ import annotations

from sim.appearance.shape import FRONT, MANTLE, Part, Pattern, Shape, ball, box, legs, mirrored, rod, shape, tube

_WOODEN = {"body": ("oak", "pine", "walnut", "mahogany", "white", "black", "tan", "cream", "grey")}
_WOOD = ("plain", "wood", "wood")
_HANDLE = "metal"


def _drawers(columns: int, rows: int) -> Pattern:
    return Pattern("drawers", "dark", (columns, rows), FRONT)


def _handles(columns: int, rows: int, low: float, high: float) -> tuple[Part, ...]:
    """Return handles on a front of drawers."""
    parts = []
    for column in range(columns):
        for row in range(rows):
            x, z = -1 + (2 * column + 1) / columns, low + (row + 0.55) * (high - low) / rows
            parts.append(box((x - 0.14 / columns, x + 0.14 / columns), (-1, -0.93), (z - 0.012, z + 0.012), _HANDLE))
    return tuple(parts)


SHAPES: dict[str, Shape] = {
    "desk": shape(
        (box((-1, 1), (-1, 1), (0.94, 1)), mirrored(box((0.94, 1), (-0.9, 0.95), (0, 0.94)), "x"),
         box((0.4, 0.94), (-0.88, 0.9), (0.3, 0.94), "body", _drawers(1, 3)),
         box((-0.94, 0.94), (0.86, 0.92), (0.5, 0.94))),
        (box((-1, 1), (-1, 1), (0.94, 1)), legs(0.94, 0.06, 0.12, "metal", 0.02),
         box((0.3, 0.9), (-0.9, 0.7), (0.76, 0.94), "body", _drawers(1, 1)), *_handles(1, 1, 0.76, 0.94)[:0]),
        (box((-1, 1), (-1, 1), (0.94, 1)),
         mirrored(box((0.5, 0.96), (-0.9, 0.9), (0.06, 0.94), "body", _drawers(1, 4)), "x"),
         mirrored(box((0.54, 0.92), (-0.8, 0.8), (0, 0.06), "dark"), "x"), box((-0.5, 0.5), (-0.9, 0.9), (0.82, 0.94))),
        size=(1.4, 0.7, 0.75), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "dining table": shape(
        (box((-1, 1), (-1, 1), (0.93, 1)), legs(0.93, 0.09, 0.13, inset=0.03),
         box((-0.9, 0.9), (-0.86, 0.86), (0.84, 0.93))),
        (rod((-1, 1), (-1, 1), (0.93, 1)), rod((-0.14, 0.14), (-0.14, 0.14), (0.06, 0.93), taper=(0.7, 1)),
         rod((-0.5, 0.5), (-0.5, 0.5), (0, 0.07))),
        (box((-1, 1), (-1, 1), (0.94, 1)), mirrored(box((0.66, 0.74), (-0.75, 0.75), (0.05, 0.94)), "x"),
         mirrored(box((0.62, 0.78), (-0.9, 0.9), (0, 0.06)), "x"), box((-0.66, 0.66), (-0.06, 0.06), (0.3, 0.4))),
        size=(1.4, 0.9, 0.75), palette=_WOODEN, finishes=_WOOD, where="floor", bears=True,
    ),
    "coffee table": shape(
        (box((-1, 1), (-1, 1), (0.88, 1)), legs(0.88, 0.1, 0.16), box((-0.92, 0.92), (-0.9, 0.9), (0.28, 0.36))),
        (box((-1, 1), (-1, 1), (0.9, 1), "glass"), legs(0.9, 0.06, 0.1, "metal", 0.06),
         mirrored(box((-0.9, 0.9), (0.84, 0.94), (0.8, 0.9), "metal"), "y"), box((-1, 1), (-1, 1), (0.3, 0.36))),
        (rod((-1, 1), (-1, 1), (0.86, 1)), legs(0.86, 0.1, 0.1, inset=0.32)),
        size=(1.0, 0.6, 0.42), palette=_WOODEN, finishes=_WOOD, where="floor", bears=True,
    ),
    "side table": shape(
        (box((-1, 1), (-1, 1), (0.94, 1)), legs(0.94, 0.13, 0.13, inset=0.04),
         box((-0.86, 0.86), (-0.86, 0.86), (0.66, 0.94), "body", _drawers(1, 1)),
         box((-0.9, 0.9), (-0.9, 0.9), (0.2, 0.24))),
        (rod((-1, 1), (-1, 1), (0.94, 1)), rod((-0.12, 0.12), (-0.12, 0.12), (0.05, 0.94)),
         rod((-0.6, 0.6), (-0.6, 0.6), (0, 0.05))),
        (box((-1, 1), (-1, 1), (0.93, 1)), legs(0.93, 0.1, 0.1), box((-1, 1), (-0.95, 0.95), (0.4, 0.45))),
        size=(0.46, 0.46, 0.55), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "dresser": shape(
        (box((-1, 1), (-1, 1), (0.96, 1)), box((-0.98, 0.98), (-0.95, 1), (0.1, 0.96), "body", _drawers(2, 4)),
         *_handles(2, 4, 0.1, 0.96), legs(0.1, 0.08, 0.16, inset=0.03)),
        (box((-1, 1), (-1, 1), (0.95, 1)), box((-0.97, 0.97), (-0.93, 1), (0.0, 0.95), "body", _drawers(3, 3)),
         *_handles(3, 3, 0.0, 0.95)),
        size=(1.2, 0.48, 0.95), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "drawer": shape(
        (box((-1, 1), (-1, 1), (0.96, 1)), box((-0.97, 0.97), (-0.93, 1), (0.05, 0.96), "body", _drawers(1, 3)),
         *_handles(1, 3, 0.05, 0.96), box((-0.9, 0.9), (-0.8, 1), (0, 0.05), "dark")),
        size=(0.5, 0.5, 0.7), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "shelf": shape(
        (mirrored(box((0.94, 1), (-1, 1), (0, 1)), "x"), box((-1, 1), (-1, 1), (0.95, 1)),
         box((-1, 1), (0.9, 1), (0, 1), "trim"),
         box((-0.94, 0.94), (-0.95, 0.95), (0.04, 0.08)), box((-0.94, 0.94), (-0.95, 0.95), (0.35, 0.39)),
         box((-0.94, 0.94), (-0.95, 0.95), (0.66, 0.70)),
         box((-0.9, 0.3), (-0.4, 0.8), (0.39, 0.62), "dark", Pattern("spines", "dark", (16, 1), FRONT)),
         box((-0.2, 0.9), (-0.4, 0.8), (0.70, 0.92), "dark", Pattern("spines", "dark", (14, 1), FRONT)),
         box((0.45, 0.85), (-0.6, 0.4), (0.08, 0.24), "fabric"), box((-0.85, -0.1), (-0.4, 0.8), (0.08, 0.30), "dark",
         Pattern("spines", "dark", (10, 1), FRONT))),
        (mirrored(box((0.94, 1), (-1, 1), (0, 1)), "x"), box((-1, 1), (-1, 1), (0.94, 1)),
         box((-0.03, 0.03), (-0.95, 0.95), (0, 0.95)),
         box((-0.94, 0.94), (-0.95, 0.95), (0.03, 0.08)), box((-0.94, 0.94), (-0.95, 0.95), (0.48, 0.53)),
         box((-0.94, 0.94), (0.9, 0.98), (0, 0.95), "trim"),
         box((0.1, 0.8), (-0.4, 0.8), (0.53, 0.86), "dark", Pattern("spines", "dark", (9, 1), FRONT)),
         box((-0.9, -0.25), (-0.4, 0.8), (0.08, 0.4), "dark", Pattern("spines", "dark", (9, 1), FRONT))),
        size=(1.2, 0.36, 1.2), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "cabinet": shape(
        (box((-1, 1), (-0.94, 1), (0.06, 0.97), "body", Pattern("doors", "dark", (2, 1), FRONT)),
         box((-1, 1), (-1, 1), (0.97, 1)),
         box((-0.94, 0.94), (-0.85, 1), (0, 0.06), "dark"),
         mirrored(box((0.05, 0.09), (-1, -0.94), (0.48, 0.62), _HANDLE), "x")),
        (box((-1, 1), (-0.94, 1), (0.1, 1), "body", Pattern("doors", "dark", (2, 1), FRONT)), legs(0.1, 0.1, 0.2),
         mirrored(ball((0.05, 0.13), (-1, -0.9), (0.5, 0.56), _HANDLE), "x")),
        size=(0.9, 0.45, 1.2), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "tv stand": shape(
        (box((-1, 1), (-1, 1), (0.9, 1)), mirrored(box((0.94, 1), (-1, 1), (0.08, 0.9)), "x"),
         box((-1, 1), (-1, 1), (0.04, 0.14)),
         box((-0.94, 0.94), (0.9, 0.98), (0.1, 0.9), "trim"),
         mirrored(box((0.4, 0.95), (-0.95, 0.9), (0.14, 0.9), "body", _drawers(1, 2)), "x"),
         box((-0.4, 0.4), (-0.9, 0.9), (0.48, 0.54)), box((-0.3, 0.3), (-0.7, 0.5), (0.54, 0.68), "dark"),
         legs(0.04, 0.1, 0.2, "dark")),
        size=(1.4, 0.42, 0.5), palette=_WOODEN, finishes=_WOOD, has_front=True, where="floor", bears=True,
    ),
    "countertop": shape(
        (box((-1, 1), (-1, 1), (0.95, 1), "trim", Pattern("speckle", "accent", (30, 30), per_metre=True)),
         box((-1, 1), (-0.93, 1), (0.1, 0.95), "body", Pattern("doors", "dark", (6, 1), FRONT)),
         box((-1, 1), (-0.8, 1), (0, 0.1), "dark")),
        size=(2.4, 0.62, 0.92),
        palette={"body": ("white", "cream", "oak", "grey", "sky", "mint"),
         "trim": ("grey", "charcoal", "walnut", "white")},
        has_front=True, where="floor", bears=True,
    ),
    "sink": shape(
        (box((-1, 1), (-0.9, 1), (0, 0.86), "body", Pattern("doors", "dark", (2, 1), FRONT)),
         mirrored(box((0.72, 1), (-1, 1), (0.86, 1), "glass"), "x"), box((-0.72, 0.72), (-1, -0.7), (0.86, 1), "glass"),
         box((-0.72, 0.72), (0.6, 1), (0.86, 1), "glass"), box((-0.72, 0.72), (-0.7, 0.6), (0.86, 0.89), "metal"),
         rod((-0.06, 0.06), (0.7, 0.9), (1, 2), "metal"), rod((-0.05, 0.05), (0.0, 0.9), (1.82, 2), "metal", axis="y"),
         mirrored(ball((0.16, 0.32), (0.7, 0.9), (1, 1.35), "metal"), "x")),
        size=(0.7, 0.5, 0.86), palette={"body": ("white", "oak", "grey", "walnut"), "glass": ("white", "silver")},
        has_front=True, rise=0.26,
        where="floor", bears=True,
    ),
    "fridge": shape(
        (box((-1, 1), (-0.9, 1), (0.03, 1)), box((-0.99, 0.99), (-0.99, -0.9), (0.03, 0.64)),
         box((-0.99, 0.99), (-0.99, -0.9), (0.66, 1)),
         box((-0.9, -0.8), (-1, -0.93), (0.4, 0.61), "dark"), box((-0.9, -0.8), (-1, -0.93), (0.69, 0.84), "dark"),
         box((-0.95, 0.95), (-0.85, 0.95), (0, 0.03), "dark")),
        (box((-1, 1), (-0.9, 1), (0.03, 1)), box((-0.99, -0.02), (-0.98, -0.9), (0.34, 1)),
         box((0.02, 0.99), (-0.98, -0.9), (0.34, 1)),
         box((-0.99, 0.99), (-0.98, -0.9), (0.04, 0.32)),
         mirrored(box((0.05, 0.1), (-1, -0.93), (0.5, 0.85), "metal"), "x"),
         box((-0.3, 0.3), (-1, -0.93), (0.26, 0.28), "metal"), box((-0.7, -0.3), (-0.99, -0.95), (0.6, 0.75), "screen"),
         box((-0.95, 0.95), (-0.85, 0.95), (0, 0.03), "dark")),
        size=(0.7, 0.68, 1.8), palette={"body": ("white", "silver", "white", "steel", "charcoal", "cream", "red")},
        has_front=True,
        where="floor", gloss=0.2,
    ),
    "oven": shape(
        (box((-1, 1), (-0.93, 1), (0, 1)), box((-0.85, 0.85), (-0.97, -0.93), (0.12, 0.68), "screen"),
         rod((-0.8, 0.8), (-1, -0.94), (0.72, 0.76), "metal", axis="x"),
         mirrored(rod((0.5, 0.64), (-1, -0.93), (0.84, 0.93), "dark", axis="y"), "x"),
         mirrored(rod((0.14, 0.28), (-1, -0.93), (0.84, 0.93), "dark", axis="y"), "x"),
         mirrored(rod((0.2, 0.75), (0.2, 0.75), (0.99, 1), "dark", Pattern("rings", "metal", (1, 3))), "x", "y")),
        size=(0.6, 0.6, 0.9), palette={"body": ("white", "silver", "steel", "black", "cream")}, has_front=True,
        where="floor", bears=True, gloss=0.2,
    ),
    "washing machine": shape(
        (box((-1, 1), (-0.93, 1), (0, 1)), tube((-0.66, 0.66), (-1, -0.9), (0.2, 0.72), "metal", axis="y", hole=0.75),
         rod((-0.5, 0.5), (-0.97, -0.9), (0.25, 0.67), "screen", axis="y"),
         box((-1, 1), (-0.97, -0.93), (0.84, 1), "trim"),
         rod((0.3, 0.55), (-1, -0.95), (0.87, 0.97), "metal", axis="y"),
         box((-0.85, -0.2), (-0.98, -0.95), (0.88, 0.96), "glow")),
        size=(0.6, 0.6, 0.85), palette={"body": ("white", "white", "silver", "grey")}, has_front=True, where="floor",
        bears=True,
    ),
    "garbage can": shape(
        (tube((-1, 1), (-1, 1), (0, 0.92), taper=(0.76, 1), hole=0.9), rod((-0.7, 0.7), (-0.7, 0.7), (0, 0.3), "dark"),
         tube((-1, 1), (-1, 1), (0.9, 1), "trim", hole=0.88)),
        (rod((-0.95, 0.95), (-0.95, 0.95), (0.05, 0.84)), ball((-0.95, 0.95), (-0.95, 0.95), (0.68, 1.0), "trim"),
         rod((-1, 1), (-1, 1), (0.82, 0.86), "dark"), rod((-0.9, 0.9), (-0.9, 0.9), (0, 0.06), "dark"),
         box((-0.3, 0.3), (-1, -0.9), (0.02, 0.08), "dark")),
        (tube((-1, 1), (-1, 1), (0, 1), "body", Pattern("grid", "dark", (18, 8), MANTLE), taper=(0.8, 1), hole=0.92),
         rod((-0.74, 0.74), (-0.74, 0.74), (0, 0.25), "paper")),
        size=(0.32, 0.32, 0.45), palette={"body": ("grey", "black", "silver", "green", "blue", "white", "red")},
        where="floor", gloss=0.25,
    ),
    "safe": shape(
        (box((-1, 1), (-0.9, 1), (0.05, 1)), box((-0.86, 0.86), (-0.96, -0.9), (0.14, 0.92), "trim"),
         rod((-0.3, 0.1), (-1, -0.93), (0.42, 0.64), "metal", Pattern("rays", "dark"), axis="y"),
         rod((-0.18, -0.02), (-1, -0.94), (0.48, 0.58), "dark", axis="y"),
         box((0.4, 0.7), (-1, -0.94), (0.5, 0.56), "metal"),
         mirrored(box((0.6, 0.9), (-0.8, 0.9), (0, 0.05), "dark"), "x")),
        size=(0.5, 0.5, 0.55), palette={"body": ("charcoal", "grey", "steel", "black", "olive")}, has_front=True,
        where="floor", bears=True,
    ),
    "floor lamp": shape(
        (rod((-0.8, 0.8), (-0.8, 0.8), (0, 0.025), "metal"), rod((-0.09, 0.09), (-0.09, 0.09), (0.02, 0.8), "metal"),
         tube((-1, 1), (-1, 1), (0.76, 1), taper=(1, 0.62), hole=0.93),
         ball((-0.25, 0.25), (-0.25, 0.25), (0.8, 0.9), "light")),
        (rod((-0.7, 0.7), (-0.7, 0.7), (0, 0.03), "dark"), rod((-0.07, 0.07), (-0.07, 0.07), (0.03, 0.86), "dark"),
         tube((-1, 1), (-1, 1), (0.8, 1), hole=0.94), ball((-0.3, 0.3), (-0.3, 0.3), (0.84, 0.96), "light")),
        size=(0.36, 0.36, 1.6), palette={"body": ("cream", "white", "beige", "orange", "red", "grey", "green")},
        where="floor",
    ),
    "plant": shape(
        (rod((-0.55, 0.55), (-0.55, 0.55), (0, 0.3), taper=(0.7, 1)),
         rod((-0.48, 0.48), (-0.48, 0.48), (0.28, 0.31), "dark"),
         rod((-0.06, 0.06), (-0.06, 0.06), (0.3, 0.7), "wood"),
         ball((-0.55, 0.55), (-0.55, 0.55), (0.55, 1), "leaf", Pattern("leather", "dark", (6, 6))),
         ball((-1, 0.0), (-0.5, 0.5), (0.42, 0.8), "leaf", Pattern("leather", "dark", (6, 6))),
         ball((0.0, 1), (-0.5, 0.5), (0.4, 0.78), "leaf", Pattern("leather", "dark", (6, 6))),
         ball((-0.5, 0.5), (0.0, 1), (0.45, 0.75), "leaf"), ball((-0.5, 0.5), (-1, 0.0), (0.45, 0.75), "leaf")),
        (rod((-0.5, 0.5), (-0.5, 0.5), (0, 0.26), taper=(0.75, 1)),
         rod((-0.42, 0.42), (-0.42, 0.42), (0.25, 0.27), "dark"),
         *(ball((x - 0.13, x + 0.13), (y - 0.13, y + 0.13), (0.2, top), "leaf", lean=(axis, "z", lean))
           for x, y, top, axis,
           lean in ((0.35, 0, 0.95, "x", 0.5), (-0.35, 0, 0.9, "x", -0.5), (0, 0.35, 0.92, "y", 0.5),
                                         (0, -0.35, 0.86, "y", -0.5), (0.1, 0.1, 1.0, "x", 0.1),
                                         (-0.2, -0.1, 0.97, "x", -0.15)))),
        size=(0.4, 0.4, 0.7), palette={"body": ("brick", "white", "grey", "blue", "brown", "black")}, where="floor",
    ),
    "mirror": shape(
        (box((-1, 1), (-0.6, 1), (0, 1), "body"), box((-0.86, 0.86), (-1, -0.55), (0.06, 0.94), "glass")),
        size=(0.6, 0.06, 1.5), palette={"body": ("walnut", "gold", "black", "white"), "glass": ("silver", "sky")},
        has_front=True, where="floor",
    ),
    "painting": shape(
        (box((-1, 1), (-0.5, 1), (0, 1)),
         box((-0.86, 0.86), (-1, -0.4), (0.08, 0.92), "glow", Pattern("picture", "leaf", faces=FRONT))),
        size=(0.8, 0.05, 0.6), palette={"body": ("gold", "walnut", "black", "oak")}, has_front=True,
    ),
    "fireplace": shape(
        (mirrored(box((0.55, 1), (-0.9, 1), (0, 0.86), "body", Pattern("bricks", "fabric", (4, 10))), "x"),
         box((-0.55, 0.55), (-0.9, 1), (0.6, 0.86), "body", Pattern("bricks", "fabric", (5, 3))),
         box((-0.55, 0.55), (0.5, 1), (0, 0.6), "dark"),
         box((-1, 1), (-1, 1), (0.86, 1), "wood"), rod((-0.4, 0.4), (-0.4, 0.2), (0.02, 0.12), "wood", axis="x")),
        size=(1.3, 0.45, 1.1), palette={"body": ("brick", "grey", "cream")}, has_front=True, where="floor", bears=True,
    ),
    "obstacle": shape(
        (box((-1, 1), (-1, 1), (0, 1)),),
        size=(0.6, 0.6, 0.8), palette={"body": ("grey", "beige", "tan", "cardboard", "steel")}, where="floor",
        bears=True,
    ),
}  # fmt: skip

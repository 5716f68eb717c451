"""Shapes of what is worn or carried."""

from __future__ import annotations

from sim.appearance.shape import Pattern, Shape, ball, box, mirrored, rod, shape, tube

_BOOT = (
    rod((0.12, 0.9), (0.0, 0.95), (0.1, 1)),
    rod((0.2, 0.82), (0.12, 0.84), (0.96, 1.0), "ink"),
    ball((0.1, 0.92), (-0.98, 0.6), (-0.1, 0.5)),
    box((0.1, 0.92), (-0.96, 0.96), (0, 0.09), "dark"),
    box((0.3, 0.72), (-0.3, 0.05), (0.4, 0.8), "accent", Pattern("bands", "dark", (1, 5)), lean=("y", "z", 0.1)),
)
_SHOE = (
    ball((-1, 0.3), (-0.9, 0.9), (-0.1, 0.62)),
    box((-0.2, 0.96), (-0.86, 0.86), (0.12, 0.66)),
    ball((0.3, 1), (-0.86, 0.86), (0.1, 1)),
    rod((0.2, 0.86), (-0.6, 0.6), (0.86, 0.95), "ink"),
    box((-0.98, 1), (-1, 1), (0, 0.16), "paper"),
    box((-0.5, 0.2), (-0.34, 0.34), (0.5, 0.76), "accent", Pattern("stripes", "paper", (4, 1)), lean=("z", "x", 0.12)),
)

SHAPES: dict[str, Shape] = {
    "boots": shape(
        (mirrored(_BOOT[0], "x"), mirrored(_BOOT[1], "x"), mirrored(_BOOT[2], "x"), mirrored(_BOOT[3], "x"),
         mirrored(_BOOT[4], "x"), mirrored(box((0.94, 1), (0.3, 0.6), (0.9, 0.96)), "x"),
         mirrored(box((0.4, 0.6), (0.9, 1), (0.4, 0.9)), "x"),
         mirrored(box((0.4, 0.6), (-1, -0.9), (0, 0.12), "dark"), "x")),
        size=(0.26, 0.28, 0.32), palette={"body": ("brown", "black", "tan", "walnut", "yellow", "green", "red")},
        has_front=True, finishes=("plain", "leather"),
    ),
    "shoe": shape(
        _SHOE, size=(0.28, 0.1, 0.11), palette={"body": ("white", "black", "red", "blue", "grey", "green", "brown")},
        finishes=("plain", "plain", "leather"),
    ),
    "hat": shape(
        (rod((-1, 1), (-1, 1), (0, 0.1)), rod((-0.6, 0.6), (-0.6, 0.6), (0.08, 0.95), taper=(1, 0.82)),
         rod((-0.62, 0.62), (-0.62, 0.62), (0.1, 0.34), "trim"), ball((-0.5, 0.5), (-0.5, 0.5), (0.84, 1))),
        (ball((-0.6, 1), (-0.95, 0.95), (-0.8, 1)), rod((-0.6, 1), (-1, 1), (0, 0.2), "trim"),
         box((-1, -0.2), (-0.7, 0.7), (0.02, 0.14), "body"), ball((0.12, 0.28), (-0.1, 0.1), (0.94, 1), "trim")),
        size=(0.32, 0.3, 0.13), palette={"body": ("brown", "black", "beige", "red", "blue", "green", "grey")},
        finishes=("plain", "weave"),
    ),
    "umbrella": shape(
        (rod((-0.6, 0.8), (-1, 1), (0, 1), axis="x", taper=(1, 0.3)),
         rod((0.8, 1), (-0.2, 0.2), (0.4, 0.6), "metal", axis="x"),
         rod((-0.86, -0.6), (-0.25, 0.25), (0.35, 0.65), "metal", axis="x"),
         tube((-1, -0.82), (-0.9, 0.4), (0.3, 0.7), "wood", hole=0.6),
         rod((-0.3, -0.24), (-0.95, 0.95), (0.02, 0.98), "trim", axis="x")),
        size=(0.8, 0.1, 0.08), palette={"body": ("black", "red", "blue", "green", "yellow", "purple")},
        finishes=("plain", "stripes"), pose="lying",
    ),
    "backpack": shape(
        (box((-0.9, 0.9), (-0.5, 0.7), (0.02, 0.72)), rod((-0.9, 0.9), (-0.5, 0.7), (0.5, 0.96), axis="y"),
         box((-0.72, 0.72), (-1, -0.45), (0.06, 0.46), "trim"), box((-0.6, 0.6), (-1, -0.5), (0.38, 0.42), "metal"),
         mirrored(box((0.84, 1), (-0.4, 0.5), (0.08, 0.42), "trim"), "x"),
         tube((-0.24, 0.24), (-0.1, 0.3), (0.84, 1), "dark", axis="y", hole=0.6),
         mirrored(box((0.3, 0.5), (0.7, 1), (0.1, 0.86), "dark"), "x"),
         box((-0.75, 0.75), (-0.54, -0.48), (0.6, 0.63), "metal")),
        size=(0.32, 0.22, 0.46),
        palette={"body": ("blue", "black", "red", "green", "grey", "purple", "orange", "teal")}, has_front=True,
        finishes=("plain", "weave"), where="floor",
    ),
    "handbag": shape(
        (box((-1, 1), (-1, 1), (0, 0.6)), box((-0.98, 0.98), (-1, -0.86), (0.3, 0.62), "trim"),
         rod((-0.1, 0.1), (-1, -0.8), (0.26, 0.34), "metal", axis="y"),
         mirrored(tube((-0.62, 0.62), (0.4, 0.56), (0.2, 1), "trim", axis="y", hole=0.86), "y")),
        size=(0.32, 0.14, 0.3), palette={"body": ("brown", "black", "red", "tan", "pink", "maroon", "navy", "yellow")},
        finishes=("plain", "leather"), has_front=True,
    ),
    "suitcase": shape(
        (box((-1, 1), (-0.9, 0.9), (0.06, 0.82), "body", Pattern("stripes", "trim", (7, 1))),
         mirrored(rod((0.7, 0.9), (-0.9, 0.9), (0, 0.08), "ink", axis="y"), "x"),
         mirrored(box((0.3, 0.38), (-0.1, 0.1), (0.8, 0.98), "metal"), "x"),
         box((-0.38, 0.38), (-0.12, 0.12), (0.96, 1), "dark"), box((-1, 1), (-1, 1), (0.42, 0.45), "dark")),
        size=(0.44, 0.26, 0.7), palette={"body": ("blue", "red", "black", "grey", "green", "purple")}, where="floor",
        gloss=0.2,
    ),
    "glove": shape(
        (box((-0.4, 0.4), (-0.7, 0.5), (0, 0.9)), box((-1, -0.4), (-0.6, 0.4), (0.0, 1), "trim"),
         *(ball((0.25, top), (y - 0.14, y + 0.14), (0.1, 0.9)) for y,
          top in ((-0.55, 0.86), (-0.24, 1.0), (0.07, 0.97), (0.36, 0.84))),
          ball((-0.3, 0.3), (0.4, 1), (0.1, 0.8), lean=("y", "x", 0.0)), ball((-0.4, 0.1), (-1, -0.2), (0.1, 0.8))),
        size=(0.22, 0.13, 0.03), pose="lying", finishes=("plain", "weave"),
    ),
    "tie": shape(
        (box((-1, 0.7), (-0.7, 0.7), (0, 0.8), "body", Pattern("stripes", "accent", (14, 1))),
         box((0.7, 1), (-1, 1), (0, 1), "body")), size=(0.5, 0.08, 0.012), pose="lying",
    ),
    "sock": shape(
        (box((-1, 0.4), (0.0, 1), (0, 0.9)), box((0.0, 1), (-0.4, 0.9), (0, 0.9)), ball((0.3, 1), (-1, 0.4), (0, 1)),
         box((-1, -0.7), (-0.05, 1), (0, 1), "accent")), size=(0.22, 0.16, 0.02), pose="lying",
         finishes=("bands", "stripes", "plain"),
    ),
    "belt": shape(
        (tube((-0.9, 1), (-1, 1), (0, 1), hole=0.86), tube((-0.7, 0.8), (-0.8, 0.8), (0.1, 0.9), hole=0.85),
         box((-1, -0.7), (-0.3, 0.3), (0, 1), "metal")), size=(0.14, 0.13, 0.035),
         palette={"body": ("brown", "black", "tan")},
    ),
}  # fmt: skip

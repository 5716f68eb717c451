"""Shapes of what keeps a home and a body clean, and of what else lies about."""

from __future__ import annotations

from sim.appearance.shape import ENDS, FRONT, MANTLE, TOP, Pattern, Shape, ball, box, mirrored, rod, shape, tube

_CLOTH = ("plain", "stripes", "checks", "dots", "weave")

SHAPES: dict[str, Shape] = {
    "pillow": shape(
        (ball((-1, 1), (-1, 1), (0, 1)), box((-0.86, 0.86), (-0.84, 0.84), (0.28, 0.72)),
         mirrored(ball((0.66, 0.98), (0.6, 0.98), (0.34, 0.66)), "x", "y")),
        size=(0.46, 0.4, 0.15),
        palette={"body": ("blue", "white", "red", "green", "cream", "grey", "yellow", "purple", "pink", "teal")},
        finishes=_CLOTH, pose="lying",
    ),
    "cloth": shape(
        (box((-1, 1), (-1, 0.9), (0, 0.4)), box((-0.9, 0.96), (-0.8, 1), (0.3, 0.7)),
         box((-0.6, 0.7), (-0.7, 0.6), (0.6, 0.85), lean=("y", "x", 0.1)), ball((-0.8, 0.6), (-0.5, 0.3), (0.4, 1))),
        size=(0.26, 0.2, 0.03), palette={"body": ("grey", "white", "blue", "red", "yellow", "green", "pink")},
        finishes=("checks", "stripes", "weave"), pose="lying",
    ),
    "towel": shape(
        (box((-1, 1), (-1, 0.8), (0, 0.32)), box((-1, 1), (-0.98, 0.8), (0.34, 0.66)),
         box((-1, 1), (-0.96, 0.8), (0.68, 1)), rod((-1, 1), (0.6, 1), (0, 0.66), axis="x"),
         box((0.5, 0.7), (-1, 0.8), (0.98, 1), "accent")),
        (rod((-1, 1), (-1, 1), (0, 1), "body", Pattern("rings", "accent", (1, 3), ENDS), axis="x"),
         rod((0.4, 0.6), (-1, 1), (0, 1), "accent", axis="x")),
        size=(0.4, 0.25, 0.1), palette={"body": ("white", "blue", "pink", "green", "cream", "grey", "orange", "teal")},
        finishes=("weave", "plain"), pose="lying",
    ),
    "blanket": shape(
        (box((-1, 1), (-1, 1), (0, 0.32)), box((-0.98, 0.98), (-1, 0.96), (0.34, 0.66)),
         box((-0.96, 0.96), (-1, 0.94), (0.68, 1)), rod((-1, 1), (-1, -0.7), (0, 1), axis="x")),
        size=(0.6, 0.45, 0.14), palette={"body": ("red", "blue", "green", "grey", "brown", "purple")},
        finishes=("checks", "stripes", "weave"), pose="lying",
    ),
    "box": shape(
        (box((-1, 1), (-1, 1), (0, 1), "body", Pattern("label", "dark", (1, 1), 0)),
         box((-0.14, 0.14), (-1, 1), (0.6, 1), "light"), box((-1, 1), (-1, 1), (0, 0.02), "trim")),
        (box((-0.97, 0.97), (-0.97, 0.97), (0, 0.05)), mirrored(box((0.94, 1), (-1, 1), (0, 0.8)), "x"),
         mirrored(box((-1, 1), (0.94, 1), (0, 0.8)), "y"),
         mirrored(box((0.7, 0.78), (-0.95, 0.95), (0.78, 1), lean=("x", "z", 0.2)), "x"),
         mirrored(box((-0.95, 0.95), (0.7, 0.78), (0.76, 0.98), lean=("y", "z", 0.2)), "y")),
        size=(0.4, 0.32, 0.3),
        palette={"body": ("cardboard", "cardboard", "tan", "white", "blue"), "light": ("cream", "beige")},
        where="surface",
    ),
    "tissue box": shape(
        (box((-1, 1), (-1, 1), (0, 0.72)), rod((-0.5, 0.5), (-0.4, 0.4), (0.7, 0.735), "dark"),
         rod((-0.34, 0.34), (-0.14, 0.14), (0.7, 0.97), "paper", taper=(0.5, 1)),
         ball((-0.4, 0.4), (-0.24, 0.24), (0.78, 1), "paper", lean=("x", "z", 0.1))),
        size=(0.23, 0.12, 0.12),
        palette={"body": ("blue", "sky", "pink", "green", "mint", "lilac", "white", "orange"), "paper": ("white",)},
        finishes=("dots", "stripes", "checks", "plain"),
    ),
    "toilet paper": shape(
        (tube((-1, 1), (-1, 1), (0, 1), "body", hole=0.4),
         tube((-0.42, 0.42), (-0.42, 0.42), (0, 1), "wood", hole=0.86),
         box((0.94, 1), (-0.6, 0.1), (0.0, 1), "accent")),
        size=(0.11, 0.11, 0.1),
        palette={"body": ("white", "white", "cream"), "wood": ("cardboard",), "accent": ("paper",)},
        finishes=("plain",),
    ),
    "soap bar": shape(
        (ball((-1, 1), (-1, 1), (-0.25, 1)), box((-0.84, 0.84), (-0.74, 0.74), (0, 0.8)),
         box((-0.4, 0.4), (-0.3, 0.3), (0.92, 1), "accent")),
        size=(0.09, 0.06, 0.03), palette={"body": ("white", "cream", "pink", "mint", "lilac", "green", "yellow")},
        pose="lying", gloss=0.4,
    ),
    "watering can": shape(
        (rod((-0.4, 0.56), (-1, 1), (0, 0.72), taper=(1, 0.86)),
         box((-0.74, -0.62), (-0.16, 0.16), (0.12, 0.86), lean=("x", "z", -0.2)),
         rod((-1, -0.72), (-0.4, 0.4), (0.78, 0.98), "trim", taper=(0.5, 1)),
         tube((0.36, 1), (-0.14, 0.14), (0.14, 0.74), axis="y", hole=0.8),
         tube((-0.3, 0.46), (-0.12, 0.12), (0.5, 1), axis="y", hole=0.84),
         rod((-0.3, 0.46), (-0.8, 0.8), (0.71, 0.725), "dark")),
        size=(0.34, 0.16, 0.26), palette={"body": ("green", "blue", "red", "silver", "yellow", "leaf", "teal")},
        gloss=0.4,
    ),
    "bucket": shape(
        (tube((-1, 1), (-1, 1), (0, 0.72), taper=(0.64, 1), hole=0.93),
         tube((-1, 1), (-1, 1), (0.68, 0.74), "trim", hole=0.9),
         rod((-0.62, 0.62), (-0.62, 0.62), (0, 0.1), "dark"),
         tube((-0.98, 0.98), (-0.06, 0.06), (0.42, 1), "metal", axis="y", hole=0.9)),
        size=(0.28, 0.28, 0.34), palette={"body": ("blue", "red", "grey", "green", "yellow")}, where="floor", gloss=0.3,
    ),
    "broom": shape(
        (rod((-0.12, 0.12), (-0.3, 0.3), (0.2, 1), "wood"), box((-0.8, 0.8), (-0.8, 0.8), (0.16, 0.22)),
         box((-1, 1), (-1, 1), (0, 0.17), "light", Pattern("stripes", "wood", (20, 1)))),
        size=(0.32, 0.1, 1.2), palette={"light": ("beige", "banana", "tan")}, where="floor",
    ),
    "vacuum cleaner": shape(
        (ball((-1, 0.6), (-0.9, 0.9), (0, 0.5)), mirrored(rod((-0.1, 0.4), (0.6, 1), (0, 0.3), "ink", axis="y"), "y"),
         rod((-0.86, -0.6), (-0.2, 0.2), (0.2, 1), "metal", lean=("x", "z", -0.05)),
         box((-0.8, -0.4), (-0.3, 0.3), (0.46, 0.56), "trim"), box((0.4, 1), (-0.7, 0.7), (0, 0.12), "dark"),
         box((0.3, 0.5), (-0.15, 0.15), (0.06, 0.3), "dark")),
        size=(0.5, 0.32, 0.5), palette={"body": ("red", "blue", "green", "black", "purple")}, where="floor", gloss=0.4,
    ),
    "toothbrush": shape(
        (box((-1, 0.6), (-0.6, 0.6), (0, 0.5)), box((0.5, 1), (-1, 1), (0, 0.5), "fabric"),
         box((0.55, 0.97), (-0.8, 0.8), (0.5, 1), "paper", Pattern("stripes", "glow", (5, 1)))),
         size=(0.19, 0.014, 0.02), pose="lying",
    ),
    "plunger": shape(
        (rod((-0.14, 0.14), (-0.14, 0.14), (0.25, 1), "wood"),
         tube((-1, 1), (-1, 1), (0, 0.24), taper=(1, 0.4), hole=0.9), rod((-0.4, 0.4), (-0.4, 0.4), (0.22, 0.3))),
         size=(0.14, 0.14, 0.5), palette={"body": ("red", "brick", "black")}, where="floor",
    ),
    "laundry basket": shape(
        (tube((-1, 1), (-1, 1), (0, 1), "body", Pattern("grid", "dark", (20, 8), MANTLE), taper=(0.82, 1), hole=0.93),
         ball((-0.8, 0.8), (-0.8, 0.8), (0.55, 0.96), "fabric"), ball((-0.2, 0.8), (-0.6, 0.5), (0.6, 1), "glow")),
         size=(0.5, 0.4, 0.5), palette={"body": ("beige", "white", "tan", "grey")}, where="floor",
    ),
    "basket": shape(
        (tube((-1, 1), (-1, 1), (0, 0.6), "body", Pattern("checks", "dark", (24, 6), MANTLE), taper=(0.84, 1),
         hole=0.92), rod((-0.8, 0.8), (-0.8, 0.8), (0, 0.12), "dark"),
         tube((-0.96, 0.96), (-0.08, 0.08), (0.2, 1), "trim", axis="y", hole=0.92)), size=(0.32, 0.24, 0.28),
         palette={"body": ("tan", "oak", "beige")},
    ),
    "fan": shape(
        (rod((-0.5, 0.5), (-0.9, 0.9), (0, 0.05)), rod((-0.08, 0.08), (-0.1, 0.2), (0.05, 0.5)),
         tube((-1, 1), (-0.6, 0.2), (0.36, 1), "metal", axis="y", hole=0.94),
         rod((-0.24, 0.24), (-0.7, 0.4), (0.6, 0.76), axis="y"),
         mirrored(ball((0.1, 0.8), (-0.3, 0.0), (0.58, 0.78), "glass", lean=("z", "x", 0.06)), "x"),
         ball((-0.2, 0.2), (-0.3, 0), (0.7, 0.95), "glass"), ball((-0.2, 0.2), (-0.3, 0), (0.42, 0.66), "glass"),
         mirrored(box((-0.3, 0.3), (0.9, 1), (0, 0.04), "dark"), "y")), size=(0.36, 0.24, 0.5),
         palette={"body": ("white", "black", "blue", "grey")}, has_front=True,
    ),
    "telephone": shape(
        (box((-1, 1), (-1, 1), (0, 0.55)),
         box((-0.2, 0.8), (-0.8, 0.5), (0.5, 0.6), "trim", Pattern("keys", "paper", (3, 4), TOP)),
         box((-0.9, -0.5), (-0.9, 0.9), (0.7, 1)), mirrored(box((-0.95, -0.45), (0.55, 1), (0.5, 0.9)), "y")),
         size=(0.18, 0.2, 0.1), palette={"body": ("black", "white", "red", "cream", "grey")}, has_front=True, gloss=0.3,
    ),
    "radio": shape(
        (box((-1, 1), (-0.9, 1), (0, 0.8)),
         rod((-0.85, -0.15), (-1, -0.88), (0.12, 0.68), "ink", Pattern("rings", "metal", (1, 3), ENDS), axis="y"),
         box((0, 0.85), (-0.98, -0.88), (0.44, 0.66), "light", Pattern("stripes", "ink", (12, 1), FRONT)),
         mirrored(rod((0.1, 0.34), (-1, -0.9), (0.14, 0.34), "metal", axis="y"), "y"),
         rod((0.56, 0.8), (-1, -0.9), (0.14, 0.34), "metal", axis="y"),
         tube((-0.9, 0.9), (-0.1, 0.2), (0.62, 1), "metal", axis="y", hole=0.92)), size=(0.3, 0.12, 0.2),
         palette={"body": ("walnut", "red", "black", "cream", "mint")}, has_front=True,
    ),
    "lighter": shape((rod((-1, 1), (-1, 1), (0, 0.7)), box((-0.9, 0.9), (-0.8, 0.8), (0.7, 0.94), "metal"),
        rod((-0.5, 0.2), (-0.3, 0.3), (0.86, 1), "ink", axis="y")), size=(0.024, 0.014, 0.08), gloss=0.4,
        pose="longest up"),
}  # fmt: skip

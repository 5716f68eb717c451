"""Shapes of what one sits or lies on."""

from __future__ import annotations

from sim.appearance.shape import Pattern, Shape, ball, box, legs, mirrored, rod, shape, tube

_CLOTH = ("plain", "plain", "weave", "stripes", "leather")
_SOFT = {"body": ("grey", "brown", "beige", "blue", "navy", "green", "red", "charcoal", "teal", "tan", "cream")}
_WOODEN = {"body": ("oak", "pine", "walnut", "mahogany", "white", "black", "tan", "red", "blue")}

_SOFA_BODY = (
    box((-1, 1), (-0.95, 0.9), (0.12, 0.62)),
    mirrored(box((0.86, 1), (-0.95, 1), (0.1, 1.5)), "x"),
    box((-0.88, 0.88), (0.55, 1), (0.3, 2)),
    mirrored(box((0.8, 0.94), (-0.85, -0.7), (0, 0.12), "dark"), "x"),
    mirrored(box((0.8, 0.94), (0.7, 0.85), (0, 0.12), "dark"), "x"),
)

SHAPES: dict[str, Shape] = {
    "sofa": shape(
        (*_SOFA_BODY, mirrored(box((0.01, 0.85), (-1, 0.55), (0.62, 1)), "x"),
         mirrored(box((0.02, 0.84), (0.38, 0.6), (1, 1.85)), "x")),
        (*_SOFA_BODY, box((-0.285, 0.285), (-1, 0.55), (0.62, 1)),
         mirrored(box((0.3, 0.85), (-1, 0.55), (0.62, 1)), "x"),
         mirrored(box((0.02, 0.84), (0.38, 0.6), (1, 1.75), "trim"), "x")),
        (box((-0.9, 0.9), (-1, 0.9), (0.3, 1)), mirrored(rod((0.8, 1), (-1, 0.95), (0.85, 1.55), axis="y"), "x"),
         mirrored(box((0.82, 0.98), (-0.95, 0.9), (0.2, 1.2)), "x"), box((-0.85, 0.85), (0.6, 1), (0.3, 1.9)),
         rod((-0.85, 0.85), (0.62, 1), (1.75, 2), axis="x"), legs(0.3, 0.06, 0.12, "wood", 0.06)),
        size=(2.0, 0.92, 0.45), palette=_SOFT, finishes=_CLOTH, has_front=True, rise=0.38, where="floor", bears=True,
    ),
    "armchair": shape(
        (box((-0.7, 0.7), (-1, 0.8), (0.15, 1)), mirrored(box((0.66, 1), (-0.95, 0.95), (0.12, 1.5)), "x"),
         box((-0.9, 0.9), (0.55, 1), (0.2, 2)), box((-0.64, 0.64), (0.35, 0.6), (1, 1.8), "trim"),
         legs(0.15, 0.14, 0.14, "dark", 0.05)),
        (box((-0.75, 0.75), (-1, 0.85), (0.45, 1)), mirrored(rod((0.62, 1), (-1, 0.9), (1.0, 1.5), axis="y"), "x"),
         mirrored(box((0.7, 0.95), (-0.9, 0.9), (0.3, 1.3)), "x"), box((-0.85, 0.85), (0.6, 1), (0.4, 1.85)),
         rod((-0.85, 0.85), (0.6, 1), (1.7, 2), axis="x"), legs(0.45, 0.1, 0.1, "wood", 0.08)),
        size=(0.8, 0.8, 0.42), palette=_SOFT, finishes=_CLOTH, pose="ahead", has_front=True, rise=0.42, where="floor",
        bears=True,
    ),
    "chair": shape(
        (box((-1, 1), (-1, 0.9), (0.45, 0.51)), legs(0.45, 0.18, 0.18),
         mirrored(box((0.82, 1), (0.8, 1), (0.5, 1)), "x"),
         box((-0.85, 0.85), (0.84, 0.96), (0.86, 1)), box((-0.85, 0.85), (0.84, 0.96), (0.66, 0.74))),
        (box((-1, 1), (-1, 0.9), (0.44, 0.52), "accent"), legs(0.44, 0.14, 0.14),
         mirrored(box((0.84, 1), (0.82, 1), (0.5, 1)), "x"), box((-0.9, 0.9), (0.84, 0.96), (0.9, 1)),
         mirrored(box((0.08, 0.16), (0.86, 0.94), (0.52, 0.9)), "x"),
         mirrored(box((0.42, 0.5), (0.86, 0.94), (0.52, 0.9)), "x")),
        (box((-0.95, 0.95), (-1, 0.85), (0.46, 0.54)),
         mirrored(rod((0.72, 1), (-0.95, -0.67), (0, 0.46), "metal"), "x"),
         mirrored(rod((0.72, 1), (0.6, 0.88), (0, 0.46), "metal"), "x"), box((-1, 1), (0.82, 1), (0.6, 1)),
         mirrored(box((0.6, 0.78), (0.84, 0.96), (0.5, 0.66), "metal"), "x")),
        size=(0.45, 0.45, 0.9), palette=_WOODEN, finishes=("plain", "wood"), pose="ahead", has_front=True,
        where="floor",
    ),
    "office chair": shape(
        (box((-0.8, 0.8), (-0.9, 0.75), (0.42, 0.52)), rod((-0.12, 0.12), (-0.12, 0.12), (0.1, 0.42), "metal"),
         box((-1, 1), (-0.12, 0.12), (0.05, 0.11), "dark"), box((-0.12, 0.12), (-1, 1), (0.05, 0.11), "dark"),
         mirrored(ball((0.78, 1), (-0.14, 0.14), (0, 0.09), "dark"), "x"),
         mirrored(ball((-0.14, 0.14), (0.78, 1), (0, 0.09), "dark"), "y"),
         box((-0.72, 0.72), (0.7, 0.9), (0.6, 1)), box((-0.12, 0.12), (0.74, 0.86), (0.45, 0.62), "dark"),
         mirrored(box((0.8, 0.95), (-0.4, 0.5), (0.62, 0.67), "dark"), "x"),
         mirrored(box((0.82, 0.93), (-0.05, 0.1), (0.45, 0.62), "dark"), "x")),
        size=(0.6, 0.6, 1.0), palette={"body": ("black", "charcoal", "blue", "grey", "red")},
        finishes=("plain", "weave"),
        pose="ahead", has_front=True, where="floor",
    ),
    "stool": shape(
        (rod((-1, 1), (-1, 1), (0.88, 1)),
         mirrored(rod((0.55, 0.75), (0.55, 0.75), (0, 0.9), lean=("x", "z", -0.1)), "x", "y"),
         tube((-0.75, 0.75), (-0.75, 0.75), (0.28, 0.34), hole=0.86)),
        (box((-1, 1), (-1, 1), (0.86, 1)), legs(0.86, 0.2, 0.2)),
        size=(0.38, 0.38, 0.5), palette=_WOODEN, finishes=("plain", "wood"), where="floor", bears=True,
    ),
    "ottoman": shape(
        (box((-1, 1), (-1, 1), (0.16, 0.8)), box((-0.98, 0.98), (-0.98, 0.98), (0.84, 1)),
         box((-0.94, 0.94), (-0.94, 0.94), (0.78, 0.86), "trim"), legs(0.16, 0.16, 0.16, "dark", 0.06)),
        (rod((-1, 1), (-1, 1), (0.06, 1)), rod((-0.9, 0.9), (-0.9, 0.9), (0, 0.08), "dark")),
        size=(0.6, 0.6, 0.42), palette=_SOFT, finishes=("plain", "weave", "leather", "checks"), where="floor",
        bears=True,
    ),
    "bed": shape(
        (box((-1, 1), (-1, 1), (0.2, 0.5), "wood", Pattern("wood", "dark", (3, 3))),
         box((-0.96, 0.96), (-0.97, 0.94), (0.5, 0.8), "fabric"), box((-1, 1), (-1, 0.35), (0.5, 0.98)),
         box((-1, 1), (0.2, 0.38), (0.96, 1.0), "accent"),
         mirrored(ball((0.06, 0.9), (0.42, 0.92), (0.62, 1.16), "fabric"), "x"),
         box((-1, 1), (0.94, 1), (0, 2), "wood", Pattern("wood", "dark", (3, 3))), legs(0.2, 0.08, 0.06, "wood")),
        (box((-1, 1), (-1, 1), (0, 0.45), "dark"), box((-0.97, 0.97), (-0.98, 0.94), (0.45, 0.85), "fabric"),
         box((-1, 1), (-0.98, 0.5), (0.42, 1)), mirrored(ball((0.08, 0.92), (0.5, 0.92), (0.7, 1.2), "fabric"), "x"),
         box((-1, 1), (0.93, 1), (0, 1.7), "trim")),
        size=(1.6, 2.05, 0.55), finishes=("plain", "stripes", "checks", "dots", "weave"),
        palette={"body": ("blue", "navy", "red", "green", "cream", "grey", "pink", "purple", "teal", "yellow"),
                 "fabric": ("white", "cream")},
        pose="ahead", has_front=True, rise=0.5, where="floor", bears=True,
    ),
    "bench": shape(
        (box((-1, 1), (-1, 1), (0.82, 1)), mirrored(box((0.75, 0.88), (-0.9, 0.9), (0, 0.82)), "x"),
         box((-0.8, 0.8), (-0.15, 0.15), (0.25, 0.36))),
        size=(1.2, 0.38, 0.46), palette=_WOODEN, finishes=("plain", "wood"), where="floor", bears=True,
    ),
    "toilet": shape(
        (rod((-0.7, 0.7), (-0.8, 0.6), (0, 0.5), taper=(0.9, 0.7)),
         rod((-0.85, 0.85), (-1, 0.5), (0.4, 0.9), taper=(0.6, 1)),
         tube((-0.9, 0.9), (-1, 0.5), (0.9, 1), hole=0.68), rod((-0.6, 0.6), (-0.75, 0.25), (0.9, 0.94), "glass"),
         box((-0.5, 0.5), (0.3, 1), (0, 1)), box((-0.95, 0.95), (0.5, 1), (0.9, 1.9)),
         box((-1, 1), (0.46, 1), (1.9, 2)),
         rod((0.5, 0.7), (0.42, 0.5), (1.7, 1.8), "metal", axis="y")),
        size=(0.4, 0.66, 0.42), palette={"body": ("white", "white", "cream")}, pose="ahead", has_front=True, rise=0.38,
        where="floor", gloss=0.4,
    ),
    "bathtub": shape(
        (box((-1, 1), (-1, 1), (0, 0.3)), mirrored(box((0.9, 1), (-1, 1), (0.3, 1)), "x"),
         mirrored(box((-0.9, 0.9), (0.8, 1), (0.3, 1)), "y"), box((0.7, 0.8), (-0.1, 0.1), (0.9, 1), "metal")),
        size=(1.6, 0.75, 0.55), palette={"body": ("white", "cream", "sky")}, where="floor", gloss=0.4,
    ),
}  # fmt: skip

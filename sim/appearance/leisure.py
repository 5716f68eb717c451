"""Shapes of toys, sports gear, music and ornaments."""

from __future__ import annotations

from sim.appearance.shape import ENDS, MANTLE, Pattern, Shape, ball, box, mirrored, rod, shape, tube

_EYE = "ink"

SHAPES: dict[str, Shape] = {
    "teddy bear": shape(
        (ball((-0.62, 0.62), (-0.55, 0.6), (0.06, 0.62)), ball((-0.34, 0.34), (-0.68, -0.2), (0.14, 0.5), "accent"), ball((-0.55, 0.55), (-0.6, 0.5), (0.54, 0.95)), mirrored(ball((0.3, 0.66), (-0.2, 0.15), (0.82, 1)), "x"),
         ball((-0.24, 0.24), (-0.85, -0.4), (0.58, 0.76), "accent"), ball((-0.1, 0.1), (-0.92, -0.75), (0.68, 0.75), _EYE), mirrored(ball((0.14, 0.28), (-0.66, -0.46), (0.76, 0.83), _EYE), "x"),
         mirrored(ball((0.45, 1), (-0.6, 0.1), (0.3, 0.56), lean=("z", "x", -0.06)), "x"), mirrored(ball((0.1, 0.72), (-1, 0.0), (0, 0.26)), "x"), mirrored(ball((0.2, 0.62), (-1, -0.85), (0.04, 0.22), "accent"), "x"), ball((-0.2, 0.2), (0.5, 1), (0.05, 0.2))),
        size=(0.3, 0.28, 0.36), palette={"body": ("brown", "tan", "walnut", "cream", "white", "pink", "grey")}, has_front=True, finishes=("leather",),
    ),
    "doll": shape(
        (rod((-0.8, 0.8), (-0.8, 0.8), (0.1, 0.62), taper=(1, 0.35)), ball((-0.45, 0.45), (-0.5, 0.5), (0.64, 0.95), "fabric"), ball((-0.52, 0.52), (-0.3, 0.66), (0.7, 1), "wood"), mirrored(ball((0.4, 1), (-0.2, 0.2), (0.38, 0.6), "fabric", lean=("z", "x", -0.08)), "x"),
         mirrored(rod((0.1, 0.4), (-0.3, 0.1), (0, 0.16), "fabric"), "x"), mirrored(ball((0.1, 0.22), (-0.56, -0.4), (0.78, 0.83), _EYE), "x"), box((-0.1, 0.1), (-1, 1), (0.1, 0.12))),
        size=(0.18, 0.12, 0.34), palette={"fabric": ("skin",), "wood": ("walnut", "gold", "black")}, has_front=True, finishes=("plain", "dots", "stripes"),
    ),
    "statue": shape(
        (box((-1, 1), (-1, 1), (0, 0.14), "trim"), rod((-0.6, 0.6), (-0.6, 0.6), (0.14, 0.5), taper=(1, 0.6)), ball((-0.62, 0.62), (-0.5, 0.5), (0.4, 0.76)), ball((-0.34, 0.34), (-0.4, 0.4), (0.76, 1)), rod((-0.14, 0.14), (-0.14, 0.14), (0.68, 0.8)), mirrored(ball((0.45, 0.85), (-0.25, 0.25), (0.36, 0.72)), "x")),
        (box((-1, 1), (-1, 1), (0, 0.16), "trim"), ball((-0.9, 0.7), (-0.4, 0.4), (0.38, 0.72)), mirrored(box((0.4, 0.6), (-0.3, -0.05), (0.14, 0.55)), "x"), mirrored(box((0.35, 0.55), (0.05, 0.3), (0.14, 0.55)), "x"), ball((-1, -0.4), (-0.3, 0.3), (0.62, 1)), box((-0.75, -0.5), (-0.2, 0.2), (0.5, 0.8)), box((0.6, 0.75), (-0.1, 0.1), (0.3, 0.66))),
        size=(0.16, 0.14, 0.3), palette={"body": ("cream", "brass", "grey", "charcoal", "white", "gold", "olive"), "trim": ("charcoal", "walnut", "grey")}, finishes=("plain", "marble", "speckle"), has_front=True, gloss=0.35,
    ),
    "vase": shape(
        (ball((-1, 1), (-1, 1), (0.02, 0.66)), rod((-0.5, 0.5), (-0.5, 0.5), (0, 0.1)), rod((-0.44, 0.44), (-0.44, 0.44), (0.56, 0.86)), tube((-0.68, 0.68), (-0.68, 0.68), (0.84, 1), taper=(0.66, 1), hole=0.8), rod((-0.4, 0.4), (-0.4, 0.4), (0.84, 0.9), "dark")),
        (rod((-1, 1), (-1, 1), (0.3, 0.7), taper=(0.9, 1)), rod((-0.9, 0.9), (-0.9, 0.9), (0, 0.3), taper=(0.6, 1)), rod((-1, 1), (-1, 1), (0.7, 0.84), taper=(1, 0.55)), tube((-0.66, 0.66), (-0.66, 0.66), (0.84, 1), taper=(0.83, 1), hole=0.84), rod((-0.5, 0.5), (-0.5, 0.5), (0.84, 0.88), "dark")),
        size=(0.14, 0.14, 0.28), palette={"body": ("white", "blue", "teal", "red", "green", "yellow", "purple", "orange", "brick")}, finishes=("plain", "bands", "stripes", "dots", "marble"), gloss=0.5,
    ),
    "flowers": shape(
        (tube((-0.4, 0.4), (-0.4, 0.4), (0, 0.42), "glass", taper=(0.7, 1), hole=0.9), *(rod((x / 2 - 0.03, x / 2 + 0.03), (y / 2 - 0.03, y / 2 + 0.03), (0.1, z), "leaf", lean=("x", "z", x / 2)) for x, y, z in ((0.6, 0, 0.8), (-0.6, 0.1, 0.75), (0.05, 0.4, 0.9))),
         *(ball((x - 0.3, x + 0.3), (y - 0.3, y + 0.3), (z - 0.2, z)) for x, y, z in ((0.7, 0, 0.86), (-0.7, 0.1, 0.84), (0.1, 0.6, 0.95), (0, -0.5, 0.9), (0, 0, 1.0))), *(ball((x - 0.1, x + 0.1), (y - 0.42, y - 0.2), (z - 0.14, z - 0.04), "light") for x, y, z in ((0.7, 0, 0.86), (-0.7, 0.1, 0.84), (0, -0.5, 0.9), (0, 0, 1.0))),
         ball((-0.5, 0.5), (0.1, 1), (0.4, 0.7), "leaf"), ball((-0.5, 0.5), (-1, -0.1), (0.42, 0.68), "leaf")),
        size=(0.2, 0.2, 0.35), palette={"body": ("red", "pink", "yellow", "purple", "white", "orange"), "light": ("yellow",)},
    ),
    "candle": shape(
        (rod((-0.8, 0.8), (-0.8, 0.8), (0.06, 0.8)), rod((-1, 1), (-1, 1), (0, 0.08), "metal"), rod((-0.06, 0.06), (-0.06, 0.06), (0.8, 0.88), "ink"), ball((-0.2, 0.2), (-0.2, 0.2), (0.84, 1), "light")),
        (rod((-0.42, 0.42), (-0.42, 0.42), (0.2, 0.82)), rod((-1, 1), (-1, 1), (0, 0.1), "metal"), rod((-0.56, 0.56), (-0.56, 0.56), (0.08, 0.26), "metal", taper=(0.6, 1)), rod((-0.06, 0.06), (-0.06, 0.06), (0.82, 0.9), "ink"), ball((-0.16, 0.16), (-0.16, 0.16), (0.85, 1), "light")),
        size=(0.07, 0.07, 0.13), palette={"body": ("white", "cream", "red", "purple", "green", "yellow"), "light": ("yellow", "orange"), "metal": ("brass", "silver")},
    ),
    "basket ball": shape(
        (ball((-1, 1), (-1, 1), (0, 1), "body", Pattern("seams", "ink")),),
        size=(0.24, 0.24, 0.24), palette={"body": ("orange", "orange", "brick")}, finishes=("plain",),
    ),
    "soccer ball": shape(
        (ball((-1, 1), (-1, 1), (0, 1), "body", Pattern("dots", "ink", (7, 4))),), size=(0.22, 0.22, 0.22), palette={"body": ("white",)}, gloss=0.2,
    ),
    "tennis ball": shape(
        (ball((-1, 1), (-1, 1), (0, 1), "body", Pattern("seams", "paper")),), size=(0.066, 0.066, 0.066), palette={"body": ("yellow", "banana")},
    ),
    "baseball bat": shape(
        (rod((-1, 1), (-1, 1), (0.5, 0.97), taper=(0.7, 1)), rod((-0.7, 0.7), (-0.7, 0.7), (0.25, 0.5), taper=(0.56, 1)), rod((-0.4, 0.4), (-0.4, 0.4), (0.03, 0.26), "dark", Pattern("bands", "metal", (1, 8), MANTLE)), rod((-0.62, 0.62), (-0.62, 0.62), (0, 0.03), "trim"), ball((-1, 1), (-1, 1), (0.94, 1))),
        size=(0.07, 0.07, 0.9), palette={"body": ("pine", "oak", "tan", "black", "red", "silver")}, pose="longest up", finishes=("plain", "wood"),
    ),
    "tennis racket": shape(
        (tube((-0.28, 1), (-1, 1), (0.1, 0.9), hole=0.84), rod((-0.2, 0.92), (-0.86, 0.86), (0.4, 0.6), "paper", Pattern("grid", "ink", (10, 8), ENDS)), box((-0.62, -0.2), (-0.07, 0.07), (0.2, 0.8), "trim"), mirrored(box((-0.5, -0.14), (0.12, 0.22), (0.2, 0.8), lean=("y", "x", 0.16)), "y"),
         box((-1, -0.5), (-0.12, 0.12), (0, 1), "dark", Pattern("stripes", "metal", (8, 1)))),
        size=(0.68, 0.26, 0.035), palette={"body": ("red", "blue", "green", "yellow", "black", "white", "orange")}, pose="lying",
    ),
    "guitar": shape(
        (rod((-1, 1), (-0.6, 0.6), (0, 0.34), axis="y"), rod((-0.76, 0.76), (-0.6, 0.6), (0.26, 0.52), axis="y"), rod((-0.3, 0.3), (-0.7, -0.55), (0.28, 0.42), "ink", axis="y"), box((-0.14, 0.14), (-0.85, -0.4), (0.4, 0.88), "dark"), box((-0.24, 0.24), (-0.7, -0.3), (0.86, 1), "wood"),
         box((-0.4, 0.4), (-0.75, -0.58), (0.14, 0.17), "ink"), box((-0.06, 0.06), (-1, -0.8), (0.15, 0.9), "metal"), box((-0.1, 0.1), (0.6, 1), (0.1, 0.12), "dark")),
        size=(0.38, 0.12, 1.0), palette={"body": ("pine", "tan", "mahogany", "red", "black", "oak")}, has_front=True, finishes=("plain", "wood"), where="floor", gloss=0.3,
    ),
    "toy car": shape(
        (box((-1, 1), (-0.86, 0.86), (0.2, 0.6)), box((-0.5, 0.56), (-0.78, 0.78), (0.58, 1), "body"), box((-0.4, 0.46), (-0.82, 0.82), (0.64, 0.92), "glass"), *(part for x in (-0.6, 0.6) for part in mirrored(rod((x - 0.22, x + 0.22), (0.7, 1), (0, 0.48), "ink", axis="y"), "y")),
         mirrored(box((-1, -0.96), (0.4, 0.7), (0.36, 0.5), "light"), "y")),
        size=(0.16, 0.08, 0.06), palette={"body": ("red", "blue", "yellow", "green", "orange", "white")}, gloss=0.5,
    ),
    "dumbbell": shape(
        (rod((-0.4, 0.4), (-0.3, 0.3), (0.35, 0.65), "metal", axis="x"), mirrored(rod((0.36, 0.8), (-1, 1), (0, 1), axis="x"), "x"), mirrored(rod((0.8, 1), (-0.76, 0.76), (0.12, 0.88), axis="x"), "x")),
        size=(0.26, 0.1, 0.1), palette={"body": ("black", "charcoal", "blue", "pink", "green")}, gloss=0.2,
    ),
    "headphones": shape(
        (tube((-1, 1), (-0.2, 0.2), (-0.1, 1), axis="y", hole=0.9), mirrored(rod((0.62, 1), (-1, 1), (0, 0.56), axis="x"), "x"), mirrored(rod((0.5, 0.66), (-0.9, 0.9), (0.04, 0.52), "dark", axis="x"), "x")),
        size=(0.18, 0.08, 0.2), palette={"body": ("black", "white", "red", "blue", "silver")}, gloss=0.2,
    ),
    "speaker": shape(
        (box((-1, 1), (-0.9, 1), (0, 1)), rod((-0.7, 0.7), (-1, -0.88), (0.1, 0.56), "ink", Pattern("rings", "metal", (1, 2), ENDS), axis="y"), rod((-0.4, 0.4), (-1, -0.88), (0.66, 0.9), "ink", Pattern("rings", "metal", (1, 2), ENDS), axis="y")),
        size=(0.18, 0.2, 0.32), palette={"body": ("black", "walnut", "charcoal", "white", "oak")}, has_front=True,
    ),
    "game controller": shape(
        (box((-0.7, 0.7), (-0.5, 0.9), (0.2, 0.9)), mirrored(ball((0.3, 1), (-1, 0.9), (0, 0.95)), "x"), mirrored(rod((0.16, 0.4), (-0.4, 0.1), (0.85, 1), "ink"), "x"), rod((0.5, 0.66), (0.3, 0.6), (0.85, 1), "light"), rod((0.66, 0.82), (0.0, 0.3), (0.8, 0.98), "glow"), box((-0.78, -0.4), (0.2, 0.4), (0.8, 0.98), "ink"), box((-0.66, -0.52), (0.0, 0.6), (0.8, 0.98), "ink"), box((-0.2, 0.2), (0.85, 1), (0.3, 0.7), "dark")),
        size=(0.16, 0.11, 0.05), palette={"body": ("black", "white", "blue", "red", "grey"), "light": ("red", "yellow")}, pose="lying",
    ),
    "toy blocks": shape(
        (box((-1, -0.05), (-1, 0.6), (0, 0.5)), box((0.05, 1), (-0.6, 1), (0, 0.5), "glow"), box((-0.5, 0.5), (-0.7, 0.7), (0.5, 1), "light")), size=(0.12, 0.1, 0.12), palette={"glow": ("blue", "green"), "light": ("yellow", "orange")},
    ),
}  # fmt: skip

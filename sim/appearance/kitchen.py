"""Shapes of crockery, pots and food."""

from __future__ import annotations

from sim.appearance.shape import FRONT, MANTLE, TOP, Pattern, Shape, ball, box, mirrored, rod, shape, tube

_GLAZED = ("plain", "plain", "stripes", "bands", "dots", "checks")

SHAPES: dict[str, Shape] = {
    "mug": shape(
        (tube((-1, 0.46), (-0.98, 0.98), (0, 1), hole=0.86), rod((-0.86, 0.32), (-0.82, 0.82), (0, 0.12), "trim"),
         tube((0.36, 1), (-0.16, 0.16), (0.2, 0.84), "body", axis="y", hole=0.62)),
        (tube((-1, 0.46), (-0.98, 0.98), (0, 1), taper=(0.84, 1), hole=0.86), rod((-0.8, 0.26), (-0.74, 0.74), (0, 0.12), "trim"),
         box((0.38, 0.92), (-0.14, 0.14), (0.74, 0.86)), box((0.84, 1), (-0.14, 0.14), (0.3, 0.86)), box((0.3, 0.92), (-0.14, 0.14), (0.26, 0.38))),
        size=(0.12, 0.09, 0.1), finishes=_GLAZED, gloss=0.35,
    ),
    "cup": shape(
        (rod((-1, 1), (-1, 1), (0, 0.07), "trim"), tube((-0.72, 0.52), (-0.62, 0.62), (0.07, 1), taper=(0.5, 1), hole=0.88),
         rod((-0.6, 0.4), (-0.5, 0.5), (0.8, 0.86), "wood", gloss=0.0), tube((0.38, 0.86), (-0.08, 0.08), (0.42, 0.92), axis="y", hole=0.6)),
        size=(0.14, 0.14, 0.08), palette={"body": ("white", "cream", "blue", "green", "red", "yellow", "pink"), "wood": ("walnut", "mahogany")},
        finishes=("plain", "plain", "bands", "dots"), gloss=0.35,
    ),
    "tumbler": shape(
        (tube((-1, 1), (-1, 1), (0, 1), taper=(0.76, 1), hole=0.88), rod((-0.72, 0.72), (-0.72, 0.72), (0, 0.45), "accent")),
        size=(0.08, 0.08, 0.14), palette={"body": ("glass", "glass", "blue", "green", "sky", "mint"), "accent": ("sky", "glass")}, gloss=0.7,
    ),
    "bottle": shape(
        (rod((-0.97, 0.97), (-0.97, 0.97), (0, 0.58)), rod((-0.97, 0.97), (-0.97, 0.97), (0.58, 0.74), taper=(1, 0.36)), rod((-0.36, 0.36), (-0.36, 0.36), (0.74, 0.93)),
         rod((-0.42, 0.42), (-0.42, 0.42), (0.9, 1), "dark"), rod((-1, 1), (-1, 1), (0.16, 0.48), "paper", Pattern("label", "ink", (1, 1), MANTLE))),
        (rod((-0.97, 0.97), (-0.97, 0.97), (0, 0.66)), ball((-0.97, 0.97), (-0.97, 0.97), (0.54, 0.78)), rod((-0.32, 0.32), (-0.32, 0.32), (0.74, 0.94)),
         rod((-0.4, 0.4), (-0.4, 0.4), (0.92, 1), "trim"), rod((-1, 1), (-1, 1), (0.2, 0.5), "paper", Pattern("label", "dark", (1, 1), MANTLE))),
        size=(0.08, 0.08, 0.3), palette={"body": ("green", "leaf", "maroon", "brown", "blue", "glass", "orange")}, pose="longest up", gloss=0.8,
    ),
    "spray bottle": shape(
        (rod((-0.62, 0.62), (-1, 1), (0, 0.5)), rod((-0.62, 0.62), (-1, 1), (0.5, 0.66), taper=(1, 0.4)), rod((-0.28, 0.28), (-0.44, 0.44), (0.66, 0.78), "dark"),
         box((-1, 0.42), (-0.34, 0.34), (0.84, 1), "trim"), box((-0.2, 0.2), (-0.34, 0.34), (0.76, 0.86), "trim"), box((-0.62, -0.46), (-0.2, 0.2), (0.64, 0.86), "dark", lean=("x", "z", 0.12)),
         box((0.42, 1), (-0.2, 0.2), (0.9, 0.97), "trim"), rod((-0.62, 0.62), (-1, 1), (0.12, 0.42), "paper", Pattern("label", "ink", (1, 1), MANTLE))),
        size=(0.12, 0.08, 0.26), palette={"body": ("blue", "green", "yellow", "pink", "white", "sky", "orange"), "trim": ("white", "red", "blue", "orange")}, gloss=0.5,
    ),
    "bowl": shape(
        (tube((-1, 1), (-1, 1), (0.12, 1), taper=(0.5, 1), hole=0.9), rod((-0.52, 0.52), (-0.52, 0.52), (0, 0.2))),
        (tube((-1, 1), (-1, 1), (0.4, 1), taper=(0.84, 1), hole=0.92), rod((-0.84, 0.84), (-0.84, 0.84), (0.1, 0.42), taper=(0.5, 1)), rod((-0.42, 0.42), (-0.42, 0.42), (0, 0.12))),
        size=(0.2, 0.2, 0.09), finishes=_GLAZED, gloss=0.35,
    ),
    "plate": shape(
        (tube((-1, 1), (-1, 1), (0.2, 1), taper=(0.7, 1), hole=0.94), rod((-0.7, 0.7), (-0.7, 0.7), (0, 0.4), "body", Pattern("rings", "accent", (1, 1.7), TOP))),
        size=(0.26, 0.26, 0.025), palette={"body": ("white", "white", "cream", "blue", "sky", "yellow", "green", "red")}, finishes=("plain", "plain", "bands"), gloss=0.3,
    ),
    "pot": shape(
        (tube((-0.74, 0.74), (-1, 1), (0, 0.78), hole=0.93), rod((-0.76, 0.76), (-1, 1), (0.78, 0.86), "metal", Pattern("rings", "dark", (1, 2), TOP)),
         ball((-0.14, 0.14), (-0.18, 0.18), (0.84, 1), "dark"), mirrored(tube((0.68, 1), (-0.34, 0.34), (0.54, 0.68), "dark", hole=0.6), "x")),
        size=(0.3, 0.22, 0.2), palette={"body": ("steel", "silver", "red", "black", "blue", "orange", "green")}, gloss=0.6,
    ),
    "pan": shape(
        (tube((-1, 0.12), (-1, 1), (0, 0.55), taper=(0.84, 1), hole=0.93), rod((-0.94, 0.06), (-0.9, 0.9), (0, 0.15), "dark"),
         box((0.05, 1), (-0.1, 0.1), (0.5, 0.95), lean=("z", "x", 0.1))),
        size=(0.46, 0.26, 0.06), palette={"body": ("black", "charcoal", "steel", "red", "green")}, gloss=0.4,
    ),
    "kettle": shape(
        (rod((-0.76, 0.6), (-0.95, 0.95), (0, 0.66), taper=(1, 0.7)), rod((-0.52, 0.36), (-0.66, 0.66), (0.66, 0.74), "trim"), ball((-0.2, 0.04), (-0.16, 0.16), (0.72, 0.84), "dark"),
         rod((-0.95, -0.6), (-0.16, 0.16), (0.3, 0.72), lean=("x", "z", -0.05), taper=(1, 0.5)), box((-1, -0.7), (-0.14, 0.14), (0.6, 0.72)), tube((0.4, 1), (-0.12, 0.12), (0.1, 0.6), "dark", axis="y", hole=0.75),
         tube((-0.6, 0.44), (-0.12, 0.12), (0.48, 1), "dark", axis="y", hole=0.82)),
        (rod((-0.7, 0.5), (-0.9, 0.9), (0.08, 0.9), taper=(1, 0.76)), rod((-0.72, 0.52), (-0.95, 0.95), (0, 0.1), "dark"), box((-1, -0.5), (-0.2, 0.2), (0.74, 0.88)), rod((-0.5, 0.3), (-0.6, 0.6), (0.9, 0.94), "dark"),
         ball((-0.2, 0), (-0.15, 0.15), (0.92, 1), "dark"), box((0.4, 1), (-0.14, 0.14), (0.78, 0.9), "dark"), box((0.86, 1), (-0.14, 0.14), (0.2, 0.9), "dark"), box((0.4, 1), (-0.14, 0.14), (0.14, 0.24), "dark")),
        size=(0.24, 0.18, 0.22), palette={"body": ("silver", "steel", "red", "black", "white", "blue", "yellow")}, gloss=0.6,
    ),
    "apple": shape(
        (ball((-1, 1), (-1, 1), (0.04, 0.86)), rod((-0.5, 0.5), (-0.5, 0.5), (0, 0.2), taper=(0.8, 1)), rod((-0.22, 0.22), (-0.22, 0.22), (0.8, 0.862), "trim"), rod((-0.07, 0.07), (-0.07, 0.07), (0.8, 1), "wood", lean=("x", "z", 0.1)),
         ball((0.0, 0.5), (-0.14, 0.14), (0.86, 0.96), "leaf")),
        size=(0.08, 0.08, 0.09), palette={"body": ("red", "red", "brick", "green", "yellow"), "wood": ("walnut",)}, gloss=0.5,
    ),
    "orange": shape(
        (ball((-1, 1), (-1, 1), (0, 1)), ball((-0.14, 0.14), (-0.14, 0.14), (0.94, 1.0), "leaf")),
        size=(0.08, 0.08, 0.08), palette={"body": ("orange",)}, finishes=("leather", "plain"), gloss=0.2,
    ),
    "banana": shape(
        (rod((-0.5, 0.5), (-1, -0.1), (0.0, 0.9), axis="x"), rod((-0.94, -0.44), (-0.72, 0.18), (0.0, 0.9), axis="x", taper=(0.6, 1), lean=("y", "x", -0.28)), rod((0.44, 0.94), (-0.72, 0.18), (0.0, 0.9), axis="x", taper=(1, 0.6), lean=("y", "x", 0.28)),
         rod((-1, -0.84), (0.0, 0.5), (0.3, 0.6), "dark", axis="y"), rod((0.82, 1), (0.2, 1), (0.25, 1), "trim", axis="y", taper=(1, 0.6))),
        size=(0.19, 0.08, 0.04), palette={"body": ("banana", "yellow"), "trim": ("olive",), "dark": ("walnut",)}, pose="lying",
    ),
    "tomato": shape(
        (ball((-1, 1), (-1, 1), (0, 0.92)), ball((-0.5, 0.5), (-0.12, 0.12), (0.84, 0.95), "leaf"), ball((-0.12, 0.12), (-0.5, 0.5), (0.84, 0.95), "leaf"), rod((-0.06, 0.06), (-0.06, 0.06), (0.86, 1), "leaf")),
        size=(0.08, 0.08, 0.065), palette={"body": ("red",), "leaf": ("leaf",)}, gloss=0.6,
    ),
    "bread": shape(
        (box((-0.9, 0.9), (-0.8, 0.8), (0, 0.62), "body"), rod((-0.95, 0.95), (-1, 1), (0.3, 1), axis="x"), rod((-1, -0.94), (-0.9, 0.9), (0.1, 0.9), "paper", axis="x"), rod((0.94, 1), (-0.9, 0.9), (0.1, 0.9), "paper", axis="x")),
        size=(0.26, 0.12, 0.12), palette={"body": ("tan", "oak", "brown"), "paper": ("cream", "beige")}, finishes=("leather",),
    ),
    "egg": shape((ball((-1, 1), (-1, 1), (0, 1)),), size=(0.06, 0.045, 0.045), palette={"body": ("cream", "white", "tan")}, finishes=("plain",)),
    "pear": shape(
        (ball((-1, 1), (-1, 1), (0, 0.62)), ball((-0.6, 0.6), (-0.6, 0.6), (0.34, 0.9)), rod((-0.07, 0.07), (-0.07, 0.07), (0.84, 1), "wood")),
        size=(0.075, 0.075, 0.11), palette={"body": ("green", "olive", "yellow")}, finishes=("plain", "speckle"),
    ),
    "potato": shape((ball((-1, 0.7), (-0.9, 0.9), (0, 0.95)), ball((-0.4, 1), (-1, 0.8), (0.05, 1))), size=(0.11, 0.08, 0.07), palette={"body": ("tan", "beige", "brown")}, finishes=("leather", "speckle")),
    "lettuce": shape(
        (ball((-0.9, 0.9), (-0.9, 0.9), (0, 0.9), "body", Pattern("leather", "accent", (14, 8))), ball((-1, 0.2), (-0.7, 0.7), (0.2, 1), "body", Pattern("leather", "accent", (10, 8))), ball((-0.2, 1), (-0.7, 0.7), (0.1, 0.96), "body", Pattern("leather", "accent", (10, 8))),
         ball((-0.7, 0.7), (-1, 0.2), (0.15, 0.9)), ball((-0.7, 0.7), (-0.2, 1), (0.15, 0.95))),
        size=(0.17, 0.17, 0.15), palette={"body": ("green", "mint", "leaf")},
    ),
    "fork": shape(
        (box((-1, 0.35), (-0.26, 0.26), (0, 0.7)), box((0.3, 0.5), (-1, 1), (0, 0.8)), mirrored(box((0.48, 1), (0.7, 1), (0.1, 1)), "y"), box((0.48, 1), (-0.16, 0.16), (0.1, 1))),
        size=(0.19, 0.026, 0.012), palette={"body": ("silver", "steel", "silver", "red", "black")}, pose="lying", gloss=0.7,
    ),
    "spoon": shape(
        (box((-1, 0.35), (-0.24, 0.24), (0, 0.6)), ball((0.2, 1), (-1, 1), (0, 1))),
        size=(0.18, 0.038, 0.016), palette={"body": ("silver", "steel", "silver", "pine", "black")}, pose="lying", gloss=0.7,
    ),
    "knife": shape(
        (box((-1, -0.1), (-0.8, 0.6), (0, 1), "dark"), ball((-0.5, 1), (-0.7, 0.9), (0.3, 0.7), "metal"), box((-0.2, 0.5), (-1, -0.1), (0.3, 0.7), "metal")),
        size=(0.25, 0.035, 0.015), pose="lying",
    ),
    "toaster": shape(
        (box((-0.94, 0.94), (-0.9, 0.9), (0.08, 0.7)), rod((-0.94, 0.94), (-0.9, 0.9), (0.42, 0.98), axis="x"), box((-0.7, 0.7), (-0.5, -0.16), (0.94, 1), "dark"), box((-0.7, 0.7), (0.16, 0.5), (0.94, 1), "dark"),
         box((0.94, 1), (-0.16, 0.16), (0.5, 0.66), "dark"), box((-1, 1), (-1, 1), (0, 0.1), "dark")),
        size=(0.28, 0.18, 0.2), palette={"body": ("silver", "steel", "red", "cream", "black", "mint")}, gloss=0.5, has_front=True,
    ),
    "microwave": shape(
        (box((-1, 1), (-0.92, 1), (0.04, 1)), box((-0.9, 0.42), (-0.98, -0.9), (0.14, 0.9), "screen", Pattern("frame", "dark", faces=FRONT)), box((0.5, 0.92), (-0.96, -0.9), (0.14, 0.62), "trim", Pattern("keys", "paper", (3, 4), FRONT)),
         box((0.5, 0.92), (-0.96, -0.9), (0.7, 0.88), "ink", Pattern("digits", "glow", faces=FRONT)), rod((0.42, 0.48), (-1, -0.93), (0.16, 0.88), "metal"), mirrored(box((0.7, 0.85), (-0.7, 0.8), (0, 0.04), "dark"), "x")),
        size=(0.5, 0.36, 0.29), palette={"body": ("white", "silver", "black", "steel", "red")}, has_front=True, gloss=0.2,
    ),
    "coffee machine": shape(
        (box((-1, 1), (0.1, 1), (0, 1)), box((-1, 1), (-1, 1), (0.72, 1)), box((-1, 1), (-1, 1), (0, 0.1), "dark"), tube((-0.62, 0.62), (-0.85, 0.1), (0.1, 0.6), "glass", taper=(1, 0.8)),
         rod((-0.52, 0.52), (-0.75, 0.0), (0.12, 0.42), "ink"), box((-0.5, 0.5), (-1.0, -0.94), (0.78, 0.94), "screen", Pattern("digits", "glow", faces=FRONT))),
        size=(0.22, 0.28, 0.34), palette={"body": ("black", "red", "silver", "charcoal", "white")}, has_front=True, gloss=0.2,
    ),
    "salt shaker": shape(
        (rod((-1, 1), (-1, 1), (0, 0.72), taper=(1, 0.72)), rod((-0.74, 0.74), (-0.74, 0.74), (0.72, 0.88), "metal"), ball((-0.74, 0.74), (-0.74, 0.74), (0.76, 1), "metal", Pattern("dots", "ink", (10, 8)))),
        size=(0.05, 0.05, 0.1), palette={"body": ("white", "glass", "black", "red", "oak")}, gloss=0.4,
    ),
    "can": shape(
        (rod((-1, 1), (-1, 1), (0.05, 0.95), "body", Pattern("label", "paper", (1, 1), MANTLE)), rod((-0.94, 0.94), (-0.94, 0.94), (0, 1), "metal", Pattern("rings", "dark", (1, 1.4), TOP))),
        size=(0.066, 0.066, 0.12), palette={"body": ("red", "blue", "green", "orange", "silver", "black", "purple")}, gloss=0.6,
    ),
    "jar": shape(
        (rod((-0.97, 0.97), (-0.97, 0.97), (0, 0.78)), rod((-0.84, 0.84), (-0.84, 0.84), (0.78, 0.84), "glass"), rod((-0.9, 0.9), (-0.9, 0.9), (0.84, 1), "trim"), rod((-1, 1), (-1, 1), (0.2, 0.6), "paper", Pattern("label", "ink", (1, 1), MANTLE))),
        size=(0.08, 0.08, 0.11), palette={"body": ("red", "orange", "brown", "purple", "yellow", "green"), "trim": ("gold", "white", "red", "silver")}, gloss=0.6,
    ),
}  # fmt: skip

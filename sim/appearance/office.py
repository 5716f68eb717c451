"""Shapes of what lies on desks."""

from __future__ import annotations

from sim.appearance.shape import ENDS, FRONT, SIDES, TOP, Pattern, Shape, ball, box, mirrored, rod, shape, tube

_KEYS = Pattern("keys", "trim", (14, 5), TOP)

SHAPES: dict[str, Shape] = {
    "laptop": shape(
        (box((-1, 1), (-1, 0.5), (0, 0.07)), box((-0.9, 0.9), (-0.4, 0.4), (0.06, 0.085), "dark", Pattern("keys", "metal", (13, 5), TOP), gloss=0.0),
         box((-0.26, 0.26), (-0.9, -0.5), (0.06, 0.08), "trim"), box((-1, 1), (0.64, 0.74), (0.06, 1), lean=("y", "z", 0.26)),
         box((-0.92, 0.92), (0.61, 0.66), (0.12, 0.95), "screen", Pattern("screen", "glow", faces=FRONT), lean=("y", "z", 0.23))),
        size=(0.33, 0.25, 0.23), palette={"body": ("silver", "grey", "black", "charcoal", "white", "blue")}, has_front=True,
    ),
    "computer monitor": shape(
        (box((-1, 1), (-0.3, 0.2), (0.28, 1)), box((-0.94, 0.94), (-0.4, -0.28), (0.34, 0.96), "screen", Pattern("screen", "glow", faces=FRONT)),
         box((-0.12, 0.12), (0, 0.3), (0.05, 0.5), "trim"), box((-0.4, 0.4), (-1, 1), (0, 0.05), "trim")),
        size=(0.52, 0.2, 0.42), palette={"body": ("black", "charcoal", "silver", "white")}, has_front=True,
    ),
    "tv": shape(
        (box((-1, 1), (-0.3, 0.2), (0.1, 1)), box((-0.96, 0.96), (-0.4, -0.28), (0.15, 0.97), "screen", Pattern("picture", "glow", faces=FRONT)),
         mirrored(box((0.5, 0.66), (-1, 1), (0, 0.05), "trim"), "x"), mirrored(box((0.55, 0.61), (-0.2, 0.2), (0.04, 0.12), "trim"), "x")),
        (box((-1, 1), (-0.3, 0.2), (0.12, 1)), box((-0.96, 0.96), (-0.4, -0.28), (0.16, 0.97), "screen"),
         box((-0.14, 0.14), (-0.2, 0.2), (0.04, 0.14)), box((-0.5, 0.5), (-1, 1), (0, 0.05))),
        size=(1.05, 0.22, 0.64), palette={"body": ("black", "charcoal", "black", "silver"), "glow": ("sky", "teal", "orange")}, has_front=True,
    ),
    "keyboard": shape(
        (box((-1, 1), (-1, 1), (0, 0.6)), box((-0.96, 0.7), (-0.86, 0.86), (0.5, 1), "dark", Pattern("keys", "fabric", (15, 5), TOP)),
         box((0.74, 0.97), (-0.86, 0.86), (0.5, 1), "dark", Pattern("keys", "fabric", (3, 5), TOP))),
        size=(0.44, 0.14, 0.025), palette={"body": ("black", "grey", "white", "charcoal"), "fabric": ("white", "grey", "silver")}, pose="lying",
    ),
    "mouse": shape(
        (ball((-1, 1), (-1, 1), (-0.7, 1)), box((-0.95, -0.1), (-0.03, 0.03), (0.62, 0.86), "dark"), rod((-0.6, -0.3), (-0.12, 0.12), (0.6, 1), "dark", axis="y")),
        size=(0.11, 0.065, 0.038), palette={"body": ("black", "grey", "white", "red", "blue")}, gloss=0.3, pose="lying",
    ),
    "cell phone": shape(
        (box((-1, 1), (-1, 1), (0, 0.92)), box((-0.93, 0.93), (-0.88, 0.88), (0.9, 1), "screen", Pattern("grid", "glow", (6, 4), TOP)), box((0.95, 0.98), (-0.2, 0.2), (0.9, 1), "trim")),
        (box((-1, 1), (-1, 1), (0, 0.92)), box((-0.96, 0.96), (-0.92, 0.92), (0.9, 1), "screen", Pattern("screen", "glow", faces=TOP)), rod((0.86, 0.94), (-0.08, 0.08), (0.9, 1), "dark")),
        size=(0.15, 0.075, 0.01), palette={"body": ("black", "silver", "white", "gold", "red", "blue", "pink")}, pose="lying", gloss=0.3,
    ),
    "remote control": shape(
        (box((-1, 1), (-1, 1), (0, 0.85)), box((-0.5, 0.7), (-0.72, 0.72), (0.8, 1), "body", Pattern("keys", "paper", (6, 3), TOP)), rod((-0.86, -0.6), (-0.55, 0.55), (0.8, 1), "metal"),
         rod((0.8, 0.94), (0.3, 0.8), (0.8, 1), "trim")),
        (box((-0.86, 0.86), (-0.8, 0.8), (0, 0.85)), mirrored(rod((0.72, 1), (-0.8, 0.8), (0, 0.85)), "x"), box((-0.6, 0.84), (-0.66, 0.66), (0.8, 1), "body", Pattern("dots", "paper", (7, 3), TOP)),
         rod((-0.92, -0.64), (-0.55, 0.55), (0.8, 1), "glow"), mirrored(box((-0.8, 0.8), (0.78, 1), (0.05, 0.6)), "y")),
        size=(0.19, 0.05, 0.022), palette={"body": ("black", "charcoal", "grey", "white"), "trim": ("red",)}, pose="lying",
    ),
    "alarm clock": shape(
        (rod((-0.86, 0.86), (-0.6, 0.7), (0.1, 0.84), axis="y"), rod((-0.74, 0.74), (-0.68, -0.58), (0.15, 0.79), "paper", Pattern("clock", "ink", faces=ENDS), axis="y"),
         mirrored(ball((0.2, 0.86), (-0.4, 0.5), (0.72, 1), "metal"), "x"), box((-0.05, 0.05), (-0.1, 0.2), (0.82, 0.98), "metal"), mirrored(rod((0.4, 0.7), (-0.4, 0.5), (0, 0.26), "dark", lean=("x", "z", -0.08)), "x"),
         box((-0.1, 0.1), (-1, -0.66), (0.465, 0.475), "ink"), mirrored(box((0.9, 1), (-0.1, 0.2), (0.5, 0.54), "metal"), "x"), box((-0.1, 0.1), (0.7, 1), (0.4, 0.5), "dark")),
        (box((-1, 1), (-0.9, 1), (0, 0.94)), box((-0.88, 0.88), (-1, -0.86), (0.14, 0.82), "ink", Pattern("digits", "light", faces=FRONT)), box((-0.4, 0.4), (-0.3, 0.3), (0.92, 1), "trim")),
        size=(0.15, 0.09, 0.14), palette={"body": ("black", "white", "red", "blue", "silver", "green", "pink"), "light": ("red", "mint", "orange", "glow")}, has_front=True, gloss=0.2,
    ),
    "watch": shape(
        (mirrored(box((0.3, 1), (-0.5, 0.5), (0, 0.3)), "x"), rod((-0.46, 0.46), (-0.9, 0.9), (0.0, 0.9), "metal"), rod((-0.38, 0.38), (-0.76, 0.76), (0.9, 1), "paper", Pattern("clock", "ink", faces=TOP)),
         box((-0.06, 0.06), (0.86, 1), (0.3, 0.7), "metal"), box((0.84, 0.94), (-0.56, 0.56), (0.0, 0.4), "metal"), box((-0.06, 0.06), (-1, -0.86), (0.3, 0.6), "metal")),
        (tube((-1, 1), (-0.5, 0.5), (0, 0.94), axis="y", hole=0.86), rod((-0.6, 0.6), (-1, 1), (0.84, 0.97), "metal"), rod((-0.5, 0.5), (-0.84, 0.84), (0.97, 1), "paper", Pattern("clock", "ink", faces=TOP))),
        size=(0.09, 0.055, 0.035), palette={"body": ("black", "brown", "tan", "silver", "red", "blue")}, gloss=0.2,
    ),
    "book": shape(
        (box((-1, 1), (-1, 1), (0.86, 1), "body", Pattern("frame", "accent", faces=TOP)), box((-1, 1), (-1, 1), (0, 0.14)), box((-1, 1), (0.9, 1), (0, 1)), box((-0.95, 0.95), (-0.95, 0.92), (0.14, 0.86), "paper", Pattern("bands", "fabric", (1, 6), SIDES | FRONT)),
         box((-0.5, 0.5), (0.1, 0.5), (0.98, 1.0), "accent")),
        (box((-1, 1), (-1, 1), (0.84, 1), "body", Pattern("text", "accent", (1, 5), TOP)), box((-1, 1), (-1, 1), (0, 0.16)), box((-1, 1), (0.9, 1), (0, 1)), box((-0.95, 0.95), (-0.95, 0.92), (0.16, 0.84), "paper", Pattern("bands", "fabric", (1, 6), SIDES | FRONT))),
        (box((-1, 1), (-1, 1), (0.86, 1)), box((-1, 1), (-1, 1), (0, 0.14)), box((-1, 1), (0.9, 1), (0, 1), "trim"), box((-0.95, 0.95), (-0.95, 0.92), (0.14, 0.86), "paper", Pattern("bands", "fabric", (1, 6), SIDES | FRONT)),
         box((-0.7, 0.3), (-0.5, 0.6), (0.98, 1), "accent", Pattern("picture", "trim", faces=TOP))),
        size=(0.22, 0.16, 0.035), palette={"body": ("red", "blue", "green", "navy", "maroon", "brown", "yellow", "purple", "black", "orange", "teal"), "accent": ("cream", "white")}, pose="lying",
    ),
    "newspaper": shape(
        (box((-1, 1), (-1, 1), (0, 0.5), "body", Pattern("page", "ink", (1, 22), TOP)), box((-0.98, 0.97), (-0.03, 0.98), (0.5, 1), "body", Pattern("page", "ink", (1, 14), TOP))),
        (box((-1, 1), (-1, 1), (0, 1), "body", Pattern("page", "ink", (1, 24), TOP)),),
        size=(0.4, 0.3, 0.02), palette={"body": ("paper", "paper", "white", "beige")}, pose="lying",
    ),
    "pen": shape(
        (rod((-0.72, 0.6), (-1, 1), (0, 1), axis="x"), rod((-1, -0.72), (-0.9, 0.9), (0.05, 0.95), "metal", axis="x", taper=(0.1, 1)), rod((0.6, 0.92), (-1, 1), (0, 1), "trim", axis="x"), rod((0.92, 1), (-0.5, 0.5), (0.25, 0.75), "metal", axis="x"), box((0.2, 0.9), (-0.2, 0.2), (0.95, 1), "metal")),
        size=(0.15, 0.012, 0.012), palette={"body": ("blue", "black", "red", "green", "white")}, pose="lying", gloss=0.3,
    ),
    "pencil": shape(
        (rod((-0.78, 0.78), (-1, 1), (0, 1), axis="x"), rod((-0.94, -0.78), (-1, 1), (0, 1), "wood", axis="x", taper=(0.3, 1)), rod((-1, -0.94), (-0.3, 0.3), (0.35, 0.65), "ink", axis="x", taper=(0.1, 1)),
         rod((0.78, 0.88), (-1, 1), (0, 1), "metal", axis="x"), rod((0.88, 1), (-0.95, 0.95), (0.03, 0.97), "glow", axis="x")),
        size=(0.18, 0.01, 0.01), palette={"body": ("yellow", "yellow", "orange", "red", "green"), "wood": ("pine",), "glow": ("pink", "salmon")}, pose="lying",
    ),
    "credit card": shape(
        (box((-1, 1), (-1, 1), (0, 1), "body", Pattern("strip", "dark", faces=TOP)),),
        (box((-1, 1), (-1, 1), (0, 1), "body", Pattern("strip", "metal", faces=TOP)),),
        size=(0.086, 0.054, 0.002), palette={"body": ("blue", "navy", "gold", "red", "silver", "green", "purple", "teal")}, pose="lying", gloss=0.3,
    ),
    "cd": shape(
        (tube((-1, 1), (-1, 1), (0, 0.9), "body", Pattern("rays", "accent", faces=0b110000), hole=0.36), tube((-0.36, 0.36), (-0.36, 0.36), (0, 1), "glass", hole=0.4)),
        size=(0.12, 0.12, 0.004), palette={"body": ("silver", "silver", "steel"), "accent": ("sky", "lilac", "mint")}, pose="lying", gloss=0.6,
    ),
    "wallet": shape(
        (box((-1, 1), (-0.9, 0.6), (0, 0.4)), box((-1, 1), (-0.9, 0.6), (0.56, 0.9)), rod((-1, 1), (0.2, 1), (0, 0.9), axis="x"), rod((-1, 1), (-1, -0.8), (0, 0.4), axis="x"), rod((-1, 1), (-1, -0.8), (0.56, 0.9), axis="x"),
         box((-0.9, 0.9), (-0.86, 0.6), (0.4, 0.56), "dark"), box((-0.8, 0.5), (-0.98, 0.6), (0.44, 0.52), "leaf"), box((-0.28, 0.28), (-0.94, 0.9), (0.86, 0.97), "trim"), box((-0.28, 0.28), (-1, -0.92), (0.1, 0.97), "trim"), rod((-0.16, 0.16), (-0.8, -0.5), (0.94, 1), "metal")),
        (box((-1, 1), (-0.9, 0.6), (0, 0.4)), box((-1, 1), (-0.9, 0.6), (0.6, 0.96)), rod((-1, 1), (0.2, 1), (0, 0.96), axis="x"), box((-0.94, 0.94), (-0.86, 0.6), (0.4, 0.6), "dark"), box((-0.86, 0.9), (-1, 0.6), (0.4, 0.47), "leaf"), box((-0.7, 0.4), (-0.97, 0.6), (0.5, 0.57), "paper"),
         box((-0.8, 0.8), (-0.7, -0.62), (0.95, 1), "trim"), box((-0.8, 0.8), (-0.3, -0.22), (0.95, 1), "trim"), box((-0.8, -0.72), (-0.7, 0.4), (0.95, 1), "trim"), box((0.72, 0.8), (-0.7, 0.4), (0.95, 1), "trim")),
        size=(0.11, 0.09, 0.028), palette={"body": ("brown", "black", "tan", "red", "maroon", "navy", "green")}, finishes=("leather", "plain"), pose="lying",
    ),
    "key chain": shape(
        (tube((-1, -0.3), (-0.56, 0.56), (0.3, 0.7), "metal", hole=0.8), tube((-0.42, 0.1), (0.2, 1), (0.2, 0.6), "body", hole=0.4), box((0.0, 1), (0.5, 0.68), (0.25, 0.55)), box((0.6, 0.72), (0.3, 0.55), (0.25, 0.55)), box((0.84, 0.96), (0.24, 0.55), (0.25, 0.55)),
         tube((-0.42, 0.1), (-0.9, -0.1), (0.4, 0.8), "metal", hole=0.4), box((0.0, 0.9), (-0.58, -0.42), (0.45, 0.75), "metal"), box((0.66, 0.78), (-0.8, -0.5), (0.45, 0.75), "metal"), box((-0.9, -0.6), (-1, -0.4), (0, 1), "trim")),
        size=(0.1, 0.06, 0.014), palette={"body": ("brass", "silver", "gold", "steel"), "trim": ("red", "blue", "black", "green")}, pose="lying", gloss=0.6,
    ),
    "scissors": shape(
        (tube((-1, -0.36), (0.1, 1), (0.1, 0.9), hole=0.66), tube((-1, -0.36), (-1, -0.1), (0.1, 0.9), hole=0.66), box((-0.4, 1), (-0.14, 0.14), (0.2, 0.5), "metal", lean=("y", "x", -0.4)), box((-0.4, 1), (-0.14, 0.14), (0.5, 0.8), "metal", lean=("y", "x", 0.4)), rod((0.1, 0.24), (-0.18, 0.18), (0, 1), "dark")),
        size=(0.18, 0.08, 0.012), palette={"body": ("red", "black", "orange", "blue", "green")}, pose="lying",
    ),
    "glasses": shape(
        (mirrored(tube((0.1, 0.96), (-1, -0.9), (0, 1), axis="y", hole=0.84), "x"), box((-0.12, 0.12), (-1, -0.9), (0.62, 0.74)), mirrored(box((0.94, 1), (-1, 1), (0.7, 0.82)), "x"), mirrored(rod((0.18, 0.88), (-0.96, -0.94), (0.1, 0.9), "glass", axis="y"), "x")),
        size=(0.14, 0.14, 0.045), palette={"body": ("black", "brown", "red", "gold", "blue")}, has_front=True,
    ),
    "desk lamp": shape(
        (rod((-0.3, 0.9), (-0.6, 0.6), (0, 0.06)), box((0.24, 0.36), (-0.08, 0.08), (0.05, 0.62), "metal", lean=("x", "z", 0.3)), box((-0.05, 0.06), (-0.08, 0.08), (0.6, 0.94), "metal", lean=("x", "z", -0.6)),
         tube((-1, -0.2), (-1, 1), (0.66, 0.92), taper=(1, 0.34), hole=0.9), ball((-0.75, -0.45), (-0.3, 0.3), (0.68, 0.8), "light"), box((0.5, 0.62), (-0.08, 0.08), (0.56, 0.66), "metal"), rod((-0.1, 0.1), (-0.1, 0.1), (0.06, 0.09), "dark"), box((0.9, 1), (-0.04, 0.04), (0, 0.03), "dark"), box((-0.62, -0.54), (-0.08, 0.08), (0.9, 1), "metal")),
        (rod((-0.56, 0.56), (-0.56, 0.56), (0, 0.06), "trim"), ball((-0.4, 0.4), (-0.4, 0.4), (0.05, 0.5), "trim"), rod((-0.08, 0.08), (-0.08, 0.08), (0.4, 0.6), "metal"), tube((-1, 1), (-1, 1), (0.5, 1), taper=(1, 0.6), hole=0.93), ball((-0.2, 0.2), (-0.2, 0.2), (0.6, 0.8), "light")),
        size=(0.3, 0.2, 0.45), palette={"body": ("white", "black", "red", "blue", "cream", "green", "orange", "silver")},
    ),
    "printer": shape(
        (box((-1, 1), (-0.6, 0.8), (0.1, 0.8)), box((-0.8, 0.8), (-1, -0.6), (0.16, 0.22), "trim"), box((-0.66, 0.66), (-0.96, -0.5), (0.22, 0.25), "paper"), box((-0.7, 0.7), (0.6, 0.75), (0.7, 1), "paper", lean=("y", "z", 0.22)), box((-1, 1), (-0.6, 0.8), (0, 0.12), "trim"),
         box((0.4, 0.85), (-0.64, -0.58), (0.5, 0.7), "screen", Pattern("screen", "glow", faces=FRONT)), box((-0.8, 0.8), (-0.64, -0.58), (0.26, 0.4), "dark"), box((-0.4, 0.4), (0.8, 1), (0.2, 0.4))),
        size=(0.42, 0.36, 0.28), palette={"body": ("white", "grey", "black", "charcoal")}, has_front=True,
    ),
    "stapler": shape(
        (box((-1, 1), (-1, 1), (0, 0.18), "dark"), box((-0.95, 1), (-0.8, 0.8), (0.55, 0.85), lean=("z", "x", -0.15)), box((0.5, 0.95), (-0.9, 0.9), (0.15, 0.6)), box((-0.95, 0.8), (-0.6, 0.6), (0.42, 0.55), "metal", lean=("z", "x", -0.12)), box((-0.6, 0.4), (-0.7, 0.7), (0.84, 1))),
        size=(0.13, 0.035, 0.05), palette={"body": ("black", "red", "blue", "grey")}, gloss=0.3,
    ),
    "globe": shape(
        (ball((-0.84, 0.84), (-0.84, 0.84), (0.2, 0.96), "body", Pattern("marble", "leaf", (5, 3))), rod((-0.6, 0.6), (-0.6, 0.6), (0, 0.06), "wood"), rod((-0.1, 0.1), (-0.1, 0.1), (0.05, 0.24), "wood"), tube((-1, 1), (-0.08, 0.08), (0.14, 1), "metal", axis="y", hole=0.92), mirrored(ball((-0.1, 0.1), (0.9, 1), (0.55, 0.6), "metal"), "y")),
        size=(0.3, 0.3, 0.38), palette={"body": ("blue", "sky", "teal")}, gloss=0.3,
    ),
    "pencil cup": shape(
        (tube((-1, 1), (-1, 1), (0, 0.6), "body", hole=0.9), *(rod((x - 0.1, x + 0.1), (y - 0.1, y + 0.1), (0.05, top), slot, lean=("x", "z", lean)) for x, y, top, slot, lean in ((0.2, 0.2, 1.0, "glow", 0.3), (-0.3, 0.1, 0.94, "light", -0.3), (0.0, -0.3, 0.9, "leaf", 0.1), (-0.1, 0.4, 0.97, "wood", -0.1)))),
        size=(0.09, 0.09, 0.18), finishes=("plain", "grid"), palette={"light": ("yellow", "red")},
    ),
}  # fmt: skip

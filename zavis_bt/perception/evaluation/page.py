"""Pieces of the report's page."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from html import escape
from io import BytesIO

from PIL import Image

STYLE = """
:root { --ink: #1a2230; --faint: #667085; --line: #dfe3ea; --known: #2463c4; }
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); max-width: 1220px; margin: 24px auto;
  padding: 0 16px; }
h1 { font-size: 26px; margin: 0 0 8px; } h2 { font-size: 19px; margin: 32px 0 8px; }
p { margin: 6px 0; color: var(--faint); }
.statement { color: #7a4b00; background: #fff4dc; border-left: 4px solid #e2a100; padding: 8px 12px; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(160px, 1fr)); gap: 10px; margin: 16px 0; }
.figures div { border: 1px solid var(--line); border-radius: 6px; padding: 10px 12px; }
.figures b { font-size: 26px; display: block; line-height: 1.1; font-variant-numeric: tabular-nums; }
.figures span { font-weight: 600; } .figures small { display: block; color: var(--faint); }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(340px, 1fr)); gap: 24px; margin-top: 20px; }
figure { margin: 0; } figcaption { color: var(--faint); } img { max-width: 100%; height: auto; display: block; }
svg { width: 100%; height: auto; font: 11px system-ui, sans-serif; } svg text { fill: var(--ink); }
svg .faint { fill: var(--faint); font-size: 9px; } svg .grid { stroke: var(--line); } svg .bar { fill: var(--known); }
table { border-collapse: collapse; } td, th { padding: 3px 14px 3px 0; text-align: left; vertical-align: top; }
.facts td:first-child { color: var(--faint); } .facts td { overflow-wrap: anywhere; }
.classes td, .classes th { border-bottom: 1px solid var(--line); font-variant-numeric: tabular-nums; }
.meter { display: inline-block; height: 9px; background: var(--known); margin-right: 8px; border-radius: 2px; }
"""


def as_image(picture: Image.Image, text: str) -> str:
    """Return a picture as an element that holds its data."""
    file = BytesIO()
    picture.save(file, "JPEG", quality=88)
    data = base64.b64encode(file.getvalue()).decode()
    size = f'width="{picture.width}" height="{picture.height}"'
    return f'<img alt="{escape(text)}" {size} src="data:image/jpeg;base64,{data}">'


def figure(svg: str, caption: str) -> str:
    """Return a chart with a line of text below it."""
    return f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>"


def rows_of(pairs: Sequence[tuple[str, str]]) -> str:
    """Return rows of names and values."""
    return "".join(f"<tr><td>{escape(name)}<td>{escape(value)}</tr>" for name, value in pairs)


def cell(share: float) -> str:
    """Return a cell with a number from 0 to 1 and a bar of that length."""
    if not math.isfinite(share):
        return "<td>–"
    return f'<td><span class="meter" style="width: {120 * share:.0f}px"></span>{share:.3f}'

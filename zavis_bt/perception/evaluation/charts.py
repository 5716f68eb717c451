"""Curves and bars as SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from zavis_bt.types import FloatArray

_WIDTH, _HEIGHT = 440.0, 270.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 44.0, 12.0, 12.0, 46.0


@dataclass(frozen=True, slots=True)
class Curve:
    """A line in a chart; both axes run from 0 to 1."""

    name: str
    x: FloatArray
    y: FloatArray
    colour: str


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar in a chart, from 0 to 1; NaN for none."""

    name: str
    value: float
    note: str = ""


def curve_chart(curves: Sequence[Curve], x_title: str, y_title: str) -> str:
    """Return a chart of curves with a legend, as SVG."""
    parts = [_grid(), _axis_titles(x_title, y_title)]
    parts += [_text(_x(k / 5), _HEIGHT - _BOTTOM + 16, f"{k / 5:g}", "middle") for k in range(6)]
    for k, curve in enumerate(curves):
        points = " ".join(f"{_x(a):.1f},{_y(b):.1f}" for a, b in zip(curve.x, curve.y, strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{curve.colour}" stroke-width="2"/>')
        y = _TOP + 14 + 16 * k
        parts.append(f'<rect x="{_WIDTH - 156:g}" y="{y - 8:g}" width="12" height="4" fill="{curve.colour}"/>')
        parts.append(_text(_WIDTH - 138, y, curve.name, "start"))
    return _svg(parts, f"{y_title} by {x_title}")


def bar_chart(bars: Sequence[Bar], x_title: str, y_title: str) -> str:
    """Return a chart of bars with their values above and their notes below, as SVG."""
    parts = [_grid(), _axis_titles(x_title, y_title)]
    step = (_WIDTH - _LEFT - _RIGHT) / max(len(bars), 1)
    for k, bar in enumerate(bars):
        middle = _LEFT + (k + 0.5) * step
        if math.isfinite(bar.value):
            top = _y(bar.value)
            size = f'width="{0.72 * step:.1f}" height="{_y(0) - top:.1f}"'
            parts.append(f'<rect class="bar" x="{middle - 0.36 * step:.1f}" y="{top:.1f}" {size}/>')
            parts.append(_text(middle, top - 4, f"{bar.value:.2f}".removeprefix("0"), "middle"))
        parts.append(_text(middle, _HEIGHT - _BOTTOM + 14, bar.name, "middle"))
        parts.append(_text(middle, _HEIGHT - _BOTTOM + 26, bar.note, "middle", "faint"))
    return _svg(parts, f"{y_title} by {x_title}")


def _grid() -> str:
    lines = []
    for k in range(6):
        y = _y(k / 5)
        lines.append(f'<line class="grid" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>')
        lines.append(_text(_LEFT - 6, y + 4, f"{k / 5:g}", "end"))
    return "".join(lines)


def _axis_titles(x_title: str, y_title: str) -> str:
    middle = (_TOP + _HEIGHT - _BOTTOM) / 2
    turned = f'text-anchor="middle" transform="rotate(-90 12 {middle:g})"'
    below = _text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 4, x_title, "middle")
    return f'{below}<text x="12" y="{middle:g}" {turned}>{escape(y_title)}</text>'


def _text(x: float, y: float, text: str, anchor: str, kind: str = "") -> str:
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _svg(parts: Sequence[str], label: str) -> str:
    inside = "".join(parts)
    return f'<svg viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" role="img" aria-label="{escape(label)}">{inside}</svg>'


def _x(value: float) -> float:
    return _LEFT + float(value) * (_WIDTH - _LEFT - _RIGHT)


def _y(value: float) -> float:
    return _HEIGHT - _BOTTOM - float(value) * (_HEIGHT - _TOP - _BOTTOM)

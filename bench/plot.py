"""A small plot as SVG: both axes are logarithmic, so that what grows linearly is a line of slope one."""

from __future__ import annotations

import math
from collections.abc import Mapping

_WIDTH = 560
_HEIGHT = 320
_LEFT = 56
_RIGHT = 16
_TOP = 34
_BOTTOM = 40
_FONT = 'font-family="sans-serif" font-size="12"'
_COLORS = ("#1565c0", "#e65100")


def plot(title: str, across: str, unit: str, series: Mapping[str, Mapping[int, float]]) -> str:
    """Return the SVG of some series of numbers above counts."""
    xs = [x for points in series.values() for x in points]
    ys = [y for points in series.values() for y in points.values()]
    low_x, high_x = _decades(xs)
    low_y, high_y = _decades(ys)

    def place(x: float, y: float) -> tuple[float, float]:
        right = (math.log10(x) - low_x) / (high_x - low_x) * (_WIDTH - _LEFT - _RIGHT)
        up = (math.log10(y) - low_y) / (high_y - low_y) * (_HEIGHT - _TOP - _BOTTOM)
        return round(_LEFT + right, 1), round(_HEIGHT - _BOTTOM - up, 1)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" {_FONT}>',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="white"/>',
        f'<text x="{_LEFT}" y="18" font-size="14">{title}</text>',
    ]
    for power in range(low_x, high_x + 1):
        x, bottom = place(10.0**power, 10.0**low_y)
        out.append(f'<path d="M{x} {bottom}V{_TOP}" stroke="#ddd"/>')
        out.append(f'<text x="{x}" y="{bottom + 16}" text-anchor="middle">{10**power:,}</text>')
    for power in range(low_y, high_y + 1):
        left, y = place(10.0**low_x, 10.0**power)
        out.append(f'<path d="M{left} {y}H{_WIDTH - _RIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{left - 6}" y="{y + 4}" text-anchor="end">{10.0**power:g} {unit}</text>')
    out.append(f'<text x="{_WIDTH - _RIGHT}" y="{_HEIGHT - 6}" text-anchor="end">{across}</text>')
    for number, (name, points) in enumerate(series.items()):
        color = _COLORS[number % len(_COLORS)]
        found = [place(x, y) for x, y in sorted(points.items())]
        line = " ".join(f"{x},{y}" for x, y in found)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>')
        out += [f'<circle cx="{x}" cy="{y}" r="3" fill="{color}"/>' for x, y in found]
        out.append(f'<text x="{_LEFT + 10}" y="{_TOP + 16 + 16 * number}" fill="{color}">{name}</text>')
    return "\n".join([*out, "</svg>", ""])


def _decades(numbers: list[float] | list[int]) -> tuple[int, int]:
    low = math.floor(math.log10(min(numbers)))
    high = math.ceil(math.log10(max(numbers)))
    return low, max(high, low + 1)

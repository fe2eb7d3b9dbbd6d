"""Names in a picture, pushed apart: no name covers another one. The page of `view` does the same."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

Box = tuple[float, float, float, float]
"""Left, top, right and bottom in pixels from the upper left corner."""

_WAYS = 16
_RINGS = 24
_GAP = 2.0


def pushed_apart(points: Sequence[tuple[float, float]], sizes: Sequence[tuple[float, float]], room: Box) -> list[Box]:
    """Return a box for each point with the size of its name: near the point, in the room, and apart from all others.

    If the room is too small for all names, the last ones cover as little as possible.
    """
    placed: list[Box] = []
    for point, size in zip(points, sizes, strict=True):
        least: tuple[float, Box] | None = None
        for box in _places(point, size, room):
            covered = sum(_common(box, other) for other in placed)
            if least is None or covered < least[0]:
                least = covered, box
            if covered == 0:
                break
        assert least is not None
        placed.append(least[1])
    return placed


def _places(point: tuple[float, float], size: tuple[float, float], room: Box) -> Iterator[Box]:
    """Yield the boxes around a point, the nearest first, on larger and larger rings."""
    width, height = size
    for ring in range(_RINGS):
        for way in range(_WAYS):
            angle = 2 * math.pi * way / _WAYS - math.pi / 2
            x = point[0] + math.cos(angle) * (width / 2 + height * (0.5 + ring))
            y = point[1] + math.sin(angle) * height * (1.2 + ring)
            left = min(max(x - width / 2, room[0]), max(room[0], room[2] - width))
            top = min(max(y - height / 2, room[1]), max(room[1], room[3] - height))
            yield left, top, left + width, top + height


def _common(a: Box, b: Box) -> float:
    """Return the area that two boxes have in common, with a gap between them."""
    width = min(a[2], b[2]) - max(a[0], b[0]) + _GAP
    height = min(a[3], b[3]) - max(a[1], b[1]) + _GAP
    return width * height if width > 0 and height > 0 else 0.0


def projection(scene: Any, width: int, height: int) -> Callable[[Any], tuple[float, float] | None]:
    """Return where a picture of a scene shows a point of the world, in pixels; None for a point that it does not show.

    MuJoCo draws from the middle between the two eyes of its camera.
    """
    eyes = scene.camera
    place, ahead, up = (
        np.mean([getattr(eye, name) for eye in eyes], axis=0, dtype=float) for name in ("pos", "forward", "up")
    )
    lens = eyes[0]
    right = np.cross(ahead, up)
    tall = float(lens.frustum_top - lens.frustum_bottom)
    half = float(lens.frustum_width) or 0.5 * tall * width / height

    def shown(point: Any) -> tuple[float, float] | None:
        away = np.asarray(point) - place
        depth = float(away @ ahead)
        if depth <= lens.frustum_near:
            return None
        scale = 1.0 if lens.orthographic else lens.frustum_near / depth
        x = 0.5 + 0.5 * (float(away @ right) * scale - lens.frustum_center) / half
        y = 1 - (float(away @ up) * scale - lens.frustum_bottom) / tall
        return (x * width, y * height) if 0 <= x <= 1 and 0 <= y <= 1 else None

    return shown


def draw_line(picture: Any, start: tuple[float, float], end: tuple[float, float], color: Sequence[int]) -> None:
    """Draw a line, one pixel wide, into an array of bytes `(height, width, channels)`."""
    count = int(max(abs(end[0] - start[0]), abs(end[1] - start[1]))) + 1
    columns, rows = (np.rint(np.linspace(start[k], end[k], count)).astype(int) for k in (0, 1))
    inside = (columns >= 0) & (columns < picture.shape[1]) & (rows >= 0) & (rows < picture.shape[0])
    picture[rows[inside], columns[inside]] = [*color, 255][: picture.shape[2]]

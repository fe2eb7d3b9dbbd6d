"""The heights of a terrain from its numbers and its seed: the same bytes on every machine.

Only sums, products, quotients and square roots are used, which IEEE 754 rounds the same way everywhere; the sine of a
C library is not. The random numbers are of SHAKE-256, because NumPy may change its own in any version.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base import array_math
from mjcompose.base.dataclass import Struct

Heights = NDArray[np.float64]
_VERSION = "mjcompose terrain 1"
_DIGITS = 6
"""Heights are whole micrometers."""


class GroundKind(Struct):
    """A kind of ground, and its numbers by key; two numbers are the values at the difficulties 0 and 1."""

    kind: str
    settings: Mapping[str, Any]


class TerrainLayout(Struct):
    """The numbers of a terrain: lengths in meters, `cells` along x and y of a patch, `shape` of all heights.

    There is a ground for each column of patches, and a difficulty for each row.
    """

    grounds: Sequence[GroundKind]
    levels: Sequence[float]
    size: Sequence[float]
    cell: float
    border: float
    seed: int
    cells: tuple[int, int]
    shape: tuple[int, int]


class Patch(Struct):
    """The places of one patch, in meters from its center, and the facts that decide its random numbers."""

    x: Heights
    y: Heights
    cell: float
    difficulty: float
    identity: tuple[Any, ...]

    def random(self, rows: int, columns: int, word: str = "") -> Heights:
        """Return random numbers between 0 and 1."""
        key = json.dumps([_VERSION, *self.identity, word], separators=(",", ":")).encode("ascii")
        stream = hashlib.shake_256(key).digest(8 * rows * columns)
        numbers = array_math.fraction(np.frombuffer(stream, ">u8").astype(np.uint64))
        return numbers.reshape(rows, columns)

    def at(self, ends: tuple[float, ...]) -> float:
        """Return the value at the difficulty."""
        return ends[0] + self.difficulty * (ends[-1] - ends[0])

    @property
    def distance(self) -> Heights:
        """The distance from the center, with squares as lines of equal distance."""
        return np.maximum(np.abs(self.x), np.abs(self.y))

    def squares(self, side: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the row and the column of the square that each place is in."""
        # Half a cell further, no place is on the edge of a square whose side is some cells.
        column = np.floor((self.x - self.x.min() + self.cell / 2) / side).astype(np.int64)
        row = np.floor((self.y - self.y.min() + self.cell / 2) / side).astype(np.int64)
        return row, column

    def is_on(self, side: float) -> NDArray[np.bool_]:
        """Return which places are on the square with that side in the middle."""
        return np.asarray(self.distance < side / 2 + self.cell / 2)


def _noise(patch: Patch, scale: float, word: str) -> Heights:
    """Return smooth random numbers between 0 and 1, with bumps of a length."""
    along_x = (patch.x[0] - patch.x[0, 0]) / scale
    along_y = (patch.y[:, 0] - patch.y[0, 0]) / scale
    values = patch.random(int(along_y[-1]) + 2, int(along_x[-1]) + 2, word)
    column = along_x.astype(np.int64)
    row = along_y.astype(np.int64)
    right = along_x - column
    above = along_y - row
    right = right * right * (3.0 - 2.0 * right)
    above = (above * above * (3.0 - 2.0 * above))[:, None]
    lower = values[np.ix_(row, column)] * (1.0 - right) + values[np.ix_(row, column + 1)] * right
    upper = values[np.ix_(row + 1, column)] * (1.0 - right) + values[np.ix_(row + 1, column + 1)] * right
    return np.asarray(lower * (1.0 - above) + upper * above)


def _rough(patch: Patch, height: tuple[float, ...], scale: float, octaves: int) -> Heights:
    shares = [0.5**octave for octave in range(octaves)]
    bumps = sum(_noise(patch, scale * share, f"octave {at}") * share for at, share in enumerate(shares))
    return np.asarray(patch.at(height) * bumps / sum(shares))


def _stairs(patch: Patch, rise: tuple[float, ...], tread: float, platform: float, down: bool) -> Heights:
    outside = np.maximum(patch.distance - platform / 2 - patch.cell / 2, 0.0)
    steps = np.ceil(outside / tread)
    return (steps if down else steps.max() - steps) * patch.at(rise)


def _slope(patch: Patch, incline: tuple[float, ...], platform: float, down: bool) -> Heights:
    outside = np.maximum(patch.distance - platform / 2, 0.0)
    return (outside if down else outside.max() - outside) * patch.at(incline)


def _stones(
    patch: Patch, stone: tuple[float, ...], gap: tuple[float, ...], depth: float, jitter: float, platform: float
) -> Heights:
    side = patch.at(stone)
    period = side + patch.at(gap)
    row, column = patch.squares(period)
    tops = (2.0 * patch.random(int(row.max()) + 1, int(column.max()) + 1) - 1.0) * jitter
    right = patch.x - patch.x.min() + patch.cell / 2 - column * period
    above = patch.y - patch.y.min() + patch.cell / 2 - row * period
    is_stone = (right < side) & (above < side)
    return np.where(patch.is_on(platform), 0.0, np.where(is_stone, tops[row, column], -depth))


def _gaps(patch: Patch, gap: tuple[float, ...], every: float, depth: float, platform: float) -> Heights:
    width = patch.at(gap)
    period = every + width
    outside = patch.distance - platform / 2 - patch.cell / 2
    is_gap = ~patch.is_on(platform) & (outside - np.floor(outside / period) * period < width)
    return np.where(is_gap, -depth, 0.0)


_SERIES = tuple((-1) ** n * math.tau ** (2 * n + 1) / math.factorial(2 * n + 1) for n in range(8))


def _sine(turns: Heights) -> Heights:
    """Return the sine of an angle in turns, from its series: C libraries differ in the last bits of theirs."""
    turns = turns - np.rint(turns)
    turns = np.where(np.abs(turns) > 0.25, np.copysign(0.5, turns) - turns, turns)
    square = turns * turns
    found = np.zeros_like(turns)
    for coefficient in reversed(_SERIES):
        found = found * square + coefficient
    return found * turns


def _waves(patch: Patch, height: tuple[float, ...], waves: float) -> Heights:
    length = float(np.ptp(patch.x)) / waves
    along_y = _sine(patch.y / length + 0.25)
    return patch.at(height) / 4 * (_sine(patch.x / length) + along_y)


def _boxes(patch: Patch, height: tuple[float, ...], side: float, platform: float) -> Heights:
    row, column = patch.squares(side)
    tops = patch.random(int(row.max()) + 1, int(column.max()) + 1) * patch.at(height)
    return np.where(patch.is_on(platform), 0.0, tops[row, column])


_MAKERS: Mapping[str, Callable[..., Heights]] = {
    "rough": _rough,
    "stairs": _stairs,
    "slope": _slope,
    "stones": _stones,
    "gaps": _gaps,
    "waves": _waves,
    "boxes": _boxes,
}


def _edge(kind: str, heights: Heights, is_edge: NDArray[np.bool_]) -> float:
    """Return the height of the flat edge."""
    if kind in ("rough", "waves"):
        return float(np.median(heights[is_edge]))
    if kind in ("stairs", "slope"):
        return float(heights[0, 0])
    return 0.0


def _patch(terrain: TerrainLayout, ground: GroundKind, row: int, column: int) -> Heights:
    """Return the heights of one patch; a row of the array has one y."""
    along_x, along_y = terrain.cells
    # From the middle: a patch is as symmetric as its kind.
    places_x = (np.arange(along_x + 1) - along_x / 2) * terrain.cell
    places_y = (np.arange(along_y + 1) - along_y / 2) * terrain.cell
    x, y = np.meshgrid(places_x, places_y)
    difficulty = terrain.levels[row]
    identity = (terrain.seed, ground.kind, row, column, round(difficulty * 1e6))
    patch = Patch(x, y, terrain.cell, difficulty=difficulty, identity=identity)
    heights = _MAKERS[ground.kind](patch, **ground.settings)
    inner = terrain.border + terrain.cell / 2
    is_edge = (np.abs(x) > terrain.size[0] / 2 - inner) | (np.abs(y) > terrain.size[1] / 2 - inner)
    if terrain.border:
        heights = np.where(is_edge, _edge(ground.kind, heights, is_edge), heights)
    return np.round(heights, _DIGITS) + 0.0


class HeightField(Struct):
    """The heights of a terrain in meters, a row for each y, and the middle of each patch as (rows, columns, 3)."""

    heights: Heights
    origins: NDArray[np.float64]

    @property
    def low(self) -> float:
        return float(self.heights.min())

    @property
    def rise(self) -> float:
        """The height between the lowest and the highest places. MuJoCo refuses 0."""
        return max(float(self.heights.max()) - self.low, 1e-3)

    @property
    def content(self) -> bytes:
        """The file of MuJoCo: the numbers of rows and columns as int32, and the heights from 0 to 1 as float32.

        A PNG has 256 heights only.
        """
        shares = (self.heights - self.low) / self.rise
        return np.array(shares.shape, "<i4").tobytes() + shares.astype("<f4").tobytes()


def made(terrain: TerrainLayout) -> HeightField:
    """Return the height field of a terrain."""
    grounds = terrain.grounds
    along_x, along_y = terrain.cells
    length, width = terrain.size
    heights = np.zeros(terrain.shape)
    origins = np.zeros((len(terrain.levels), len(grounds), 3))
    for row in range(len(terrain.levels)):
        for column, ground in enumerate(grounds):
            patch = _patch(terrain, ground, row, column)
            # Patches share the heights between them; the next one counts.
            start_y = row * along_y
            start_x = column * along_x
            heights[start_y : start_y + along_y + 1, start_x : start_x + along_x + 1] = patch
            x = (column + 0.5 - len(grounds) / 2) * length
            y = (row + 0.5 - len(terrain.levels) / 2) * width
            origins[row, column] = x, y, patch[along_y // 2, along_x // 2]
    return HeightField(heights, origins)

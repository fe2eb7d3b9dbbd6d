"""The form of a terrain: a height field that mjcompose makes from a kind, a difficulty and a seed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.base.limits import advice, in_force
from mjcompose.language.forms.context import Schema, Settings
from mjcompose.language.forms.model import IT, OWNER, Bars, Belongs, KeyRule, Model, OneOf
from mjcompose.language.forms.scalars import LENGTHS, AtLeastOne, Count, Expects, Items, Scaled
from mjcompose.tree.values import either

Kind = Literal["rough", "stairs", "slope", "stones", "gaps", "waves", "boxes"]
Range = tuple[float, ...]
KINDS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "rough": {"height": (0.02, 0.15), "scale": 1.0, "octaves": 4},
        "stairs": {"rise": (0.03, 0.2), "tread": 0.3, "platform": 1.5, "down": False},
        "slope": {"incline": (0.0, 0.7), "platform": 1.5, "down": False},
        "stones": {"stone": (0.7, 0.25), "gap": (0.05, 0.35), "depth": 1.0, "jitter": 0.05, "platform": 1.5},
        "gaps": {"gap": (0.05, 0.6), "every": 1.0, "depth": 1.0, "platform": 1.5},
        "waves": {"height": (0.0, 0.3), "waves": 4},
        "boxes": {"height": (0.02, 0.25), "side": 0.4, "platform": 1.5},
    }
)
"""The keys of each kind with their defaults; two numbers are the values at the difficulties 0 and 1."""
OWN = tuple(dict.fromkeys(key for keys in KINDS.values() for key in keys))
_LEAST = ("stone", "gap", "tread", "side")
"""Keys with sizes that must span a cell."""
_TINY = 1e-9

Length = Annotated[float, Scaled(LENGTHS, ge=0)]
PositiveLength = Annotated[float, Scaled(LENGTHS, gt=0)]
_ENDS = Expects("a number, or its values at the difficulties 0 and 1", "[0.03, 0.2]")
Lengths = Annotated[tuple[Length, ...], Items(1, 2, single=True), _ENDS]
PositiveLengths = Annotated[tuple[PositiveLength, ...], Items(1, 2, single=True), _ENDS]
Share = Annotated[float, Field(ge=0, le=1)]


def between(ends: Range, difficulty: float) -> float:
    """Return the value at a difficulty from the values at 0 and 1, or from one number for all difficulties.

    >>> between((0.0, 0.5), 0.5), between((0.2,), 0.5)
    (0.25, 0.2)
    """
    return ends[0] + difficulty * (ends[-1] - ends[0])


class _KeysOfKind:
    """The rule that a kind has only its own keys."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        kind = value.get("kind")
        if not isinstance(kind, str) or kind not in KINDS:
            return
        own = KINDS[kind]
        for key in value:
            if key in OWN and key not in own:
                others = either([each for each, keys in KINDS.items() if key in keys])
                message = f"`{key}` of {OWNER} is for the kind {others}, and this is `{kind}`"
                help = f"remove it; `{kind}` has {', '.join(f'`{each}`' for each in own)}"
                yield Fault("unknown-key", message, (key,), key=True, help=help)

    def schema(self) -> Iterator[Schema]:
        for kind, keys in KINDS.items():
            others: Schema = {key: False for key in OWN if key not in keys}
            yield {
                "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
                "then": {"properties": others},
            }


class Ground(Model):
    """The kind of a terrain, and its numbers."""

    rules: ClassVar[tuple[KeyRule, ...]] = (_KeysOfKind(),)
    short: ClassVar[str | None] = "kind"
    example: ClassVar = "{kind: stairs, rise: [0.03, 0.2]}"

    kind: Kind | None = Field(None, examples=["stairs"])
    """`rough` ground, `stairs`, a `slope`, stepping `stones`, `gaps` to step over, `waves`, or `boxes` of random
    heights"""
    height: Lengths | None = None
    """rough, waves, boxes: the height between the lowest and the highest places; by default [0.02, 0.15], [0, 0.3] and
    [0.02, 0.25]"""
    scale: PositiveLength | None = None
    """rough: the length of the largest bumps; by default 1"""
    octaves: Annotated[AtLeastOne, Field(le=16)] | None = None
    """rough: how many sizes of bumps there are, each half as large as the one before; by default 4"""
    rise: Lengths | None = None
    """stairs: the height of a step; by default [0.03, 0.2]"""
    tread: PositiveLength | None = None
    """stairs: the depth of a step; by default 0.3"""
    incline: Annotated[tuple[Annotated[float, Field(ge=0)], ...], Items(1, 2, single=True), _ENDS] | None = None
    """slope: the height for each meter of length; by default [0, 0.7], which is up to 35 degrees"""
    stone: PositiveLengths | None = None
    """stones: the side of a stone; by default [0.7, 0.25]"""
    gap: PositiveLengths | None = None
    """stones, gaps: the width of a gap; by default [0.05, 0.35] and [0.05, 0.6]"""
    every: PositiveLength | None = None
    """gaps: the width of the ground between two gaps; by default 1"""
    depth: PositiveLength | None = None
    """stones, gaps: the depth of the gaps; by default 1"""
    jitter: Length | None = None
    """stones: the largest distance of a stone above or below 0; by default 0.05"""
    waves: Annotated[float, Field(gt=0)] | None = None
    """waves: how many there are along x; by default 4"""
    side: PositiveLength | None = None
    """boxes: the side of a box; by default 0.4"""
    platform: Length | None = None
    """stairs, slope, stones, gaps, boxes: the side of the flat square in the middle; by default 1.5"""
    down: bool | None = None
    """stairs, slope: true for a pit with the platform at its bottom"""

    def settings(self) -> dict[str, Any]:
        """Return the keys of the kind with their values, those that are not written with their defaults."""
        own = KINDS[str(self.kind)]
        return {key: default if getattr(self, key) is None else getattr(self, key) for key, default in own.items()}

    def smallest(self, difficulty: float, length: float) -> Iterator[tuple[str, float]]:
        """Yield the sizes that a height field of a length can only show if they span a cell."""
        settings = self.settings()
        for key in _LEAST:
            if key in settings:
                value = settings[key]
                yield key, between(value, difficulty) if isinstance(value, tuple) else value
        if "octaves" in settings:
            yield "scale", settings["scale"] / 2 ** (settings["octaves"] - 1)
        if "waves" in settings:
            yield "waves", length / settings["waves"] / 4


class TerrainColumn(Ground):
    """One column of patches."""

    kind: Kind = Field(examples=["stairs"])
    """the kind of the column"""


class Terrain(Ground):
    """A height field that mjcompose makes: one kind, or a grid with a kind in each column and a level in each row."""

    rules: ClassVar[tuple[KeyRule, ...]] = (
        OneOf(
            "kind", "columns", lacks="has no `kind`", advice=f"write `kind: stairs`, or another of {', '.join(KINDS)}"
        ),
        _KeysOfKind(),
        Bars(
            "columns", *OWN, why="has its numbers in each of its columns, as in `columns: [{kind: stairs, rise: 0.1}]`"
        ),
        Belongs("rows", "columns"),
    )
    short: ClassVar[str | None] = None
    example: ClassVar = "{kind: …}"

    columns: Annotated[tuple[TerrainColumn, ...], Items(1), Expects("a list of kinds", "[rough, stairs]")] | None = None
    """for a grid of patches, the kind of each column: a word, or a mapping with the kind and its numbers"""
    rows: AtLeastOne = 1
    """how many levels the grid has"""
    size: Annotated[tuple[PositiveLength, ...], Items(2, 2), Expects("the lengths along x and y", "[8, 8]")] = (8, 8)
    """the lengths along x and y, of each patch of a grid"""
    cell: PositiveLength = 0.05
    """the distance of two heights"""
    difficulty: Annotated[tuple[Share, ...], Items(1, 2, single=True)] | None = None
    """from 0 to 1, by default 0.5. For a grid, the difficulties of the first and the last row, by default [0, 1]"""
    seed: Count = 0
    """another seed gives other random heights"""
    border: Length = 0.25
    """the width of the flat edge, of each patch of a grid"""

    @property
    def grounds(self) -> tuple[Ground, ...]:
        return self.columns or (self,)

    @property
    def levels(self) -> tuple[float, ...]:
        """The difficulty of each row."""
        usual = (0.5,) if self.columns is None else (0.0, 1.0)
        ends = self.difficulty or usual
        return tuple(between(ends, row / max(self.rows - 1, 1)) for row in range(self.rows))

    @property
    def cells(self) -> tuple[int, int]:
        """The number of cells of one patch along x and y."""
        return round(self.size[0] / self.cell), round(self.size[1] / self.cell)

    @property
    def shape(self) -> tuple[int, int]:
        """The number of heights along y and x."""
        along_x, along_y = self.cells
        return self.rows * along_y + 1, len(self.grounds) * along_x + 1

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if self.columns is None and len(self.difficulty or ()) > 1:
            message = f"{IT} has one patch, and `difficulty` has two numbers"
            yield Fault("wrong-length", message, ("difficulty",), help="write one number, or `columns` for a grid")
        if (fault := self._fault_of_size()) is not None:
            yield fault
            return
        for ground in self.grounds:
            for key, size in (pair for level in self.levels for pair in ground.smallest(level, self.size[0])):
                if size < self.cell * (1 - _TINY):
                    yield self._too_fine(ground, key, size)
                    return
            if ground.settings().get("platform", 0) > min(self.size):
                message = f"the `platform` of `{ground.kind}` is wider than the ground, which is {min(self.size):g}"
                yield Fault(
                    "out-of-range", message, ("platform",), help="write a smaller `platform`, or a larger `size`"
                )
                return

    def _fault_of_size(self) -> Fault | None:
        for index, (length, count) in enumerate(zip(self.size, self.cells, strict=True)):
            if abs(length - count * self.cell) > 1e-6 * length or count < 2:
                message = f"`size` of {OWNER} is {length:g}, which is not two or more whole cells of {self.cell:g}"
                fitting = max(count, 2) * self.cell
                return Fault("out-of-range", message, ("size", index), help=f"write {fitting:g}, or another `cell`")
        if 2 * self.border >= min(self.size):
            message = f"`border` of {OWNER} is {self.border:g} on each side, and the ground is {min(self.size):g} wide"
            return Fault("out-of-range", message, ("border",), help="write a smaller `border`, or `border: 0`")
        along_y, along_x = self.shape
        most = in_force().heights
        if along_y * along_x > most:
            message = f"{IT} has {along_x} × {along_y} heights; {most} are allowed"
            return Fault("limit-exceeded", message, ("cell",), help=advice("heights", along_y * along_x))
        return None

    def _too_fine(self, ground: Ground, key: str, size: float) -> Fault:
        what = {"scale": "the smallest bumps", "waves": "a quarter of a wave"}.get(key, f"`{key}`")
        other = {"scale": "fewer `octaves`", "waves": "fewer `waves`"}.get(key, f"a larger `{key}`")
        message = f"{what} of `{ground.kind}` would be {size:g}, less than a cell of {self.cell:g}"
        return Fault("out-of-range", message, ("cell",), help=f"write `cell: {size:g}` or less, or {other}")

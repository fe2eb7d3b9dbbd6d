"""The limits of one run, each with its name, its default, and the work that it bounds.

Each is checked before the work that it bounds. `--limit NAME=VALUE` raises it on the command line, `allow` in Python.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import field, fields, replace
from typing import Any

from mjcompose.base.dataclass import Struct

KIB = 1 << 10
MIB = 1 << 20
GIB = 1 << 30
_UNITS = {"": 1, "K": KIB, "M": MIB, "G": GIB, "T": 1 << 40}


def _limit(default: float, bounds: str, unit: str = "") -> Any:
    return field(default=default, metadata={"unit": unit, "bounds": bounds})


class Limits(Struct):
    """Every limit of a run. A field is called as in `--limit`, with `_` for `-`."""

    time: float = _limit(300.0, "the work of MuJoCo on one model", "seconds")
    memory: int = _limit(8 * GIB, "the memory of mjcompose, and of MuJoCo's process (POSIX)", "bytes")
    mesh_time: float = _limit(1800.0, "the work on one mesh that a recipe asks for", "seconds")
    mesh_faces: int = _limit(1_000_000, "the faces of a mesh that is worked on")
    elements: int = _limit(100_000, "the elements of a model as it is written")
    bodies: int = _limit(15_000, "the bodies of a model once it is expanded")
    dofs: int = _limit(
        15_000, "the degrees of freedom of a model: 6 for a free joint, 3 for a ball or a point of a flex, 1 for others"
    )
    mass_matrix: int = _limit(
        2_000_000, "the numbers in the mass matrix: one for each pair of degrees of freedom if one carries the other"
    )
    mesh_points: int = _limit(
        1_000_000, "the points of all meshes of a model; points of meshes that collide with nothing count a tenth"
    )
    expansion: int = _limit(20_000, "the elements that `<replicate>`, `<flexcomp>`, `<composite>` and `<attach>` make")
    reserved: int = _limit(
        100_000_000,
        "the numbers that textures, height fields and `<size>` reserve in a model, and the pixels of PNG files",
    )
    heights: int = _limit(4_000_000, "the heights of one terrain that a recipe makes")
    parts: int = _limit(10_000, "the parts of a recipe, including nested recipes and all copies")
    copies: int = _limit(10_000, "the copies that one `replicate` of a recipe makes, and the turns of one `for`")
    attributes: int = _limit(1000, "the attributes of one element")
    faults: int = _limit(1000, "the errors that mjcompose looks for")
    nesting: int = _limit(50, "depth of recipes, or files of a model, that include one another")
    submodels: int = _limit(1000, "the models that a model attaches, directly or through others")
    xml_size: int = _limit(64 * MIB, "the XML files of one model together", "bytes")
    text_size: int = _limit(16 * MIB, "one attribute, comment or text in XML", "bytes")
    recipe_size: int = _limit(16 * MIB, "one recipe file", "bytes")
    recording_size: int = _limit(1 * GIB, "one recording of a robot, as stored and as unpacked", "bytes")
    recording_numbers: int = _limit(50_000_000, "the numbers in one recording of a robot")
    edits: int = _limit(200_000, "the values that edits write, and the cost of selecting and drawing")
    yaml_values: int = _limit(
        500_000, "the values in one YAML file, aliases expanded, and those that `for` makes in a recipe"
    )
    yaml_depth: int = _limit(100, "depth of lists and mappings in one YAML file")
    string: int = _limit(10_000, "the characters of a text that an expression gives")
    cells: int = _limit(100_000, "the cells of a matrix")
    samples: int = _limit(100_000, "the samples of one `randomize`")
    models: int = _limit(1_000_000, "the models that one command builds")
    output_files: int = _limit(20_000, "the files of one bundle")
    output_size: int = _limit(4 * GIB, "the files of one bundle together", "bytes")
    source_files: int = _limit(200_000, "the files of one repository or archive")
    source_size: int = _limit(8 * GIB, "one repository or archive, as fetched and as unpacked", "bytes")
    git_memory: int = _limit(448 * MIB, "the memory of git while it fetches and unpacks (POSIX)", "bytes")
    source_ratio: int = _limit(
        300, "size of an archive or repository above 64 MiB, unpacked, as a multiple of its packed size"
    )

    def __post_init__(self) -> None:
        for name, value in self.items():
            if not value > 0:
                raise ValueError(f"the limit `{name}` must be greater than zero")

    def items(self) -> Iterator[tuple[str, float]]:
        for each in fields(self):
            yield each.name.replace("_", "-"), getattr(self, each.name)


NAMES = {each.name.replace("_", "-"): each for each in fields(Limits)}
"""The limits by their names on the command line."""
_DEFAULTS = Limits()
_IN_FORCE: ContextVar[Limits] = ContextVar("mjcompose.base.limits", default=_DEFAULTS)


def in_force() -> Limits:
    """Return the limits in force: the defaults, with the changes of `allow`."""
    return _IN_FORCE.get()


@contextmanager
def allow(**changed: float) -> Iterator[Limits]:
    """Change limits within the block. Raises ValueError for a limit that is not greater than zero.

    >>> with allow(expansion=1_000_000):
    ...     in_force().expansion
    1000000
    """
    token = _IN_FORCE.set(replace(in_force(), **changed))  # type: ignore[arg-type]  # the names are the caller's
    try:
        yield in_force()
    finally:
        _IN_FORCE.reset(token)


class LimitAdvice(str):
    """The help of an error about a limit: for the command line, and for a program."""

    __slots__ = ("in_python",)
    in_python: str


def advice(name: str, needed: float | None = None) -> LimitAdvice:
    """Return the help of an error about a limit: how to raise it, to `needed` if known.

    >>> advice("copies", 12000)
    'to allow it, raise the limit: `--limit copies=12000`'
    >>> advice("copies", 12000).in_python
    'to allow it, raise the limit: `with mjcompose.base.limits.allow(copies=12000):`'
    """
    if needed is not None and not needed < 1e18:  # an int that no float can hold, too, and NaN
        given = LimitAdvice("no limit allows that many: write a smaller number")
        given.in_python = str(given)
        return given
    attribute = name.replace("-", "_")
    value = 2 * getattr(in_force(), attribute) if needed is None else needed
    given = LimitAdvice(f"to allow it, raise the limit: `--limit {name}={written(name, value)}`")
    given.in_python = f"to allow it, raise the limit: `with mjcompose.base.limits.allow({attribute}={value:.12g}):`"
    return given


def written(name: str, value: float) -> str:
    """Return a limit's value as a person writes it.

    >>> written("xml-size", 64 * 2**20), written("copies", 10000), written("time", 300.0)
    ('64M', '10000', '300')
    """
    if NAMES[name].metadata["unit"] != "bytes":
        return f"{value:g}" if value != int(value) else str(int(value))
    unit = next((each for each in "TGMK" if value >= _UNITS[each]), "")
    return f"{math.ceil(value / _UNITS[unit])}{unit}"


def read(name: str, text: str) -> float | None:
    """Return the value that a text gives a limit; None if it is not a value.

    >>> read("memory", "2G"), read("copies", "10"), read("copies", "-1"), read("time", "0.5")
    (2147483648, 10, None, 0.5)
    """
    unit = NAMES[name].metadata["unit"]
    if unit == "bytes":
        return parse_size(text) or None
    try:
        value = float(text)
        if unit != "seconds" and value != int(value):
            return None
    except (ValueError, OverflowError):
        return None
    if not 0 < value < math.inf:
        return None
    return value if unit == "seconds" else int(value)


def parse_size(text: str) -> int | None:
    """Return the bytes of a size such as `500M` or `2.5G`; None if it is not a size. No I/O.

    >>> parse_size("2K"), parse_size("0"), parse_size("many")
    (2048, 0, None)
    """
    digits = text.strip().upper().removesuffix("B").removesuffix("I")
    unit = digits[-1:] if digits[-1:] in _UNITS else ""
    try:
        value = float(digits.removesuffix(unit)) * _UNITS[unit]
        return int(value) if value >= 0 else None
    except (ValueError, OverflowError):
        return None

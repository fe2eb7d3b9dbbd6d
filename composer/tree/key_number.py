"""A number of a key, and where it comes from: noted where keys are laid out, for those who ask afterwards."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span

Kind = Literal["key", "edited", "entry", "reference", "zero", "mujoco"]


@dataclass(frozen=True, slots=True)
class KeySource:
    """What gave numbers of a key.

    - `key`: the attribute `vector` of the `<key>` element `key`, as it was read;
    - `edited`: the same attribute, as an edit has left it after the row was cut;
    - `entry`: the entry of the recipe's section `keyframe` that `span` is;
    - `reference`: no key; the number is that of the reference configuration (`qpos`, `mpos`, `mquat`);
    - `zero`: no key; the number is 0 (`qvel`, `act`, `ctrl`);
    - `mujoco`: the row of `key` ends in the middle of a joint, and MuJoCo says how it goes on.

    `taken` has the `from` entries of recipes that passed the number on, `moved` the parts whose place changed it, with
    the place that attaches them: each in order. `lost` is the first number that a key gives
    where an edit has made that meaningless.
    """

    kind: Kind
    vector: str
    key: Node | None = None
    span: Span | None = None
    taken: tuple[Span, ...] = ()
    moved: tuple[tuple[str, Span | None], ...] = ()
    lost: Number | None = None


class Number(NamedTuple):
    """A number as text. It is the number `at`, counted from 0, of what `source` says."""

    text: str
    source: KeySource
    at: int = 0


@dataclass(frozen=True, slots=True)
class KeyRecord:
    """How a `<key>` was laid out: the elements whose place it takes, and its numbers by attribute, `time` included.

    The record holds as long as nobody changes the attribute: `numbers_of` says so.
    """

    keys: tuple[Node, ...] = ()
    numbers: dict[str, list[Number]] = field(default_factory=dict)


def numbers_of(record: KeyRecord | None, key: Node, vector: str) -> list[Number]:
    """The numbers that a `<key>` has in an attribute, each with where it comes from."""
    text = str(key.get(vector) or "").split()
    known = None if record is None else record.numbers.get(vector)
    if known is not None and texts(known) == text:
        return known
    source = KeySource("key" if known is None else "edited", vector, key)
    return [Number(each, source, at) for at, each in enumerate(text)]


def texts(numbers: Iterable[Number]) -> list[str]:
    return [number.text for number in numbers]


def moved(numbers: list[Number], now: Sequence[str], part: tuple[str, Span | None]) -> list[Number]:
    """The pose or velocity as the place of a part has changed it."""
    if texts(numbers) == list(now):
        return numbers
    sources: dict[int, KeySource] = {}
    for source in (number.source for number in numbers):
        if id(source) not in sources:
            sources[id(source)] = replace(source, moved=(*source.moved, part))
    return [
        Number(text, sources[id(number.source)], number.at) for number, text in zip(numbers, now, strict=True)
    ]


def taken(numbers: Iterable[Number], span: Span) -> list[Number]:
    """The numbers as a `from` entry of a recipe passes them on."""
    numbers = list(numbers)
    sources: dict[int, KeySource] = {}
    for source in (number.source for number in numbers):
        if id(source) not in sources:
            sources[id(source)] = replace(source, taken=(*source.taken, span))
    return [Number(number.text, sources[id(number.source)], number.at) for number in numbers]

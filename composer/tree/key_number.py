"""A number of a key and its origin, noted where keys are laid out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import field, replace
from typing import Literal, NamedTuple

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span

Kind = Literal["key", "edited", "entry", "reference", "zero", "mujoco"]


@dataclass(frozen=True, slots=True)
class KeySource:
    """The origin of numbers of a key.

    - `key`: the attribute `vector` of the `<key>` element `key`, as it was read;
    - `edited`: the same attribute, changed by an edit after the row was cut;
    - `entry`: the entry at `span` of the recipe's section `keyframe`;
    - `reference`: no key; the number is that of the reference configuration (`qpos`, `mpos`, `mquat`);
    - `zero`: no key; the number is 0 (`qvel`, `act`, `ctrl`);
    - `mujoco`: the row of `key` ends in the middle of a joint, and MuJoCo completes it.

    `taken` are the `from` entries of recipes that passed the number on, `moved` the parts whose place changed it,
    each with the place of its attachment, both in order. `lost` is the first number of a key that an edit has made
    meaningless here.
    """

    kind: Kind
    vector: str
    key: Node | None = None
    span: Span | None = None
    taken: tuple[Span, ...] = ()
    moved: tuple[tuple[str, Span | None], ...] = ()
    lost: Number | None = None


class Number(NamedTuple):
    """A number as text. It is number `at`, counted from 0, of its `source`."""

    text: str
    source: KeySource
    at: int = 0


@dataclass(frozen=True, slots=True)
class KeyRecord:
    """The layout of a `<key>`: the elements that it replaces, and its numbers by attribute, including `time`.

    `void` are the joints and actuators whose numbers in those elements mean nothing any more. The record is valid until
    the attribute changes, which `numbers_of` checks.
    """

    keys: tuple[Node, ...] = ()
    numbers: dict[str, list[Number]] = field(default_factory=dict)
    void: frozenset[Node] = frozenset()


def numbers_of(record: KeyRecord | None, key: Node, vector: str) -> list[Number]:
    """Return the numbers of a `<key>` in an attribute, each with its origin."""
    text = str(key.get(vector) or "").split()
    known = None if record is None else record.numbers.get(vector)
    if known is not None and texts(known) == text:
        return known
    source = KeySource("key" if known is None else "edited", vector, key)
    return [Number(each, source, at) for at, each in enumerate(text)]


def texts(numbers: Iterable[Number]) -> list[str]:
    return [number.text for number in numbers]


def moved(numbers: list[Number], now: Sequence[str], part: tuple[str, Span | None]) -> list[Number]:
    """Return a pose or velocity changed by the place of a part."""
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
    """Return the numbers passed on by a `from` entry of a recipe."""
    numbers = list(numbers)
    sources: dict[int, KeySource] = {}
    for source in (number.source for number in numbers):
        if id(source) not in sources:
            sources[id(source)] = replace(source, taken=(*source.taken, span))
    return [Number(number.text, sources[id(number.source)], number.at) for number in numbers]

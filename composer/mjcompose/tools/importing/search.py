"""The parts of a merged model, found in folders and packages."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import field
from importlib import metadata
from pathlib import Path
from typing import TypeVar

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.menagerie import known_models
from mjcompose.sources.reference import SourceError
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit

T = TypeVar("T")


def paired(one: Sequence[T], other: Sequence[T], alike: Callable[[T, T], bool]) -> Iterator[tuple[T, T | None]]:
    """Yield every element of `one` with its counterpart in `other`, or None if it has none.

    Equal elements are paired in order, and the elements between them by position. If that leaves an element of
    `other` without a partner, all elements are paired by position, because additions come at the end.

    >>> list(paired("abcd", "axd", str.__eq__)), list(paired("ab", "axb", str.__eq__))
    ([('a', 'a'), ('b', 'x'), ('c', None), ('d', 'd')], [('a', 'a'), ('b', 'x')])
    """
    kept = _common(one, other, alike)
    if len(other) > len(one) or any(b - d > a - c for (a, b), (c, d) in zip(kept, [(-1, -1), *kept], strict=False)):
        kept = []
    last = (-1, -1)
    for end in (*kept, (len(one), len(other))):
        between = list(range(last[1] + 1, end[1]))
        for number, index in enumerate(range(last[0] + 1, end[0])):
            yield one[index], other[between[number]] if number < len(between) else None
        if end[0] < len(one):
            yield one[end[0]], other[end[1]]
        last = end


def _common(one: Sequence[T], other: Sequence[T], alike: Callable[[T, T], bool]) -> list[tuple[int, int]]:
    """Return the longest sequence of equal pairs, in the order of both."""
    same = [[alike(a, b) for b in other] for a in one]
    length = [[0] * (len(other) + 1) for _ in range(len(one) + 1)]
    for i in reversed(range(len(one))):
        for j in reversed(range(len(other))):
            length[i][j] = 1 + length[i + 1][j + 1] if same[i][j] else max(length[i + 1][j], length[i][j + 1])
    pairs = []
    i = 0
    j = 0
    while i < len(one) and j < len(other):
        if same[i][j]:
            pairs.append((i, j))
            i = i + 1
            j = j + 1
        elif length[i + 1][j] >= length[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


SEPARATORS = ("__", "/", ":", ".", "-", "_")
_MATCH_ENOUGH = 0.5  # share of a part's bodies, matched by name


class Instance(Struct, frozen=False):
    """A part at its place in the merged model.

    `prefix` starts the part's names there. `key` and `out` are the prefix in the recipe, without and with its
    separator; they differ from `prefix` if a recipe cannot use it.
    """

    part: int
    prefix: str
    root: Node
    """The part's own root body."""
    body: Node
    """The corresponding body of the merged model."""
    likeness: float
    key: str = ""
    out: str = ""
    is_base: bool = False
    names: frozenset[str] = field(default=frozenset())
    """The names of the part's bodies."""


def find(merged: Unit, parts: list[Unit]) -> list[Instance]:
    """Return the places of the parts, in the order of the merged model's bodies; they do not overlap."""
    bodies = {str(body.get("name")): body for body in _bodies(merged) if body.get("name")}
    candidates = [each for number, part in enumerate(parts) for each in _of_part(number, part, bodies)]
    found: list[Instance] = []
    taken: set[str] = set()
    for each in sorted(candidates, key=lambda each: (-each.likeness, -len(each.names), each.part)):
        here = {each.prefix + name for name in each.names} & bodies.keys()
        if not here & taken:
            taken |= here
            found.append(each)
    order = {name: index for index, name in enumerate(bodies)}
    return sorted(found, key=lambda each: order[str(each.body.get("name"))])


def separator_of(found: list[Instance]) -> str:
    """Return the separator that all prefixes end with; `/` if they have none in common."""
    prefixes = [each.prefix for each in found if each.prefix]
    fitting = (end for end in SEPARATORS if all(each.endswith(end) and each != end for each in prefixes))
    return next(fitting, "/") if prefixes else "/"


def name_in_recipe(found: list[Instance], labels: list[str], separator: str) -> None:
    """Choose the base, and the key of every other part."""
    taken: set[str] = set()
    for each in found:
        if not each.prefix and parent_body(each.body) is None and not any(other.is_base for other in found):
            each.is_base = True
            continue
        key = each.prefix.removesuffix(separator) if each.prefix.endswith(separator) else labels[each.part]
        if separator in ("/", ":"):
            key = key.replace(separator, "_")
        while key in taken or key == "base":
            key += "2"
        taken.add(key)
        each.key = key
        each.out = key + separator


def parent_body(body: Node) -> Node | None:
    """Return the body around this one, ignoring frames; None for the world."""
    parent = next(body.iterancestors("body", "worldbody"), None)
    return parent if parent is not None and parent.tag == "body" else None


def _of_part(number: int, part: Unit, bodies: dict[str, Node]) -> Iterator[Instance]:
    named = [body for body in _bodies(part) if body.get("name")]
    own = frozenset(str(body.get("name")) for body in named)
    if named:
        for there, body in bodies.items():
            root = named[0]
            name = str(named[0].get("name"))
            if there.endswith(name):
                prefix = there.removesuffix(name)
                likeness = sum(prefix + each in bodies for each in own) / len(own)
                if likeness >= _MATCH_ENOUGH:
                    yield Instance(number, prefix, root, body=body, likeness=likeness, names=own)


def _bodies(unit: Unit) -> Iterator[Node]:
    for world in unit.root.iterchildren("worldbody"):
        yield from world.iter("body")


_BODY = re.compile(rb"""<body\b[^>]*?\bname\s*=\s*["']([^"']+)["']""")
_MODEL = re.compile(rb"<mujoco[\s>]")
# A part must share this much of its bodies with the merged model, and at least this number.
_SEARCHING_ENOUGH = 0.8
_LEAST = 2
_MOST = 60
_LARGEST = 16 << 20


class Candidate(Struct):
    """A model file, and the recipe's reference to it; None for its path."""

    path: Path
    reference: str | None = None


class Search(Struct):
    """The result of a search.

    `parts` are the likely parts of the merged model; `looked_at` is the number of candidates.
    """

    parts: tuple[Candidate, ...]
    looked_at: int


def search(merged: Path, folders: Iterable[Path], context: Context, progress: Callable[[str], None]) -> Search | None:
    """Find the parts of a merged model by the names of their bodies; return None if it cannot be read.

    Models in `folders` come first, then Menagerie, then packages. Nothing is fetched.
    """
    whole = parse_file(merged, context.sink, file=context.shown(merged))
    if whole is None:
        return None
    bodies = _named(whole)
    likely: list[tuple[float, Candidate]] = []
    seen = {Path(os.path.realpath(merged))}
    progress("looking for its parts")
    for candidate in _candidates(folders, context):
        real = Path(os.path.realpath(candidate.path))
        if real in seen:
            continue
        seen.add(real)
        share = _share(real, bodies)
        if share >= _SEARCHING_ENOUGH:
            likely.append((share, candidate))
    likely = sorted(likely, key=lambda each: -each[0])[:_MOST]
    read = [(candidate, parse_file(candidate.path, Sink(), file=str(candidate.path))) for _, candidate in likely]
    units = [(candidate, unit) for candidate, unit in read if unit is not None]
    parts, covered = _found(whole, [each for each in units if _named(each[1]) != bodies])
    if covered != bodies:  # a copy of the whole model is less useful than its parts, but better than nothing
        parts, _ = _found(whole, units)
    return Search(parts, len(seen) - 1)


def _found(whole: Unit, units: list[tuple[Candidate, Unit]]) -> tuple[tuple[Candidate, ...], set[str]]:
    """Return the models that are parts of the whole, and the bodies that they cover."""
    every = find(whole, [unit for _, unit in units])
    found = [each for each in every if len(each.names) >= _LEAST and each.likeness >= _SEARCHING_ENOUGH]
    covered = {each.prefix + name for each in found for name in each.names} & _named(whole)
    return tuple(dict.fromkeys(units[each.part][0] for each in found)), covered


def _named(unit: Unit) -> set[str]:
    return {str(body.get("name")) for body in unit.root.iter("body") if body.get("name")}


def _share(path: Path, bodies: set[str]) -> float:
    """Return the share of a file's bodies that the merged model has, with or without a prefix; 0 for other files."""
    text = b""
    with suppress(OSError):
        text = read_regular(path, _LARGEST)
    own = list(dict.fromkeys(name.decode("utf-8", "replace") for name in _BODY.findall(text)))
    if len(own) < _LEAST or _MODEL.search(text) is None:
        return 0
    prefixes = {"", *(name.removesuffix(own[0]) for name in bodies if name.endswith(own[0]))}
    return max(sum(prefix + name in bodies for name in own) for prefix in prefixes) / len(own)


def _candidates(folders: Iterable[Path], context: Context) -> Iterator[Candidate]:
    for folder in folders:
        yield from (Candidate(path) for path in sorted(folder.rglob("*.xml")) if os.path.isfile(path))
    yield from _of_menagerie(context)
    yield from _of_packages()


def _of_menagerie(context: Context) -> Iterator[Candidate]:
    offline = Fetching(offline=True)
    missing: set[str] = set()
    for robot, entry, _ in known_models(context.environment):
        if robot in missing:
            continue
        reference = f"menagerie:{robot}/{entry}"
        try:
            source = resolve(reference, relative_to=context.folder, environment=context.environment, fetching=offline)
        except SourceError:
            missing.add(robot)  # if one model of the robot is missing, so are the others
            continue
        yield Candidate(source.path, reference)


def _of_packages() -> Iterator[Candidate]:
    for distribution in metadata.distributions():
        for file in distribution.files or ():
            if file.suffix == ".xml" and len(file.parts) > 1:
                path = Path(str(distribution.locate_file(file)))
                if os.path.isfile(path):
                    yield Candidate(path, f"package:{file.as_posix()}")

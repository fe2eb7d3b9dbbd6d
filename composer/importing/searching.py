"""Models that a merged model may be made of: in folders, in Menagerie as far as it is on this machine, in packages."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.importing.match import find
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.sources.error import SourceError
from composer.sources.fetching import Fetching
from composer.sources.resolve import resolve
from composer.tree.parse import parse_file
from composer.tree.unit import Unit

_BODY = re.compile(rb"""<body\b[^>]*?\bname\s*=\s*["']([^"']+)["']""")
_MODEL = re.compile(rb"<mujoco[\s>]")
_ENOUGH, _LEAST = (
    0.8,
    2,
)  # the share of a model's bodies that must be there, and how many, to be taken for a part
_MOST = 60
_LARGEST = 16 << 20


@dataclass(frozen=True, slots=True)
class Candidate:
    """A model file, and how a recipe refers to it; None for its path."""

    path: Path
    reference: str | None = None


@dataclass(frozen=True, slots=True)
class Search:
    """`parts` are the models that the merged one seems to be made of; `looked_at` is how many there were to look at."""

    parts: tuple[Candidate, ...]
    looked_at: int


def search(
    merged: Path, folders: Iterable[Path], context: Context, progress: Callable[[str], None]
) -> Search | None:
    """The parts of a merged model, found by the names of their bodies; None where it cannot be read.

    What is in `folders` is preferred, then Menagerie, then packages. Nothing is fetched.
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
        if share >= _ENOUGH:
            likely.append((share, candidate))
    likely = sorted(likely, key=lambda each: -each[0])[:_MOST]
    units: list[tuple[Candidate, Unit]] = []
    for _, candidate in likely:
        unit = parse_file(candidate.path, Sink(), file=str(candidate.path))
        if unit is not None:
            units.append((candidate, unit))
    pieces = [each for each in units if _named(each[1]) != bodies]
    parts, covered = _found(whole, pieces)
    if covered != bodies:  # another copy of the whole says less than its parts, and more than nothing
        parts, _ = _found(whole, units)
    return Search(parts, len(seen) - 1)


def _found(whole: Unit, units: list[tuple[Candidate, Unit]]) -> tuple[tuple[Candidate, ...], set[str]]:
    """Which of the models are parts of the whole, and the bodies that are of one of them."""
    found = [each for each in find(whole, [unit for _, unit in units]) if len(each.names) >= _LEAST]
    found = [each for each in found if each.likeness >= _ENOUGH]
    covered = {each.prefix + name for each in found for name in each.names} & _named(whole)
    return tuple(dict.fromkeys(units[each.part][0] for each in found)), covered


def _named(unit: Unit) -> set[str]:
    return {str(body.get("name")) for body in unit.root.iter("body") if body.get("name")}


def _share(path: Path, bodies: set[str]) -> float:
    """How many of the bodies of a file are in the merged model, under a prefix or none; 0 for what is not a model."""
    try:
        text = read_regular(path, _LARGEST)
    except (OSError, Refused):
        return 0
    own = list(dict.fromkeys(name.decode("utf-8", "replace") for name in _BODY.findall(text)))
    if len(own) < _LEAST or _MODEL.search(text) is None:
        return 0
    prefixes = {"", *(name.removesuffix(own[0]) for name in bodies if name.endswith(own[0]))}
    return max(sum(prefix + name in bodies for name in own) for prefix in prefixes) / len(own)


def _candidates(folders: Iterable[Path], context: Context) -> Iterator[Candidate]:
    for folder in folders:
        yield from (Candidate(path) for path in sorted(folder.rglob("*.xml")) if path.is_file())
    yield from _of_menagerie(context)
    yield from _of_packages()


def _of_menagerie(context: Context) -> Iterator[Candidate]:
    """The entries of the robots that are on this machine."""
    if find_spec("mujoco_menagerie") is None:
        return
    import mujoco_menagerie

    library: Any = mujoco_menagerie
    offline = Fetching(offline=True)
    for name in library.names():
        for entry in library.get(name).entry_points:
            reference = f"menagerie:{name}/{entry.name}"
            try:
                source = resolve(
                    reference, relative_to=context.folder, environment=context.environment, fetching=offline
                )
            except SourceError:
                break  # what the robot lacks, its other entries lack too
            yield Candidate(source.path, reference)


def _of_packages() -> Iterator[Candidate]:
    """The XML files of installed packages."""
    for distribution in metadata.distributions():
        for file in distribution.files or ():
            if file.suffix == ".xml" and len(file.parts) > 1:
                path = Path(str(distribution.locate_file(file)))
                if path.is_file():
                    yield Candidate(path, f"package:{file.as_posix()}")

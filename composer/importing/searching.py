"""Search for the parts of a merged model: in folders, in Menagerie as far as it is on this machine, and in packages."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from composer.context import Context
from composer.dataclass import dataclass
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
)  # to be a part, a model must share this much of its bodies with the merged one, and at least so many
_MOST = 60
_LARGEST = 16 << 20


@dataclass(frozen=True, slots=True)
class Candidate:
    """A model file, and the recipe's reference to it; None for its path."""

    path: Path
    reference: str | None = None


@dataclass(frozen=True, slots=True)
class Search:
    """The result of a search.

    `parts` are the likely parts of the merged model; `looked_at` is the number of candidates.
    """

    parts: tuple[Candidate, ...]
    looked_at: int


def search(
    merged: Path, folders: Iterable[Path], context: Context, progress: Callable[[str], None]
) -> Search | None:
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
    if covered != bodies:  # a copy of the whole model is less useful than its parts, but better than nothing
        parts, _ = _found(whole, units)
    return Search(parts, len(seen) - 1)


def _found(whole: Unit, units: list[tuple[Candidate, Unit]]) -> tuple[tuple[Candidate, ...], set[str]]:
    """Return the models that are parts of the whole, and the bodies that they cover."""
    found = [each for each in find(whole, [unit for _, unit in units]) if len(each.names) >= _LEAST]
    found = [each for each in found if each.likeness >= _ENOUGH]
    covered = {each.prefix + name for each in found for name in each.names} & _named(whole)
    return tuple(dict.fromkeys(units[each.part][0] for each in found)), covered


def _named(unit: Unit) -> set[str]:
    return {str(body.get("name")) for body in unit.root.iter("body") if body.get("name")}


def _share(path: Path, bodies: set[str]) -> float:
    """Return the share of a file's bodies that the merged model has, with or without a prefix; 0 for other files."""
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
        yield from (Candidate(path) for path in sorted(folder.rglob("*.xml")) if os.path.isfile(path))
    yield from _of_menagerie(context)
    yield from _of_packages()


def _of_menagerie(context: Context) -> Iterator[Candidate]:
    """Yield the models of Menagerie robots that are on this machine."""
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
                break  # if the robot is missing, so are its other models
            yield Candidate(source.path, reference)


def _of_packages() -> Iterator[Candidate]:
    """Yield the XML files of installed packages."""
    for distribution in metadata.distributions():
        for file in distribution.files or ():
            if file.suffix == ".xml" and len(file.parts) > 1:
                path = Path(str(distribution.locate_file(file)))
                if os.path.isfile(path):
                    yield Candidate(path, f"package:{file.as_posix()}")

"""The recipes that MJCF attaches itself: `<model file="gripper.yaml"/>`."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from mjcompose.base.access import Door
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.tree.files import is_recipe, join
from mjcompose.tree.parse import parse_file

_NAMED = re.compile(rb"""<(?:model|include)\b[^>]*?\bfile\s*=\s*["']([^"']+)["']""")


def inner_recipes(source: Source, context: Context) -> Iterator[tuple[Path, Path, Span]]:
    """Yield the recipes that a model attaches: the file, the folder of the MJCF that names it, and the place there.

    A file that the model may not read is reported.
    """
    # Few models attach recipes, and a look at the text takes a fraction of the time of parsing it.
    if source.format == "mjcf" and _reaches(source.path, source.path.parent, source.door, seen=set()):
        yield from _recipes(source.path, source.door, context, seen=set())


def _reaches(path: Path, main: Path, door: Door, seen: set[Path]) -> bool:
    """Return whether a file, or a file that it includes or attaches, names a recipe."""
    if path in seen:
        return False
    seen.add(path)
    try:
        data = door.read(path, in_force().xml_size)
    except (Refused, OSError):  # reported when the model is read
        return False
    names = {os.fsdecode(name) for name in _NAMED.findall(data)}
    folders = {main, path.parent}
    return any(map(is_recipe, names)) or any(
        _reaches(Path(join(str(folder), name)), main, door, seen=seen) for name in names for folder in folders
    )


def _recipes(path: Path, door: Door, context: Context, seen: set[Path]) -> Iterator[tuple[Path, Path, Span]]:
    seen.add(path)
    unit = parse_file(path, Sink(), file=context.shown(path), door=door)
    for element in () if unit is None else unit.root.iterfind("asset/model"):
        assert unit is not None
        inner = Path(join(str(unit.directory), str(element.get("file") or "")))
        if inner in seen:
            continue
        if not is_recipe(inner.name):
            yield from _recipes(inner, door, context, seen=seen)
            continue
        seen.add(inner)
        span = unit.origins.span(element, unit.file, "file")
        try:
            door.admit(inner)
        except Refused as refused:
            refused.report(context.sink, span, shown=context.shown)
        else:
            yield inner, unit.directory, span

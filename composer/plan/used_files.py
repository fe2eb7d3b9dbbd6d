"""The files that a plan reads: every source with its model file, the files that this names, and the licences."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.document.node import locate
from composer.plan.plan import Plan
from composer.plan.steps.add_element import AddElement
from composer.plan.steps.append_element import AppendElement
from composer.reading.door import Door
from composer.recipe.element import Element
from composer.recipe.fault import Path as Place
from composer.sources import ros_package
from composer.sources.source import Source
from composer.tree.files import CUBE, file_attributes, join, written_path
from composer.tree.parse import parse_file
from composer.urdf.robot import SCHEMES
from composer.urdf.template import files_named, is_template

_MESH = re.compile(r"""\bfilename\s*=\s*["']([^"']+)["']""")
_FILE = re.compile(r"""\bfile\w*\s*=\s*["']([^"']+)["']""")


def files_of_source(source: Source) -> Iterator[Path]:
    """Yield the files of a model that exist and that it may read.

    Files that are missing, broken or outside are reported where they are read.
    """
    found = _of_urdf(source) if source.format == "urdf" else _of_mjcf(source.path, source.door, set())
    seen = (path for path in found if source.door.sees(path))
    yield from (path for path in (*seen, *source.licences) if os.path.isfile(path))


def files_of_recipe(plan: Plan, context: Context) -> Iterator[Path]:
    """Yield the files that a recipe itself names in its elements and may name."""
    folder = context.folder
    for step in plan.steps:
        if isinstance(step, AddElement | AppendElement):
            for at, name in _named(step.element):
                beside = folder / locate(plan.document, at).file  # this recipe, or one that it extends
                path = Path(join(str(beside.parent), name))
                if context.door_of_text(beside.parent).sees(path) and os.path.isfile(path):
                    yield path


def _named(element: Element) -> Iterator[tuple[Place, str]]:
    if element.xml is not None:
        yield from (((*element.at, "xml"), name) for name in _FILE.findall(element.xml))
    for attribute in ("file", *CUBE):
        if isinstance(value := element.attributes.get(attribute), str):
            yield (*element.at, attribute), value
    for child in element.children:
        yield from _named(child)


def _of_mjcf(path: Path, door: Door, seen: set[Path]) -> Iterator[Path]:
    if path in seen:
        return
    seen.add(path)
    yield path
    unit = parse_file(path, Sink(), door=door) if door.sees(path) else None
    if unit is None:
        return
    yield from map(Path, unit.origins.texts)  # the included files too
    for element, _, name in file_attributes(unit.root):
        yield Path(join(str(unit.directory), written_path(unit.settings, element, name)))
    for model in unit.root.iterfind("asset/model"):
        if inner := model.get("file"):
            yield from _of_mjcf(Path(join(str(unit.directory), inner)), door, seen)


def _of_urdf(source: Source) -> Iterator[Path]:
    yield source.path
    try:
        text = source.door.read(source.path).decode("utf-8", "replace")
    except OSError:
        return
    given = dict(source.packages)
    if is_template(source.path, text.encode()):
        yield from files_named(
            source.path, text.encode(), source.door, packages=ros_package.all_folders(source.path, given)
        )
        return
    packages = ros_package.folders(ros_package.packages_in(text), source.path, given)
    for name in _MESH.findall(text):
        scheme = next((each for each in SCHEMES if name.startswith(each)), "")
        package, _, inside = name.removeprefix(scheme).partition("/")
        if scheme:
            if package in packages:
                yield packages[package] / inside
        else:
            name = name.removeprefix("file://")
            yield source.path.parent / name
            yield source.path.parent / Path(name).name

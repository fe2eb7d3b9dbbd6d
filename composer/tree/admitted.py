"""Check that a model names only files that it may read and MuJoCo can cope with, before MuJoCo opens them itself."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.reading.refused import Refused
from composer.tree.file_text import FileText
from composer.tree.files import file_attributes, join, written_path
from composer.tree.mesh_points import check_meshes
from composer.tree.parse import parse_file, parse_xml
from composer.tree.unit import Unit


class _Use(NamedTuple):
    """An attribute of a model, or of one that it attaches, and the file that it names."""

    unit: Unit
    element: Node
    attribute: str
    path: str


def all_admitted(unit: Unit, sink: Sink, shown: Callable[[Path], str] | None = None) -> bool:
    """Return whether the door of a model admits all files that it names; report the others at their places.

    Meshes with more points than the limit are reported too. Included files were read with the model. Attached models
    are read here, with all files that they name.
    """
    before = sink.error_count
    check_meshes(unit, 0, sink)
    for use in _named(unit, sink, shown or str, seen=set()):
        try:
            unit.door.admit(use.path)
        except Refused as refused:
            refused.report(
                sink, use.unit.origins.span(use.element, use.unit.file, use.attribute), shown=shown
            )
    return sink.error_count == before


def _named(unit: Unit, sink: Sink, shown: Callable[[Path], str], seen: set[str]) -> Iterator[_Use]:
    directory = str(unit.directory)
    for element, attribute, name in file_attributes(unit.root):
        written = written_path(unit.settings, element, name)
        if written not in unit.contents:
            yield _Use(unit, element, attribute, path=join(directory, written))
    for element in unit.root.iterfind("asset/model"):
        name = str(element.get("file") or "")
        path = join(directory, name)
        if not name or name in unit.contents or path in seen:
            continue
        seen.add(path)
        use = _Use(unit, element, "file", path=path)
        yield use
        if unit.door.exists(path):
            aside = Sink()
            inner = parse_file(Path(path), aside, file=shown(Path(path)), door=unit.door)
            for each in aside.errors:
                if each.code == "source-outside":
                    sink.add(each)  # an include; other errors are reported when the model is linked
            if inner is not None:
                check_meshes(inner, 0, sink)
                yield from _named(inner, sink, shown, seen=seen)


def includes_admitted(urdf: Unit, sink: Sink, shown: Callable[[Path], str] | None = None) -> bool:
    """Return whether a URDF includes only files that it may read; some versions of MuJoCo read its includes."""
    before = sink.error_count
    waiting = [(urdf.root, urdf.file, urdf.directory)]
    seen: set[Path] = set()
    while waiting:
        root, file, folder = waiting.pop()
        for element in root.iter("include"):
            path = Path(join(str(folder), str(element.get("file") or "")))
            try:
                urdf.door.admit(path)
                data = urdf.door.read(path) if os.path.isfile(path) and path not in seen else b""
            except Refused as refused:
                refused.report(sink, urdf.origins.span(element, file, "file"), shown=shown)
                continue
            except OSError:  # MuJoCo reports it if it reads the file
                continue
            seen.add(path)
            inner = parse_xml(data, str(path), Sink()) if data else None
            if inner is not None:
                urdf.origins.texts[str(path)] = FileText(path, data)
                waiting.append((inner, str(path), path.parent))
    return sink.error_count == before

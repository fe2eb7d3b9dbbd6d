"""Files that edits name."""

from __future__ import annotations

import os
from pathlib import Path

from lxml.etree import _Element as Node

from composer.compose.editing import Editing
from composer.diagnostics.span import Span
from composer.link.submodels import add_named_file
from composer.reading.door import Door
from composer.reading.refused import Refused
from composer.tree.files import written_path


def take_files(editing: Editing) -> None:
    """Resolve the files that edits name relative to the recipe. They replace those that the elements named before."""
    making, linking = editing.making, editing.linking
    for node, attribute, name in making.files:
        folder, door, span = (
            making.folder_of(node, attribute), making.door_of(node, attribute), making.span_of(node, attribute),
        )  # fmt: skip
        linking.files = [
            use for use in linking.files if use.element is not node or use.attribute != attribute
        ]
        if editing.own:
            _take_own_file(
                editing, node, attribute, file=Path(os.path.realpath(folder / name)), door=door, span=span
            )
        else:
            add_named_file(linking, folder, node, attribute=attribute, name=name, door=door, span=span)
    making.files.clear()


def _take_own_file(editing: Editing, node: Node, attribute: str, file: Path, door: Door, span: Span) -> None:
    """Add a file to the part. The part's own access rules do not apply, because the recipe names the file."""
    try:
        door.admit(file)
    except Refused as refused:
        refused.report(editing.sink, span)
        return
    unit = editing.linking.base
    node.set(attribute, file.as_posix())
    unit.contents = {**unit.contents, written_path(unit.settings, node, file.as_posix()): file}

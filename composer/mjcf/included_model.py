"""Take over the files of `<model>` elements from another model."""

from __future__ import annotations

import os
import posixpath
from pathlib import Path

from lxml.etree import _Element as Node

from composer.mjcf.asset import Files
from composer.mjcf.model import Model
from composer.tree.files import join
from composer.tree.unit import Unit


def take_model(model: Model, source: Unit, element: Node) -> None:
    """Set the file of a `<model>` element that was moved from `source` to `model`, so that it is the same file.

    For a file in memory, everything in its folder is taken over too, because it may refer to files there.
    """
    file = join("", str(element.get("file")))
    known = source.contents.get(file)
    if not isinstance(known, bytes):
        files: dict[str, bytes | Path] = {file: known or Path(join(str(source.directory), file))}
        stem, suffix = posixpath.splitext(file)
        number = 1
        while not _are_free(model, files):
            number += 1
            files = {f"{stem}-{number}{suffix}": next(iter(files.values()))}
        name = next(iter(files))
    else:
        beside = posixpath.dirname(file)
        theirs = {
            path: source.contents[path]
            for path in (*source.contents, file)
            if not beside or path.startswith(f"{beside}/")
        }
        files, number, name = theirs, 1, file
        while not _are_free(model, files):
            number += 1
            folder = f"{source.label}-{number}"
            files = {f"{folder}/{path}": content for path, content in theirs.items()}
            name = f"{folder}/{file}"
    element.set("file", name)
    before = model.unit.contents
    model.unit.contents = (before if isinstance(before, Files) else Files(before)).with_files(files)


def _are_free(model: Model, files: dict[str, bytes | Path]) -> bool:
    """Return whether none of these paths is used by a different file."""
    directory, known = str(model.unit.directory), dict(model.unit.contents)
    for path, content in files.items():
        there = Path(join(directory, path))
        if known.get(path, there if os.path.exists(there) else content) != content:
            return False
    return True

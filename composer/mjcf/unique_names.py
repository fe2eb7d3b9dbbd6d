"""Give files in memory unique names, because there MuJoCo only looks at the last part of a path."""

from __future__ import annotations

import posixpath
from collections.abc import Iterable, Mapping, Sequence

from lxml import etree
from lxml.etree import _Element as Node

from composer.link.linking import FileUse
from composer.tree.files import CUBE, NAMED_AFTER_FILE, stem
from composer.tree.write import write


def with_unique_names(files: Sequence[FileUse]) -> list[tuple[FileUse, str]]:
    """Return each file with a path, so that no two paths end in the same file name. Sub-models use these paths too."""
    taken: dict[str, str] = {}
    names = {use.path: _free(use.path, taken) for use in files}
    return [(_rewritten(use, names) if _is_model(use) else use, names[use.path]) for use in files]


def is_inner(use: FileUse, files: Iterable[FileUse]) -> bool:
    """Return whether a file is used by a sub-model and not by the model itself."""
    return not use.shared and any(use.path.startswith(_folder(each)) for each in files if _is_model(each))


def rename_file(element: Node, attribute: str, file: str) -> None:
    """Set the file path of an element. If the element is named after its file, it keeps that name."""
    if attribute == "file" and element.tag in NAMED_AFTER_FILE and not element.get("name"):
        element.set("name", stem(str(element.get("file"))))
    element.set(attribute, file)


def _free(path: str, taken: dict[str, str]) -> str:
    folder, _, base = path.rpartition("/")
    stem, suffix = posixpath.splitext(base)
    number, name = 1, base
    while taken.setdefault(name.lower(), path) != path:
        number += 1
        name = f"{stem}-{number}{suffix}"
    return f"{folder}/{name}"


def _is_model(use: FileUse) -> bool:
    return not use.shared and use.path.endswith(".xml")


def _folder(model: FileUse) -> str:
    """Return the folder of a sub-model's files."""
    return f"{model.path.removesuffix('.xml')}/"


def _rewritten(model: FileUse, names: Mapping[str, str]) -> FileUse:
    """Return the sub-model with the new names of its files, which are relative to its own folder."""
    start = f"{posixpath.dirname(model.path)}/"
    changed = {
        path.removeprefix(start): name.removeprefix(start)
        for path, name in names.items()
        if path != name and path.startswith(_folder(model))
    }
    if not changed or model.content is None:
        return model
    root = etree.fromstring(model.content)
    for element in root.iter("*"):
        for attribute in ("file", *CUBE):
            new = changed.get(str(element.get(attribute)))
            if new is not None:
                rename_file(element, attribute, new)
    return model._replace(content=write(root))

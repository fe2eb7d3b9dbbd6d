"""Write a model as a unit alone if only the folders of its files change: this copies no tree."""

from __future__ import annotations

import re

from composer.link.compiler import FOLDERS
from composer.link.files import ASSETS, is_settled
from composer.mjcf.model import Model
from composer.mjcf.pruning import empty
from composer.tree.files import file_attributes, is_plain
from composer.tree.unit import Unit
from composer.tree.write import to_text

_FILE = ' file="'
_COMPILER = "<compiler"


def relocated_text(model: Model, label: str) -> str | None:
    """Return the text that the linker would give for the model alone, or None if more than folders would change.

    Text is only replaced if it occurs as often in the text as in the tree, so that a comment that looks like an
    attribute is not replaced by mistake.
    """
    unit = model.unit
    if model.attachments or unit.contents or not re.fullmatch(r"[\w.-]+", label):
        return None
    files = _plain_files(unit)
    if files is None or next(empty(unit), None) is not None:
        return None
    text = to_text(unit.root)
    moving, staying = files
    if moving and (staying or text.count(_FILE) != moving):
        return None
    return _without_folders(unit, text.replace(_FILE, f"{_FILE}{ASSETS}/{label}/") if moving else text)


def _plain_files(unit: Unit) -> tuple[int, int] | None:
    """Return how many files move to the label's folder, and how many stay.

    Return None if a path has to be shortened, if two file names are equal, or if a file has to be read.
    """
    if any(
        next(section.iterchildren("model"), None) is not None for section in unit.root.iterchildren("asset")
    ):
        return None
    seen = set()
    moving = staying = 0
    for element, attribute, name in file_attributes(unit.root):
        tag = element.tag
        if attribute != "file" or tag == "skin" or not is_plain(name):
            return None
        seen.add(name[name.rfind("/") + 1 :].lower())
        if name.startswith(ASSETS) and is_settled(unit, tag, name):
            staying += 1
        else:
            moving += 1
    return (moving, staying) if len(seen) == moving + staying else None


def _without_folders(unit: Unit, text: str) -> str | None:
    compilers = list(unit.root.iterchildren("compiler"))
    if not compilers:
        return text
    compiler = compilers[0]
    if len(compilers) > 1 or len(compiler) or compiler.text or text.count(_COMPILER) > 1:
        return None
    if compiler.get("strippath") is not None or next(unit.root.iterchildren("*")) is not compiler:
        return None
    kept = {str(name): str(value) for name, value in compiler.items() if name not in FOLDERS}
    if not kept:
        return None
    start = text.index(_COMPILER)
    end = text.index("/>", start)
    return text[:start] + to_text(compiler.makeelement("compiler", kept)).rstrip()[:-2] + text[end:]

"""Pass: `<model>` assets, which MuJoCo attaches itself: each goes into the bundle with the files it needs.

A sub-model keeps its own compiler settings, because MuJoCo reads it as a model of its own; only its folders change.
"""

from __future__ import annotations

import os
from pathlib import Path

from lxml.etree import _Element as Node

from composer.link.compiler import FOLDERS
from composer.link.files import ASSETS, inside
from composer.link.linking import FileUse, Linking
from composer.tree.files import file_attributes, join, written_path
from composer.tree.parse import parse_file
from composer.tree.unit import Unit
from composer.tree.write import write


def submodels(linking: Linking) -> None:
    """Bundle the sub-models of every unit below `assets/LABEL/models/`."""
    policies = [linking.base_keyframes, *(part.keyframes for part in linking.parts)]
    for unit, policy in zip(linking.units, policies, strict=True):
        for element in unit.root.iter("model"):
            file = element.get("file")
            if file:
                _bundle(linking, unit, element, str(file), f"{ASSETS}/{unit.label}/models", policy != "none")


def _bundle(linking: Linking, unit: Unit, element: Node, file: str, folder: str, keyed: bool) -> None:
    known = unit.contents.get(file)
    source = str(known) if isinstance(known, Path) else join(str(unit.directory), file)
    if isinstance(known, bytes):
        _bundled_before(linking, unit, element, file, known)
        return
    before = linking.sink.error_count
    shown = _shown(unit, source) if known is None else source
    sub = parse_file(Path(source), linking.sink, file=shown, span=linking.span(unit, element, "file"))
    if sub is None or linking.sink.error_count > before:
        return
    if not element.get("name"):
        element.set("name", sub.model)
    path = _free(linking, f"{folder}/{sub.label}" + ("" if keyed else "-without-keys"), source)
    for section in list(sub.root.iterchildren("keyframe")) if not keyed else ():
        sub.root.remove(section)
    _own_files(linking, sub, path, keyed)
    sub.origins.own(sub.root, shown)
    unit.origins.adopt(sub.origins)  # a file that it lacks is told where it names it
    element.set("file", f"{path}.xml")
    linking.files.append(FileUse(element, "file", f"{path}.xml", source, write(sub.root), shared=False))


def _shown(unit: Unit, source: str) -> str:
    """The sub-model as messages name it: beside the file of the unit."""
    inside = os.path.relpath(source, unit.directory)
    return os.path.normpath(os.path.join(os.path.dirname(unit.file), inside))


def _bundled_before(linking: Linking, unit: Unit, element: Node, file: str, model: bytes) -> None:
    """The sub-model of a composition: its files stand beside it, in a folder of its name."""
    taken = {use.path: use.content for use in linking.files}
    folder, name = file.rsplit("/", 1)
    number, free = 1, folder
    while taken.get(f"{free}/{name}", model) != model:
        number += 1
        free = f"{folder}-{number}"
    element.set("file", f"{free}/{name}")
    linking.files.append(FileUse(element, "file", f"{free}/{name}", file, model, shared=False))
    for path, content in unit.contents.items():
        if path.startswith(file.removesuffix(".xml") + "/"):
            moved = free + path.removeprefix(folder)
            data = content if isinstance(content, bytes) else None
            linking.files.append(
                FileUse(element, "file", moved, str(content if data is None else path), data, shared=False)
            )


def _free(linking: Linking, path: str, source: str) -> str:
    taken = {use.path: use.source for use in linking.files}
    number, free = 1, path
    while taken.get(f"{free}.xml", source) != source:
        number += 1
        free = f"{path}-{number}"
    return free


def _own_files(linking: Linking, sub: Unit, path: str, keyed: bool) -> None:
    """Files of a sub-model stand in a folder beside it, and it names them from where it is."""
    beside = path.rsplit("/", 1)[1]
    taken: dict[str, str] = {}
    for element, attribute, file in file_attributes(sub.root):
        written = written_path(sub.settings, element, file)
        source = join(str(sub.directory), written)
        below = name = inside(sub.settings, written)
        number = 1
        while taken.setdefault(name.lower(), source) != source:
            number += 1
            name = f"{number}/{below}"
        element.set(attribute, f"{beside}/{name}")
        linking.files.append(FileUse(element, attribute, f"{path}/{name}", source, None, shared=False))
    for nested in sub.root.findall("asset/model"):
        model_file = nested.get("file")
        if model_file:
            inner = f"{path}/models"
            _bundle(linking, sub, nested, model_file, inner, keyed)
            nested.set("file", f"{beside}/models/" + str(nested.get("file")).rsplit("/", 1)[-1])
    for compiler in sub.root.iterchildren("compiler"):
        for name in FOLDERS:
            if name in compiler.attrib:
                del compiler.attrib[name]

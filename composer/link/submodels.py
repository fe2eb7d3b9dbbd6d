"""Pass: `<model>` assets, which MuJoCo attaches itself: each goes into the bundle with the files it needs.

A sub-model keeps its own compiler settings, because MuJoCo reads it as a separate model; only its folders change.
"""

from __future__ import annotations

import hashlib
import os
import posixpath
from contextlib import suppress
from pathlib import Path

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.limits import advice, in_force
from composer.link.compiler import FOLDERS
from composer.link.files import ASSETS, add_file, inside
from composer.link.linking import FileUse, Linking
from composer.reading.door import Door, Passed, held
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.tree.files import file_attributes, join, written_path
from composer.tree.from_folder import FromFolder
from composer.tree.parse import parse_file, parse_text
from composer.tree.unit import Unit
from composer.tree.write import write


def submodels(linking: Linking) -> None:
    """Bundle the sub-models of every unit below `assets/LABEL/models/`.

    >>> from composer.link.example import after
    >>> part = '<asset><model file="m.xml"/></asset>'
    >>> after(submodels, part, files={"m.xml": '<mujoco model="hand"/>'})
    part: <asset><model file="assets/part/models/m.xml" name="hand"/></asset>
    """
    policies = [linking.request.base_keyframes, *(part.keyframes for part in linking.parts)]
    for unit, policy in zip(linking.units, policies, strict=True):
        for element in unit.root.iter("model"):
            file = element.get("file")
            if file:
                with suppress(_TooManyError):
                    _bundle(
                        linking, unit, element, str(file), f"{ASSETS}/{unit.label}/models", policy != "none"
                    )


def add_named_file(
    linking: Linking, folder: Path, element: Node, attribute: str, name: str, door: Door, span: Span
) -> None:
    """Add a file that a recipe names, and for a `<model>` also the files it needs. See `add_file`."""
    if element.tag != "model":
        add_file(linking, folder, element, attribute, name, door, span)
        return
    base = linking.base
    recipe = Unit(base.root, span.file, folder, "", origins=base.origins, door=door)
    with suppress(_TooManyError):
        _bundle(linking, recipe, element, name, f"{ASSETS}/models", linking.request.base_keyframes != "none")


def _bundle(
    linking: Linking,
    unit: Unit,
    element: Node,
    file: str,
    folder: str,
    keyed: bool,
    above: tuple[str, ...] = (),
) -> None:
    """Bundle a model that another one refers to. `above` are the models that lead to it."""
    known = unit.contents.get(file)
    source = held(known if isinstance(known, Path) else join(str(unit.directory), file))
    if isinstance(known, bytes):
        if _is_bundled(file):
            _bundled_before(linking, unit, element, file, known)
            return
        source = held(f"{source}#{hashlib.sha256(known).hexdigest()}")  # two may have one path
    if source in above:
        linking.sink.error(
            "source-cycle",
            f"the model `{file}` is made of itself",
            linking.span(unit, element, "file"),
            help="MuJoCo attaches a copy of what is named here: take this `<model>` out, or name another file",
        )
        return
    _count(linking, unit, element, len(above))
    before = linking.sink.error_count
    if isinstance(known, bytes):
        shown, sub = file, parse_held(unit, file, known, linking.sink)
    else:
        shown = _shown(unit, source) if known is None else source
        at = linking.span(unit, element, "file")
        door = door_of_submodel(unit, Path(source), known)
        sub = parse_file(Path(source), linking.sink, file=shown, span=at, door=door)
    if sub is None or linking.sink.error_count > before:
        return
    # MuJoCo calls a `<model>` without a name after the `model` attribute in its file. Written here, the name stays
    # where the file is read as another one of the bundle.
    if not element.get("name"):
        element.set("name", sub.model)
    path = _free(linking, f"{folder}/{sub.label}" + ("" if keyed else "-without-keys"), source)
    for section in list(sub.root.iterchildren("keyframe")) if not keyed else ():
        sub.root.remove(section)
    _own_files(linking, sub, path, keyed, (*above, source))
    linking.notes.attached[element] = sub.root
    sub.origins.own(sub.root, shown)
    unit.origins.adopt(sub.origins)  # a file that it lacks is reported where it names it
    element.set("file", f"{path}.xml")
    linking.files.append(FileUse(element, "file", f"{path}.xml", source, write(sub.root), shared=False))


class _TooManyError(Exception):
    """Too many sub-models, or too deeply nested ones. It has been reported; the rest of the model is skipped."""


def _count(linking: Linking, unit: Unit, element: Node, depth: int) -> None:
    """Count one more sub-model, because models that each refer to two others would grow without end."""
    limits = in_force()
    linking.submodels += 1
    if depth >= limits.nesting:
        message = f"models name one another too deep; {limits.nesting} in one another are allowed"
        limit = "nesting"
    elif linking.submodels > limits.submodels:
        message = f"there are more than {limits.submodels} models that models attach"
        limit = "submodels"
    else:
        return
    linking.sink.error("limit-exceeded", message, linking.span(unit, element, "file"), help=advice(limit))
    raise _TooManyError


def parse_held(unit: Unit, file: str, data: bytes, sink: Sink) -> Unit | None:
    """Parse a sub-model in memory. Its files are in memory too, relative to its own folder."""
    folder, _, name = join("", file).rpartition("/")
    return parse_text(
        data,
        sink,
        file=file,
        directory=Path(join(str(unit.directory), folder)) if folder else unit.directory,
        label=posixpath.splitext(name)[0],
        contents=FromFolder(unit.contents, folder),
        door=unit.door,
    )


def door_of_submodel(unit: Unit, path: Path, known: bytes | Path | None) -> Door:
    """Return what a sub-model may read: the same as the model, and for one that a recipe names also its own folder."""
    return unit.door if known is None else unit.door.wider((path.parent,))


def _is_bundled(file: str) -> bool:
    """Return whether a sub-model is in the place where this pass puts sub-models."""
    steps = file.split("/")
    return len(steps) == 4 and steps[0] == ASSETS and steps[2] == "models"


def _shown(unit: Unit, source: str) -> str:
    """Return the path of the sub-model for messages, next to the file of the unit."""
    inside = os.path.relpath(source, unit.directory)
    return os.path.normpath(os.path.join(os.path.dirname(unit.file), inside))


def _bundled_before(linking: Linking, unit: Unit, element: Node, file: str, model: bytes) -> None:
    """Bundle the sub-model of a composition, whose files are next to it in a folder with its name."""
    taken = {use.path: use.content if use.content is not None else Path(use.source) for use in linking.files}
    folder = file.rsplit("/", 1)[0]
    start = file.removesuffix(".xml") + "/"
    files = {path: content for path, content in unit.contents.items() if path.startswith(start)}
    files = {path.removeprefix(folder): content for path, content in {file: model, **files}.items()}
    number, free = 1, folder
    while any(not _alike(taken.get(free + path, content), content) for path, content in files.items()):
        number += 1
        free = f"{folder}-{number}"
    element.set("file", free + file.removeprefix(folder))
    if (again := parse_held(unit, file, model, Sink())) is not None:
        linking.notes.attached[element] = again.root
    for path, content in files.items():
        data = content if isinstance(content, bytes) else None
        source = held(folder + path if isinstance(content, bytes) else content)
        linking.files.append(FileUse(element, "file", free + path, source, data, shared=False))


def _alike(one: bytes | Path, other: bytes | Path) -> bool:
    """Return whether two files, in memory or on disk, have the same bytes."""
    if one == other:
        return True
    try:
        return _data(one) == _data(other)
    except OSError:  # reported where all files are read
        return False


def _data(file: bytes | Path) -> bytes:
    return file if isinstance(file, bytes) else read_regular(file)


def _free(linking: Linking, path: str, source: str) -> str:
    taken = {use.path: use.source for use in linking.files}
    number, free = 1, path
    while taken.get(f"{free}.xml", source) != source:
        number += 1
        free = f"{path}-{number}"
    return free


def _admitted(linking: Linking, sub: Unit, element: Node, attribute: str, written: str) -> Passed | None:
    try:
        return sub.door.admit(join(str(sub.directory), written))
    except Refused as refused:
        refused.report(linking.sink, linking.span(sub, element, attribute))
        return None


def _own_files(linking: Linking, sub: Unit, path: str, keyed: bool, above: tuple[str, ...]) -> None:
    """Bundle the files of a sub-model in a folder next to it. Its paths to them are relative to its own folder."""
    beside = path.rsplit("/", 1)[1]
    taken: dict[str, str] = {}
    for element, attribute, file in file_attributes(sub.root):
        written = written_path(sub.settings, element, file)
        known = sub.contents.get(written)
        if known is None:
            source = _admitted(linking, sub, element, attribute, written)
        else:
            source = held(known if isinstance(known, Path) else join(str(sub.directory), written))
        if source is None:
            continue
        below = name = inside(sub.settings, written)
        number = 1
        while taken.setdefault(name.lower(), source) != source:
            number += 1
            name = f"{number}/{below}"
        element.set(attribute, f"{beside}/{name}")
        content = known if isinstance(known, bytes) else None
        linking.files.append(FileUse(element, attribute, f"{path}/{name}", source, content, shared=False))
    for nested in sub.root.findall("asset/model"):
        model_file = nested.get("file")
        if model_file:
            inner = f"{path}/models"
            _bundle(linking, sub, nested, model_file, inner, keyed, above)
            nested.set("file", f"{beside}/models/" + str(nested.get("file")).rsplit("/", 1)[-1])
    # Its files are named from where it stands now: MuJoCo would put the folders in front of that once more.
    for compiler in sub.root.iterchildren("compiler"):
        for name in FOLDERS:
            if name in compiler.attrib:
                del compiler.attrib[name]

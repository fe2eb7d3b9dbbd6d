"""Pass: every file of every unit gets a path in the bundle, and the attribute that names the file gets that path."""

from __future__ import annotations

from pathlib import Path

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.link.linking import FileUse, Linking
from composer.reading.door import Door, Passed, held
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.tree.files import file_attributes, is_absolute, is_plain, join, written_path
from composer.tree.names import WORLD
from composer.tree.settings import Settings
from composer.tree.skin_file import BadSkin, rename_bones
from composer.tree.unit import Unit

ASSETS = "assets"
# Where each path of the bundle comes from, by the path in lower case: some file systems do not distinguish cases.
Taken = dict[str, tuple[str, bytes | None]]


def files(linking: Linking) -> None:
    """Store each file as `assets/LABEL/path`. Units with the same label share a folder unless their paths clash.

    >>> from composer.link.example import after
    >>> part = '<compiler meshdir="meshes"/><asset><mesh file="link.obj"/></asset>'
    >>> after(files, part)
    part: <asset><mesh file="assets/part/link.obj"/></asset>
    """
    # Parts of one source share its files: the same path is taken by the same bytes only.
    taken: Taken = {}
    for prefix, unit in [("", linking.base), *((part.prefix, part.unit) for part in linking.parts)]:
        named = list(file_attributes(unit.root))
        if named:
            _give_paths(linking, unit, prefix, named, taken)


def _give_paths(
    linking: Linking, unit: Unit, prefix: str, named: list[tuple[Node, str, str]], taken: Taken
) -> None:
    directory = str(unit.directory)
    folders = {"texture": join(directory, unit.settings.texture_folder)}
    mesh_folder = join(directory, unit.settings.mesh_folder)
    simple = not unit.contents and unit.settings.strippath != "true"
    target = f"{ASSETS}/{unit.label}/"
    use = linking.files.append
    # Of most files no path has to be shortened.
    plain = [
        f"{folders.get(element.tag, mesh_folder)}/{name}"
        if simple and element.tag != "skin" and is_plain(name)
        else ""
        for element, _, name in named
    ]
    listed = unit.door.admit_listed(filter(None, plain))
    for (element, attribute, name), where in zip(named, plain, strict=True):
        tag = element.tag
        if where:
            path = name if "/" in name and is_settled(unit, tag, name) else target + name
            source = listed.get(where) or _admitted(linking, unit, element, attribute, where)
            if source is None:
                continue
            alone: tuple[str, bytes | None] = (source, None)
            if taken.setdefault(path.lower(), alone) == alone:
                element.set(attribute, path)
                use(FileUse(element, attribute, path, source, None))
                continue
        written = written_path(unit.settings, element, name)
        known = unit.contents.get(written) if unit.contents else None
        content = known if isinstance(known, bytes) else None
        if known is None:
            source = _admitted(linking, unit, element, attribute, join(directory, written))
        else:
            source = held(known if isinstance(known, Path) else join(directory, written))
        if source is None:
            continue
        if prefix and tag == "skin":
            content = _skin(linking, unit, element, prefix, source, content)
        path = _free(unit, tag, written, source, content, taken)
        element.set(attribute, path)
        use(FileUse(element, attribute, path, source, content))


def _admitted(linking: Linking, unit: Unit, element: Node, attribute: str, path: str) -> Passed | None:
    """Return the path that a unit refers to, or None if the unit may not read it, which is reported."""
    try:
        return unit.door.admit(path)
    except Refused as refused:
        refused.report(linking.sink, linking.span(unit, element, attribute))
        return None


def _skin(
    linking: Linking, unit: Unit, element: Node, prefix: str, source: Passed, content: bytes | None
) -> bytes | None:
    """Return the content of a skin file with the prefix on the names of its bodies."""
    try:
        data = read_regular(source) if content is None else content
        return rename_bones(data, lambda name: name if name == WORLD else prefix + name)
    except OSError:
        return content  # reported where all files are read
    except BadSkin as fault:
        linking.sink.error("not-supported", f"`{source}`: {fault}", linking.span(unit, element))
        return content


def is_settled(unit: Unit, tag: object, name: str) -> bool:
    """Return whether the path is one of a composition: `assets/LABEL/…` without a folder from the compiler."""
    if not name.startswith(f"{ASSETS}/") or name.count("/") < 2:
        return False
    settings = unit.settings
    return not (settings.texture_folder if tag == "texture" else settings.mesh_folder)


def _free(unit: Unit, tag: object, written: str, source: str, content: bytes | None, taken: Taken) -> str:
    below = inside(unit.settings, written)
    path = f"{ASSETS}/{unit.label}/{below}"
    if is_settled(unit, tag, written):
        path = written
    # A bundle may be unpacked where upper and lower case are one: `A.obj` and `a.obj` get different paths.
    key = path.lower()
    if key not in taken:
        taken[key] = (source, content)
        return path
    _, label, below = path.split("/", 2)
    number = 1
    while True:
        if taken.setdefault(path.lower(), (source, content)) == (source, content):
            return path
        number += 1
        path = f"{ASSETS}/{label}-{number}/{below}"


def inside(settings: Settings, written: str) -> str:
    """Return the path below the unit's own asset folder, which is not repeated in the bundle."""
    if is_absolute(written):
        return written.rsplit("/", 1)[-1]
    for folder in (settings.mesh_folder, settings.texture_folder):
        if folder and written.startswith(start := join("", folder) + "/"):
            written = written[len(start) :]
            break
    # Such a step would lead out of the bundle.
    if ".." in written:
        return "/".join(step for step in written.split("/") if step != "..")
    return written


def add_file(
    linking: Linking, folder: Path, element: Node, attribute: str, name: str, door: Door, span: Span
) -> None:
    """Add a file from the recipe. Its path is relative to the recipe, and it is stored below `assets/` as for parts.

    `door` is that of the recipe, `span` where it names the file.
    """
    try:
        source = door.admit(join(str(folder), name))
    except Refused as refused:
        refused.report(linking.sink, span)
        return
    inside = "/".join(step for step in name.replace("\\", "/").split("/") if step not in ("..", ".", ""))
    path, number = f"{ASSETS}/{inside}", 1
    taken = {use.path.lower(): use.source for use in linking.files}
    while taken.get(path.lower(), source) != source:
        number += 1
        path = f"{ASSETS}/{number}/{inside}"
    element.set(attribute, path)
    linking.files.append(FileUse(element, attribute, path, source, None))

"""Pass: every file of every unit gets a path in the bundle, and the attribute that names it says that path."""

from __future__ import annotations

from pathlib import Path

from lxml.etree import _Element as Node

from composer.link.linking import FileUse, Linking
from composer.tree.files import disk_path, file_attributes, is_absolute, join, written_path
from composer.tree.skin_file import BadSkin, rename_bones
from composer.tree.unit import Unit

ASSETS = "assets"


def files(linking: Linking) -> None:
    """`assets/LABEL/path` for each file; two units of one label share a folder only while no path clashes."""
    taken: dict[str, tuple[str, bytes | None]] = {}
    prefixes = [("", linking.base), *((part.prefix, part.unit) for part in linking.parts)]
    for prefix, unit in prefixes:
        for element, attribute in file_attributes(unit.root):
            written = written_path(unit, element, attribute)
            known = unit.contents.get(written)
            source = str(known) if isinstance(known, Path) else disk_path(unit, written)
            content = known if isinstance(known, bytes) else None
            if element.tag == "skin" and prefix:
                content = _skin(linking, unit, element, prefix, source, content)
            path = _free(unit, written, source, content, taken)
            element.set(attribute, path)
            linking.files.append(FileUse(element, attribute, path, source, content))


def _skin(
    linking: Linking, unit: Unit, element: Node, prefix: str, source: str, content: bytes | None
) -> bytes | None:
    """A skin file names bodies; those get the prefix too."""
    try:
        data = Path(source).read_bytes() if content is None else content
        return rename_bones(data, lambda name: prefix + name)
    except OSError:
        return content  # told where all files are read
    except BadSkin as fault:
        linking.sink.error("not-supported", f"`{source}`: {fault}", linking.span(unit, element))
        return content


def _free(
    unit: Unit, written: str, source: str, content: bytes | None, taken: dict[str, tuple[str, bytes | None]]
) -> str:
    if written in unit.contents and written.startswith(f"{ASSETS}/"):  # a composed unit: its paths are settled
        _, label, inside = written.split("/", 2)
    else:
        label, inside = unit.label, _inside(unit, written)
    number = 1
    while True:
        path = f"{ASSETS}/{label}/{inside}" if number == 1 else f"{ASSETS}/{label}-{number}/{inside}"
        if taken.setdefault(path.lower(), (source, content)) == (source, content):
            return path
        number += 1


def _inside(unit: Unit, written: str) -> str:
    relative = _relative(unit, written)
    if ".." in relative or "//" in relative or relative.startswith("/"):
        return "/".join(step for step in relative.split("/") if step not in ("..", ".", ""))
    return relative


def _relative(unit: Unit, written: str) -> str:
    """The path below the unit's own asset folder, which need not be repeated in the bundle."""
    if is_absolute(written):
        return written.rsplit("/", 1)[-1]
    for folder in (unit.settings.mesh_folder, unit.settings.texture_folder):
        start = folder.replace("\\", "/").strip("/").removeprefix("./") + "/"
        if len(start) > 1 and written.startswith(start):
            return written[len(start) :]
    return written


def add_file(linking: Linking, folder: Path, element: Node, attribute: str, name: str) -> None:
    """A file that the recipe names: relative to the recipe, stored below `assets/` like those of parts."""
    source = join(str(folder), name)
    inside = "/".join(step for step in name.replace("\\", "/").split("/") if step not in ("..", ".", ""))
    path, number = f"{ASSETS}/{inside}", 1
    taken = {use.path.lower(): use.source for use in linking.files}
    while taken.get(path.lower(), source) != source:
        number += 1
        path = f"{ASSETS}/{number}/{inside}"
    element.set(attribute, path)
    linking.files.append(FileUse(element, attribute, path, source, None))

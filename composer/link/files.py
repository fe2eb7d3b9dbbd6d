"""Pass: every file of every unit gets a path in the bundle, and the attribute that names it says that path."""

from __future__ import annotations

from pathlib import Path

from lxml.etree import _Element as Node

from composer.link.linking import FileUse, Linking
from composer.tree.files import file_attributes, is_absolute, is_plain, join, written_path
from composer.tree.names import WORLD
from composer.tree.settings import Settings
from composer.tree.skin_file import BadSkin, rename_bones
from composer.tree.unit import Unit

ASSETS = "assets"
# Where each path of the bundle comes from, by the path in lower case: some file systems do not tell cases apart.
Taken = dict[str, tuple[str, bytes | None]]


def files(linking: Linking) -> None:
    """`assets/LABEL/path` for each file; two units of one label share a folder only while no path clashes.

    >>> from composer.link.example import after
    >>> part = '<compiler meshdir="meshes"/><asset><mesh file="link.obj"/></asset>'
    >>> after(files, part)
    part: <asset><mesh file="assets/part/link.obj"/></asset>
    """
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
    for element, attribute, name in named:
        tag = element.tag
        if simple and tag != "skin" and is_plain(name):  # most files: no path to be shortened
            path = name if "/" in name and is_settled(unit, tag, name) else target + name
            key = path.lower()
            if key not in taken:
                source = f"{folders.get(tag, mesh_folder)}/{name}"
                taken[key] = (source, None)
                element.set(attribute, path)
                use(FileUse(element, attribute, path, source, None))
                continue
        written = written_path(unit.settings, element, name)
        known = unit.contents.get(written) if unit.contents else None
        source = str(known) if isinstance(known, Path) else join(directory, written)
        content = known if isinstance(known, bytes) else None
        if prefix and tag == "skin":
            content = _skin(linking, unit, element, prefix, source, content)
        path = _free(unit, tag, written, source, content, taken)
        element.set(attribute, path)
        use(FileUse(element, attribute, path, source, content))


def _skin(
    linking: Linking, unit: Unit, element: Node, prefix: str, source: str, content: bytes | None
) -> bytes | None:
    """A skin file names bodies; those get the prefix too."""
    try:
        data = Path(source).read_bytes() if content is None else content
        return rename_bones(data, lambda name: name if name == WORLD else prefix + name)
    except OSError:
        return content  # told where all files are read
    except BadSkin as fault:
        linking.sink.error("not-supported", f"`{source}`: {fault}", linking.span(unit, element))
        return content


def is_settled(unit: Unit, tag: object, name: str) -> bool:
    """Whether the path is one of a composition, `assets/LABEL/…` with no folder of the compiler's before it."""
    if not name.startswith(f"{ASSETS}/") or name.count("/") < 2:
        return False
    settings = unit.settings
    return not (settings.texture_folder if tag == "texture" else settings.mesh_folder)


def _free(unit: Unit, tag: object, written: str, source: str, content: bytes | None, taken: Taken) -> str:
    below = inside(unit.settings, written)
    path = f"{ASSETS}/{unit.label}/{below}"
    if is_settled(unit, tag, written):
        path = written
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
    """The path below the unit's own asset folder, which need not be repeated in the bundle."""
    if is_absolute(written):
        return written.rsplit("/", 1)[-1]
    for folder in (settings.mesh_folder, settings.texture_folder):
        if folder and written.startswith(start := join("", folder) + "/"):
            written = written[len(start) :]
            break
    if ".." in written:
        return "/".join(step for step in written.split("/") if step != "..")
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

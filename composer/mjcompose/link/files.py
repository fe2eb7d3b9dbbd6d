"""Pass: give every file a path in the bundle. `dedup` merges equivalent assets of a finished model."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import field
from itertools import chain, count
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.access import Door, Passed, held
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import Refused, read_regular
from mjcompose.base.naming import portable_path, portable_step
from mjcompose.link.linking import FileUse, Linking
from mjcompose.tree import journal
from mjcompose.tree.edit import BadSkin, rename_bones
from mjcompose.tree.files import (
    NAMED_AFTER_FILE,
    SourceSettings,
    file_attributes,
    is_absolute,
    is_plain,
    join,
    stem,
    written_path,
)
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.journal import because, explained
from mjcompose.tree.names import LISTS, REFERS, REFERS_BY, WORLD, declaration, naming_table, object_namespace
from mjcompose.tree.unit import Unit

KINDS = ("texture", "material", "mesh", "hfield")
"""Tags of merged assets, in an order in which nothing refers to a later kind."""
SHARED = ("texture", "mesh", "hfield")
"""Tags of the assets that copies of a part share. Programs and draws change the materials of one copy."""
# The values that a class gives count, not its name.
_NO_MEANING = ("name", "class")

Merged = Mapping[str, Mapping[str, str]]
"""By kind: each removed name with its replacement."""

NAMED_AFTER = because("named after its file")
IN_BUNDLE = because("where the bundle has the file")
_SHARED = because("the copies of the part share it")
_EQUAL = because("an equal one of another part is used")


def dedup(model: Unit, uses: Sequence[FileUse], prefixes: Collection[str]) -> tuple[Merged, tuple[FileUse, ...]]:
    """Merge equal textures, materials, meshes and height fields. Return the merged names and the remaining files.

    The first element stays. `prefixes` has the prefixes of all parts: elements of the same part are never merged. Reads
    files if their paths do not show whether they are equal.
    """
    return _merge(model, uses, prefixes, KINDS, copies=None)


def share_in_copies(
    model: Unit,
    uses: Sequence[FileUse],
    prefixes: Collection[str],
    kinds: Collection[str],
    copies: Mapping[str, Hashable],
) -> tuple[Merged, tuple[FileUse, ...]]:
    """The copies of a part share its meshes, textures and height fields.

    Return the names of the removed elements, each with the name of the first copy's, and the remaining files. `copies`
    has the prefix of each copy, with a value that is equal for the copies of one part. Assets of other parts stay, and
    those that an edit has changed in one copy. Reads no file: only assets of the same file are equal.
    """
    return _merge(model, uses, prefixes, kinds, copies=copies)


def _merge(
    model: Unit,
    uses: Sequence[FileUse],
    prefixes: Collection[str],
    kinds: Collection[str],
    copies: Mapping[str, Hashable] | None,
) -> tuple[Merged, tuple[FileUse, ...]]:
    """Merge equal assets of these kinds, with `copies` only those of copies of one part."""
    merged: dict[str, dict[str, str]] = {kind: {} for kind in KINDS}
    meanings = _Meanings(model, uses, merged, reads_files=copies is None)
    lengths = sorted({len(prefix) for prefix in prefixes}, reverse=True)
    gone: dict[Node, None] = {}
    for kind in filter(kinds.__contains__, KINDS):
        kept: dict[Hashable, list[_KeptElement]] = {}
        for element in model.root.findall(f"asset/{kind}"):
            declared = declaration(element, "asset")
            if declared is None:
                continue
            name = declared[1]
            # The longest prefix: an asset of `arm/hand/` does not belong to `arm/`.
            part = next((name[:length] for length in lengths if name[:length] in prefixes), "")
            if copies is not None and part not in copies:
                continue
            group = None if copies is None else copies[part]
            alike = kept.setdefault((group, meanings.of(element)), [])
            free = [each for each in alike if part not in each.parts]
            if not free:
                alike.append(_KeptElement(name, name.removeprefix(part), {part}))
                continue
            found = next((each for each in free if each.local == name.removeprefix(part)), free[0])
            found.parts.add(part)
            merged[kind][name] = found.name
            gone[element] = None
    with explained(_EQUAL if copies is None else _SHARED):
        if gone:
            _redirect(model.root, merged)
        for element in gone:
            journal.remove(element)
    names = {kind: names for kind, names in merged.items() if names}
    return names, tuple(use for use in uses if use.element not in gone)


class _KeptElement(Struct, frozen=False):
    """An element that is kept: its name, its name within its part, and the parts that contain it."""

    name: str
    local: str
    parts: set[str] = field(default_factory=set)


class _Meanings:
    """Computes the meaning of elements: their attributes in effect, the bytes of their files, and their references."""

    def __init__(self, model: Unit, uses: Sequence[FileUse], merged: Merged, reads_files: bool) -> None:
        self._reads_files = reads_files
        self._classes = model.classes
        self._uses = {(use.element, use.attribute): use for use in uses}
        self._merged = merged
        self._digests: dict[str, str] = {}

    def of(self, element: Node) -> Hashable:
        """Return a key that is equal for elements with the same tag and the same meaning to MuJoCo."""
        tag = str(element.tag)
        known = GRAMMAR.element(f"asset/{tag}").attributes
        values = {name: self._classes.effective(element, None, name) for name in known}
        values.update({str(name): str(value) for name, value in element.items()})
        # A class gives child elements (`layer`) to an element, as it gives attributes.
        levels = self._classes.get(element.get("class")).line()
        inherited = (
            child for level in levels for given in level.elements.get(tag, ()) for child in given.iterchildren("*")
        )
        return self._written(element, known, values), tuple(self._child(child) for child in inherited)

    def _written(self, element: Node, known: Mapping[str, Attribute], values: Mapping[str, str | None]) -> Hashable:
        meant = {name: each for name, each in values.items() if name not in _NO_MEANING and each is not None}
        attributes = ((name, self._value(element, name, known.get(name), value=each)) for name, each in meant.items())
        return tuple(sorted(attributes)), tuple(self._child(child) for child in element.iterchildren("*"))

    def _child(self, element: Node) -> Hashable:
        found = GRAMMAR.within("asset").get(str(element.tag))
        values = {str(name): str(value) for name, value in element.items()}
        return element.tag, self._written(element, found.attributes if found else {}, values)

    def _value(self, element: Node, name: str, attribute: Attribute | None, value: str) -> str:
        if attribute is None:
            return value
        if attribute.type == "file" and value:
            use = self._uses.get((element, name))
            return self._digest(use) if use is not None else value
        if attribute.refers is not None and attribute.refers in self._merged:
            return self._merged[attribute.refers].get(value, value)
        # `1 1 1` and `1.0 1 1` mean the same.
        if attribute.is_number:
            try:
                return " ".join(repr(float(number)) for number in value.split())
            except ValueError:
                return value
        return value

    def _digest(self, use: FileUse) -> str:
        # MuJoCo picks the reader of a mesh by the suffix: the same bytes as `.stl` and as `.obj` are two meshes.
        suffix = use.path.rpartition(".")[2].lower()
        if use.content is not None:
            return f"{hashlib.sha256(use.content).hexdigest()}.{suffix}"
        if not self._reads_files:
            return f"{use.source}.{suffix}"
        if use.source not in self._digests:
            try:
                self._digests[use.source] = hashlib.sha256(read_regular(use.source)).hexdigest()
            except OSError:  # reported where all files are read
                self._digests[use.source] = use.source
        return f"{self._digests[use.source]}.{suffix}"


def _redirect(root: Node, merged: Merged) -> None:
    for section in root.iterchildren("*"):
        table = naming_table(str(section.tag))
        if table:
            for element in section.iterdescendants(*table):
                for key, (kind, namespace) in table[str(element.tag)].items():
                    value = str(element.get(key) or "")
                    if not value or kind not in (REFERS, LISTS, REFERS_BY):
                        continue
                    target = object_namespace(element, namespace) if kind == REFERS_BY else namespace
                    if names := merged.get(target or "", {}):
                        each = value.split() if kind == LISTS else [value]
                        new = " ".join(names.get(name, name) for name in each)
                        if new != value:
                            journal.write(element, key, new)


ASSETS = "assets"
# Where each path of the bundle comes from, by the path in lower case: some file systems do not distinguish cases.
Taken = dict[str, tuple[str, bytes | None]]


def files(linking: Linking) -> None:
    """Store each file as `assets/LABEL/path`. Units with the same label share a folder unless their paths clash."""
    # Parts of one source share its files: only the same bytes share a path.
    taken: Taken = {}
    with explained(IN_BUNDLE):
        for prefix, unit in [("", linking.base), *((part.prefix, part.unit) for part in linking.parts)]:
            if named := list(file_attributes(unit.root)):
                _give_paths(linking, unit, prefix, named=named, taken=taken)


def _give_paths(linking: Linking, unit: Unit, prefix: str, named: list[tuple[Node, str, str]], taken: Taken) -> None:
    directory = str(unit.directory)
    folders = {"texture": join(directory, unit.settings.texture_folder)}
    mesh_folder = join(directory, unit.settings.mesh_folder)
    simple = not unit.contents and unit.settings.strippath != "true"
    target = f"{ASSETS}/{portable_step(unit.label)}/"
    use = linking.files.append
    # Most paths need not be shortened.
    plain = [
        f"{folders.get(element.tag, mesh_folder)}/{name}" if simple and element.tag != "skin" and is_plain(name) else ""
        for element, _, name in named
    ]
    listed = unit.door.admit_listed(filter(None, plain))
    for (element, attribute, name), where in zip(named, plain, strict=True):
        tag = element.tag
        if where:
            path = name if "/" in name and is_settled(unit, tag, name) else target + name
            source = listed.get(where) or readable_path(linking, unit, element, attribute=attribute, path=where)
            if source is None:
                continue
            alone: tuple[str, bytes | None] = (source, None)
            if taken.setdefault(path.lower(), alone) == alone:
                journal.write(element, attribute, path)
                use(FileUse(element, attribute, path, source=source, content=None))
                continue
        written = written_path(unit.settings, element, name)
        known = unit.contents.get(written) if unit.contents else None
        content = known if isinstance(known, bytes) else None
        if known is None:
            source = readable_path(linking, unit, element, attribute=attribute, path=join(directory, written))
        else:
            source = held(known if isinstance(known, Path) else join(directory, written))
        if source is None:
            continue
        if prefix and tag == "skin":
            content = _skin(linking, unit, element, prefix=prefix, source=source, content=content)
        path = _free_path(unit, tag, written, source=source, content=content, taken=taken)
        set_path(element, attribute, path, written)
        use(FileUse(element, attribute, path, source=source, content=content))


def set_path(element: Node, attribute: str, path: str, written: str) -> None:
    """Give an element the new path of a file; an asset that MuJoCo names after the `written` path keeps that name."""
    is_named_after_file = element.tag in NAMED_AFTER_FILE and attribute == "file" and not element.get("name")
    if is_named_after_file and stem(written) != stem(path):
        journal.write(element, "name", stem(written), NAMED_AFTER)
    journal.write(element, attribute, path)


def readable_path(linking: Linking, unit: Unit, element: Node, attribute: str, path: str) -> Passed | None:
    """Return the path that a unit refers to, or None if the unit may not read it, which is reported."""
    try:
        return unit.door.admit(path)
    except Refused as refused:
        refused.report(linking.sink, linking.span(unit, element, attribute))
        return None


def _skin(
    linking: Linking, unit: Unit, element: Node, prefix: str, source: Passed, content: bytes | None
) -> bytes | None:
    try:
        data = read_regular(source) if content is None else content
        return rename_bones(data, lambda name: name if name == WORLD else prefix + name)
    except OSError:
        return content  # reported where all files are read
    except BadSkin as fault:
        linking.sink.error("not-supported", f"`{source}`: {fault}", linking.span(unit, element))
        return content


def is_settled(unit: Unit, tag: object, name: str) -> bool:
    """Return whether the path belongs to a composition: `assets/LABEL/…` without a folder from the compiler."""
    if not name.startswith(f"{ASSETS}/") or name.count("/") < 2:
        return False
    settings = unit.settings
    return not (settings.texture_folder if tag == "texture" else settings.mesh_folder)


def _free_path(unit: Unit, tag: object, written: str, source: str, content: bytes | None, taken: Taken) -> str:
    below = path_in_assets(unit.settings, written)
    path = f"{ASSETS}/{portable_step(unit.label)}/{below}"
    if is_settled(unit, tag, written):
        path = portable_path(written)
    # Some file systems do not distinguish cases: `A.obj` and `a.obj` get different paths.
    _, label, below = path.split("/", 2)
    numbered = (f"{ASSETS}/{label}-{number}/{below}" for number in count(2))
    here = source, content
    return next(each for each in chain([path], numbered) if taken.setdefault(each.lower(), here) == here)


def path_in_assets(settings: SourceSettings, written: str) -> str:
    """Return the path below the unit's own asset folder, which is not repeated in the bundle."""
    if is_absolute(written):
        return portable_step(written.rsplit("/", 1)[-1])
    for folder in (settings.mesh_folder, settings.texture_folder):
        if folder and written.startswith(start := join("", folder) + "/"):
            written = written[len(start) :]
            break
    # Such a step would lead out of the bundle.
    if ".." in written:
        written = "/".join(step for step in written.split("/") if step != "..")
    return portable_path(written)


class NamedFile(Struct):
    """A file that a recipe names at `span` by an attribute of an element, relative to `folder`, with its `door`."""

    element: Node
    attribute: str
    name: str
    folder: Path
    door: Door
    span: Span


def add_file(linking: Linking, file: NamedFile) -> None:
    """Add a file from the recipe. It is stored below `assets/`, as for parts."""
    try:
        source = file.door.admit(join(str(file.folder), file.name))
    except Refused as refused:
        refused.report(linking.sink, file.span)
        return
    steps = file.name.replace("\\", "/").split("/")
    inside = portable_path("/".join(step for step in steps if step not in ("..", ".", "")))
    paths = chain([f"{ASSETS}/{inside}"], (f"{ASSETS}/{number}/{inside}" for number in count(2)))
    taken = {use.path.lower(): use.source for use in linking.files}
    path = next(each for each in paths if taken.get(each.lower(), source) == source)
    set_path(file.element, file.attribute, path, file.name)
    linking.files.append(FileUse(file.element, file.attribute, path, source=source, content=None))

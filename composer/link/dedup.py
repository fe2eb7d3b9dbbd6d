"""Merge assets that mean the same in several copies of a part, and redirect every reference.

This works on a finished model, in which all parts share one set of compiler settings.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import field

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.link.linking import FileUse
from composer.reading.regular import read_regular
from composer.tree.classes import DefaultClass
from composer.tree.names import LISTS, REFERS, REFERS_BY, declaration, naming_table, object_namespace
from composer.tree.unit import Unit

KINDS = ("texture", "material", "mesh", "hfield")
"""What is merged, in an order in which nothing refers to a later kind."""
# What a class gives counts by its values, whatever the class is called.
_NO_MEANING = ("name", "class")

Merged = Mapping[str, Mapping[str, str]]
"""By kind: for each name that is gone, the name that stands for it."""


def dedup(
    model: Unit, uses: Sequence[FileUse], prefixes: Collection[str]
) -> tuple[Merged, tuple[FileUse, ...]]:
    """Merge equal textures, materials, meshes and height fields. Return the merged names and the remaining files.

    The first element stays. `prefixes` are those of all parts: what one and the same part has twice stays two. Reads
    files whose path alone does not say whether they are equal.
    """
    merged: dict[str, dict[str, str]] = {kind: {} for kind in KINDS}
    meanings = _Meanings(model, uses, merged)
    gone: set[Node] = set()
    for kind in KINDS:
        kept: dict[Hashable, list[_Kept]] = {}
        for element in [
            each for section in model.root.iterchildren("asset") for each in section.iterchildren(kind)
        ]:
            declared = declaration(element, "asset")
            if declared is None:
                continue
            name = declared[1]
            # The longest prefix: an asset of `arm/hand/` is not one of `arm/`.
            part = max((prefix for prefix in prefixes if name.startswith(prefix)), key=len, default="")
            alike = kept.setdefault(meanings.of(element), [])
            free = [each for each in alike if part not in each.parts]
            if not free:
                alike.append(_Kept(name, name.removeprefix(part), {part}))
                continue
            found = next((each for each in free if each.local == name.removeprefix(part)), free[0])
            found.parts.add(part)
            merged[kind][name] = found.name
            gone.add(element)
    if gone:
        _redirect(model.root, merged)
    for element in gone:
        section = element.getparent()
        assert section is not None
        section.remove(element)
    names = {kind: names for kind, names in merged.items() if names}
    return names, tuple(use for use in uses if use.element not in gone)


@dataclass(slots=True)
class _Kept:
    """An element that is kept: its name, its name within its part, and the parts that contain it."""

    name: str
    local: str
    parts: set[str] = field(default_factory=set)


class _Meanings:
    """Computes the meaning of elements: their attributes in effect, the bytes of their files, and their references."""

    def __init__(self, model: Unit, uses: Sequence[FileUse], merged: Merged) -> None:
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
        inherited = self._inherited(tag, self._classes.get(element.get("class")))
        return self._written(element, known, values), tuple(inherited)

    def _written(
        self, element: Node, known: Mapping[str, Attribute], values: Mapping[str, str | None]
    ) -> Hashable:
        attributes = tuple(
            sorted(
                (name, self._value(element, name, known.get(name), value))
                for name, value in values.items()
                if name not in _NO_MEANING and value is not None
            )
        )
        return attributes, tuple(self._child(child) for child in element.iterchildren("*"))

    def _child(self, element: Node) -> Hashable:
        found = GRAMMAR.within("asset").get(str(element.tag))
        values = {str(name): str(value) for name, value in element.items()}
        return element.tag, self._written(element, found.attributes if found else {}, values)

    def _inherited(self, tag: str, of: DefaultClass | None) -> Iterator[Hashable]:
        """Yield the keys of child elements (`layer`) that a class gives to an element, as it gives attributes."""
        while of is not None:
            for element in of.elements.get(tag, ()):
                yield from (self._child(child) for child in element.iterchildren("*"))
            of = of.parent

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
        """Return a hash of the bytes of a file and of the format that its suffix means."""
        # MuJoCo picks the reader of a mesh by the suffix: the same bytes as `.stl` and as `.obj` are two things.
        suffix = use.path.rpartition(".")[2].lower()
        if use.content is not None:
            return f"{hashlib.sha256(use.content).hexdigest()}.{suffix}"
        if use.source not in self._digests:
            try:
                self._digests[use.source] = hashlib.sha256(read_regular(use.source)).hexdigest()
            except OSError:  # reported where all files are read
                self._digests[use.source] = use.source
        return f"{self._digests[use.source]}.{suffix}"


def _redirect(root: Node, merged: Merged) -> None:
    """Replace every reference to a removed name by the name that it was merged into."""
    for section in root.iterchildren("*"):
        table = naming_table(str(section.tag))
        for element in section.iterdescendants(*table) if table else ():
            for key, (kind, namespace) in table[str(element.tag)].items():
                value = str(element.get(key) or "")
                if not value or kind not in (REFERS, LISTS, REFERS_BY):
                    continue
                target = object_namespace(element, namespace) if kind == REFERS_BY else namespace
                names = merged.get(target or "", {})
                if kind == LISTS:
                    new = " ".join(names.get(each, each) for each in value.split())
                else:
                    new = names.get(value, value)
                if new != value and names:
                    element.set(key, new)

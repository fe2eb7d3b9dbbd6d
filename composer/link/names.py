"""Pass: every name of a part gets the part's prefix, and every reference follows; clashes and loose ends are told."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from lxml.etree import _Element as Node

from composer.diagnostics.suggest import exists_note
from composer.link.linking import Linking
from composer.tree.classes import MAIN
from composer.tree.files import NAMED_AFTER_FILE, stem
from composer.tree.names import (
    DECLARES,
    GENERATORS,
    LISTS,
    REFERS,
    REFERS_BY,
    WORLD,
    naming_table,
    object_namespace,
)
from composer.tree.unit import Unit


_MAY_REPEAT = ("model",)
_RESERVED = frozenset({"", WORLD, MAIN})


def names(linking: Linking) -> None:
    """Rename part by part; afterwards `linking.names` knows every name of the model."""
    _join(linking, linking.base, "", MAIN)
    for part in linking.parts:
        _join(linking, part.unit, part.prefix, part.top_class)


def _join(linking: Linking, unit: Unit, prefix: str, top_class: str) -> None:
    local = rename(unit, prefix, top_class)
    for namespace, name, element in local.repeated():
        _clash(linking, unit, namespace, name, element, local.declared[namespace][name], unit)
    for namespace, name, element in local.dangling():
        if not may_be_generated(name, prefix, unit.root):
            _loose_end(linking, unit, namespace, name, element, local)
    for namespace, declared in local.declared.items():
        known = linking.names.declared.setdefault(namespace, {})
        final = {prefix + name: element for name, element in declared.items()} if prefix else declared
        if namespace not in _MAY_REPEAT and not known.keys().isdisjoint(final):
            for name in known.keys() & final.keys():
                _clash(linking, unit, namespace, name, final[name], known[name], None)
        known.update(final)


class _Local:
    """The names of one unit as they are written in it: (name, element) pairs by kind and namespace."""

    def __init__(self) -> None:
        self.pairs: list[list[tuple[str, Node]]] = [[] for _ in _KINDS]
        self.declared: dict[str, dict[str, Node]] = {}

    def close(self) -> None:
        """Call once, when all pairs have been noted."""
        for (kind, namespace), pairs in zip(_KINDS, self.pairs, strict=True):
            if kind == DECLARES and pairs:
                self.declared[namespace] = dict(pairs)

    def note(self, kind: int, namespace: str, name: str, element: Node) -> None:
        index = _kind(kind, namespace)
        while len(self.pairs) < len(_KINDS):
            self.pairs.append([])
        self.pairs[index].append((name, element))

    def repeated(self) -> Iterator[tuple[str, str, Node]]:
        for namespace, declared in self.declared.items():
            pairs = self.pairs[_kind(DECLARES, namespace)]
            if len(pairs) > len(declared) and namespace not in _MAY_REPEAT:
                seen: set[str] = set()
                for name, element in pairs:
                    if name in seen:
                        yield namespace, name, element
                    seen.add(name)

    def dangling(self) -> Iterator[tuple[str, str, Node]]:
        for (kind, namespace), pairs in zip(_KINDS, self.pairs, strict=True):
            if kind == REFERS and pairs:
                declared = self.declared.get(namespace, {})
                wanted = dict(pairs)
                if not wanted.keys() <= declared.keys():
                    yield from ((namespace, name, wanted[name]) for name in wanted if name not in declared)


# What an attribute holds, as an index into the pairs of a unit; the first two are not noted.
_SPECIAL, _IGNORED = 0, 1
_KINDS: list[tuple[int, str]] = [(-1, ""), (-2, "")]


def _kind(kind: int, namespace: str) -> int:
    if (kind, namespace) not in _KINDS:
        _KINDS.append((kind, namespace))
    return _KINDS.index((kind, namespace))


@lru_cache(maxsize=None)
def _indices(section: str) -> dict[str, dict[str, int]]:
    """The naming table of a section with indices; a reference in a class is not looked up, nothing may take it."""
    table: dict[str, dict[str, int]] = {}
    for tag, actions in naming_table(section).items():
        row = table[tag] = {}
        for name, (kind, namespace) in actions.items():
            plain = kind in (DECLARES, REFERS) and namespace != "key"
            ignored = kind == REFERS and section == "default"
            row[name] = (_IGNORED if ignored else _kind(kind, namespace)) if plain else _SPECIAL
    return table


def rename(unit: Unit, prefix: str, top_class: str) -> _Local:
    """Prefix a unit in place and give the names it has.

    This is the one walk over every element of every part. Each attribute that holds a name is noted by one
    append; what is not a name costs a dictionary miss.
    """
    sections = [(section, _indices(section.tag)) for section in unit.root.iterchildren("*")]
    local = _Local()
    notes = [pairs.append for pairs in local.pairs]
    for section, table in sections:
        if not table:
            continue
        if section.tag == "asset":
            _name_assets(section, not prefix)
        for element in section.iter("*"):
            actions = table.get(element.tag)
            if actions is None:
                continue
            for key in element.keys():  # noqa: SIM118 (an element is no mapping)
                index = actions.get(key)
                if index is None:
                    continue
                value = element.get(key)
                if not index or value in _RESERVED:
                    _rename_special(local, element, key, prefix, top_class, section)
                    continue
                notes[index]((value, element))
                if prefix:
                    element.set(key, prefix + value)
            if prefix and element.tag == "composite" and "prefix" not in element.attrib:
                element.set("prefix", prefix)
    local.close()
    return local


def _rename_special(
    local: _Local, element: Node, key: str, prefix: str, top_class: str, section: Node
) -> None:
    """Values that are no plain name of the unit: empty, `world`, `main`, lists, and names typed by a sibling."""
    kind, namespace = naming_table(str(section.tag))[str(element.tag)][key]
    value = str(element.get(key))
    name = prefix + value
    if not value or namespace == "key":
        return  # keys are named when they are laid out
    if kind == DECLARES:
        if element is section:
            return  # the top class
        local.note(DECLARES, namespace, value, element)
    elif kind == REFERS:
        if value == WORLD and namespace == "body":
            return
        if value == MAIN and namespace == "default":
            name = top_class
        elif section.tag != "default":
            local.note(REFERS, namespace, value, element)
    elif kind == LISTS:
        names = value.split()
        for each in names:
            if each != WORLD:
                local.note(REFERS, namespace, each, element)
        name = " ".join(each if each == WORLD else prefix + each for each in names)
    elif kind == REFERS_BY:
        target = object_namespace(element, namespace)
        if value == WORLD and target in (None, "body"):
            return
        if target:
            local.note(REFERS, target, value, element)
    if prefix:
        element.set(key, name)


def _name_assets(section: Node, bare: bool) -> None:
    """Write the name that MuJoCo takes from the file, so that a prefix can stand before it."""
    for element in section.iterchildren(*NAMED_AFTER_FILE):
        if not element.get("name"):
            file = element.get("file")
            if file:
                element.set("name", stem(str(file)))
            elif "name" in element.attrib and not bare:
                del element.attrib["name"]


def may_be_generated(name: str, prefix: str, root: Node) -> bool:
    """Whether what MuJoCo expands (replicate, flexcomp, …) in that tree, prefixed already, can make the name."""
    for element in root.iter(*GENERATORS):
        if element.tag == "replicate":
            if re.search(r"\d+$", name):
                return True
        elif element.tag == "model":
            return True
        else:
            start = str(element.get("name") or element.get("prefix") or "")
            if (prefix + name).startswith(start):
                return True
    return False


def _loose_end(
    linking: Linking, unit: Unit, namespace: str, name: str, element: Node, local: _Local
) -> None:
    linking.sink.error(
        "unknown-name",
        f"`<{element.tag}>` refers to the {namespace} `{name}`, which does not exist",
        linking.span(unit, element),
        notes=(exists_note(namespace, local.declared.get(namespace, ()), name),),
    )


def _clash(
    linking: Linking,
    unit: Unit,
    namespace: str,
    name: str,
    element: Node,
    earlier: Node,
    earlier_unit: Unit | None,
) -> None:
    from composer.diagnostics.diagnostic import Note

    code = "class-clash" if namespace == "default" else "name-clash"
    what = "default class" if namespace == "default" else namespace
    owner = earlier_unit or _unit_of(linking, earlier)
    first = Note("it is declared here first", linking.span(owner, earlier))
    help_text = None if owner is unit else "give one of the parts a prefix of its own"
    linking.sink.error(
        code,
        f"two elements are the {what} `{name}`",
        linking.span(unit, element),
        notes=(first,),
        help=help_text,
    )


def _unit_of(linking: Linking, element: Node) -> Unit:
    root = element.getroottree().getroot()
    return next((unit for unit in linking.units if unit.root is root), linking.base)

"""Check and normalise a model when it is read."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.diagnostics.unknown import unknown_attribute
from composer.grammar import GRAMMAR, ElementType
from composer.link.sizes import INSTEAD_OF_MEMORY
from composer.mujoco_errors.other_version import of_other_version
from composer.tree.files import stem
from composer.tree.ignored import ignored, is_unread_alone
from composer.tree.name_index import MAY_REPEAT, own_name
from composer.tree.names import DECLARES, naming_table
from composer.tree.unit import Unit

_KEPT_APART = frozenset({"default"})  # a later section does not reach the classes of an earlier one

# Sections whose elements are named after their file where they have no `name`.
_NAMED_AFTER_FILE = ("asset", "deformable")

_Row = dict[str, dict[str, frozenset[str]]]


def check_tree(unit: Unit, sink: Sink) -> None:
    """Report elements and attributes that MJCF does not have, and names that repeat. Values are not checked."""
    names: list[tuple[object, str | None]] = []
    for section in unit.root.iterchildren("*"):
        tag = str(section.tag)
        if tag not in GRAMMAR.root.children:
            _unknown_element(unit, section, GRAMMAR.root, sink)
            continue
        table, namespaces = _table(tag), _namespaces(tag)
        _check_attributes(unit, section, GRAMMAR.section(tag), sink)
        for parent in section.iter("*"):
            if not len(parent):
                continue
            allowed = table.get(parent.tag)
            if allowed is None:  # reported as a child of its parent
                continue
            for child in parent:
                kind = child.tag
                attributes = allowed.get(kind)
                if attributes is None:
                    if isinstance(kind, str):
                        _unknown_element(unit, child, _kind(tag, str(parent.tag)), sink)
                    continue
                keys = child.keys()
                if not attributes.issuperset(keys):
                    _check_attributes(unit, child, _kind(tag, str(parent.tag)).children[kind], sink)
                if "name" in keys:
                    names.append((namespaces.get(kind), child.get("name")))
                elif "file" in keys and tag in _NAMED_AFTER_FILE:
                    names.append((namespaces.get(kind), stem(str(child.get("file")))))
                elif kind == "default":
                    names.append((None, child.get("class")))
    if not GRAMMAR.root.attributes.keys() >= set(unit.root.keys()):
        _check_attributes(unit, unit.root, GRAMMAR.root, sink)
    if len(set(names)) < len(names):  # or what looks like it
        _check_names(unit, sink)


def _check_names(unit: Unit, sink: Sink) -> None:
    first: dict[tuple[str, str], Node] = {}
    for section in unit.root.iterchildren("*"):
        namespaces = _namespaces(str(section.tag))
        for node in section.iterdescendants(*namespaces) if namespaces else ():
            attribute, namespace = namespaces[str(node.tag)]
            name = own_name(node, attribute)
            if name and first.setdefault((namespace, name), node) is not node:
                is_class = namespace == "default"
                sink.error(
                    "class-clash" if is_class else "name-clash",
                    f"another {'default class' if is_class else namespace} is called `{name}` already",
                    unit.origins.span(node, unit.file, attribute if node.get(attribute) else "file"),
                    notes=(
                        Note("the first one is here", unit.origins.span(first[namespace, name], unit.file)),
                    ),
                    help="give one of the two another name",
                )


def one_of_each_section(unit: Unit) -> None:
    """Merge sections that are written several times. If a setting repeats, the last value wins."""
    first: dict[str, Node] = {}
    for section in list(unit.root.iterchildren("*")):
        tag = str(section.tag)
        if tag in _KEPT_APART or tag not in first:
            first.setdefault(tag, section)
            continue
        owner = unit.origins.owner(section, unit.file)
        for child in section.iterchildren("*"):
            if child not in unit.origins.owners:
                unit.origins.own(child, owner)
        if tag == "size":
            _prefer_memory(first[tag], section)
        _join(first[tag], section, GRAMMAR.section(tag))
        unit.root.remove(section)


def _prefer_memory(one: Node, other: Node) -> None:
    """Remove the older size settings where the other element has `memory`.

    MuJoCo lets `memory` override them, but refuses both in one element.
    """
    for there, here in ((one, other), (other, one)):
        for name in INSTEAD_OF_MEMORY if there.get("memory") else ():
            if name in here.attrib:
                del here.attrib[name]


def _join(into: Node, section: Node, kind: ElementType) -> None:
    for name, value in section.items():
        if str(value).strip():
            into.set(name, value)
    for child in list(section):
        once = isinstance(child.tag, str) and kind.children[child.tag].max_count == 1
        same = next(into.iterchildren(child.tag), None) if once else None
        if same is None:
            into.append(child)
        else:
            _join(same, child, kind.children[str(child.tag)])


@cache
def _table(section: str) -> _Row:
    """Return, for each tag in a section, the children that it can have and their attributes."""
    return {
        tag: {name: frozenset(child.attributes) for name, child in _kind(section, tag).children.items()}
        for tag in (section, *GRAMMAR.within(section))
    }


@cache
def _namespaces(section: str) -> dict[str, tuple[str, str]]:
    """Return, for each tag of a section that declares names, the naming attribute and the namespace."""
    return {
        tag: (attribute, namespace)
        for tag, actions in naming_table(section).items()
        for attribute, (kind, namespace) in actions.items()
        if kind == DECLARES and namespace not in MAY_REPEAT
    }


def _kind(section: str, tag: str) -> ElementType:
    return GRAMMAR.section(section) if tag == section else GRAMMAR.within(section)[tag]


def _unknown_element(unit: Unit, node: Node, parent: ElementType, sink: Sink) -> None:
    tag, span = str(node.tag), unit.origins.span(node, unit.file)
    if (other := of_other_version(node, None, unit.file)) is not None:
        sink.add(replace(other, span=span))
        return
    sink.error(
        "unknown-element",
        f"`<{parent.tag}>` cannot have a `<{tag}>`",
        span,
        notes=(exists_note("element", sorted(parent.children), tag),),
        help=did_you_mean(tag, parent.children, "<{}>"),
    )


def _check_attributes(unit: Unit, node: Node, kind: ElementType, sink: Sink) -> None:
    for name in map(str, node.keys()):
        if name in kind.attributes:
            continue
        if is_unread_alone(node, name, unit):
            sink.add(ignored(node, name, unit))
            continue
        span = unit.origins.span(node, unit.file, name)
        other = of_other_version(node, name, unit.file)
        known = sorted(kind.attributes)
        found = other or unknown_attribute(name, f"`<{kind.tag}>`", known)
        sink.add(replace(found, span=span))

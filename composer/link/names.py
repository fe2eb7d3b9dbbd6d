"""Pass: every name of a part gets the part's prefix, and every reference follows; clashes and loose ends are told."""

from __future__ import annotations

import re
from collections import defaultdict

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
    Names,
    naming_table,
    object_namespace,
)
from composer.tree.unit import Unit


_MAY_REPEAT = ("model",)


def names(linking: Linking) -> None:
    """Rename part by part; afterwards `linking.names` knows every name of the model."""
    _join(linking, linking.base, "", MAIN)
    for part in linking.parts:
        _join(linking, part.unit, part.prefix, part.top_class)


def _join(linking: Linking, unit: Unit, prefix: str, top_class: str) -> None:
    local, repeated = rename(unit, prefix, top_class)
    for namespace, name, element in repeated:
        _clash(linking, unit, namespace, name, element, local.declared[namespace][name], unit)
    for namespace, name, element in local.dangling():
        if not may_be_generated(name, unit.root):
            _loose_end(linking, unit, namespace, name[len(prefix) :], element, local, prefix)
    everything = linking.names.declared
    for namespace, declared in local.declared.items():
        known = everything.setdefault(namespace, {})
        if namespace not in _MAY_REPEAT:
            for name in known.keys() & declared.keys():
                _clash(linking, unit, namespace, name, declared[name], known[name], None)
        known.update(declared)


def rename(unit: Unit, prefix: str, top_class: str) -> tuple[Names, list[tuple[str, str, Node]]]:
    """Prefix a unit in place. Gives its names, and those that are declared twice.

    This is the one walk over every element of every part: what is not a name costs a dictionary miss here.
    """
    declared: defaultdict[str, dict[str, Node]] = defaultdict(dict)
    referred: defaultdict[str, dict[str, Node]] = defaultdict(dict)
    repeated: list[tuple[str, str, Node]] = []
    for section in unit.root:
        section_tag = section.tag
        table = naming_table(section_tag) if isinstance(section_tag, str) else None
        if not table:
            continue
        in_default = section_tag == "default"
        if section_tag == "asset":
            _name_assets(section, not prefix)
        for element in section.iter():
            actions = table.get(element.tag)  # type: ignore[call-overload]
            if actions is None:
                continue
            for key in element.keys():  # noqa: SIM118 (an element is no mapping)
                action = actions.get(key)
                if action is None:
                    continue
                value = element.get(key)
                if not value:
                    continue
                kind, namespace = action
                name = prefix + value  # type: ignore[operator]
                if kind == REFERS:
                    if value == WORLD and namespace == "body":
                        continue
                    if value == MAIN and namespace == "default":
                        name = top_class
                    elif not in_default:  # a class may name what no element takes from it
                        referred[namespace][name] = element
                elif kind == DECLARES:
                    if (in_default and element is section) or namespace == "key":
                        continue  # a top class has no name; keys are named when they are laid out
                    known = declared[namespace]
                    if name in known and namespace not in _MAY_REPEAT:
                        repeated.append((namespace, name, element))
                    known[name] = element
                elif kind == LISTS:
                    listed = [item if item == WORLD else prefix + item for item in value.split()]
                    for item in listed:
                        referred[namespace][item] = element
                    name = " ".join(listed)
                elif kind == REFERS_BY:
                    target = object_namespace(element, namespace)
                    if value == WORLD and target in (None, "body"):
                        continue
                    if target:
                        referred[target][name] = element
                if prefix:
                    element.set(key, name)
            if prefix and element.tag == "composite" and "prefix" not in element.attrib:
                element.set("prefix", prefix)
    return Names(declared, referred), repeated


def _name_assets(section: Node, bare: bool) -> None:
    """Write the name that MuJoCo takes from the file, so that a prefix can stand before it."""
    for element in section.iterchildren(*NAMED_AFTER_FILE):
        if not element.get("name"):
            file = element.get("file")
            if file:
                element.set("name", stem(str(file)))
            elif "name" in element.attrib and not bare:
                del element.attrib["name"]


def may_be_generated(name: str, root: Node) -> bool:
    """Whether what MuJoCo expands (replicate, flexcomp, …) in that tree can make the name."""
    for element in root.iter(*GENERATORS):
        if element.tag == "replicate":
            if re.search(r"\d+$", name):
                return True
        elif element.tag == "model":
            return True
        else:
            start = str(element.get("name") or element.get("prefix") or "")
            if name.startswith(start):
                return True
    return False


def _loose_end(
    linking: Linking, unit: Unit, namespace: str, name: str, element: Node, local: Names, prefix: str
) -> None:
    exist = [other[len(prefix) :] for other in local.of(namespace)]
    linking.sink.error(
        "unknown-name",
        f"`<{element.tag}>` refers to the {namespace} `{name}`, which does not exist",
        linking.span(unit, element),
        notes=(exists_note(namespace, exist, name),),
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

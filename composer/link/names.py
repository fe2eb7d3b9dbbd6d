"""Pass: every name of a part gets the part's prefix, and every reference follows; clashes and loose ends are told."""

from __future__ import annotations

import re

from lxml.etree import _Element as Node

from composer.diagnostics.suggest import exists_note
from composer.link.linking import Linking
from composer.tree.classes import MAIN
from composer.tree.files import NAMED_AFTER_FILE, stem
from composer.tree.names import (
    DECLARES,
    GENERATES,
    GENERATORS,
    LISTS,
    REFERS,
    WORLD,
    Names,
    naming_table,
    object_namespace,
)
from composer.tree.unit import Unit


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
        if known.keys() & declared.keys():
            for name in known.keys() & declared.keys():
                _clash(linking, unit, namespace, name, declared[name], known[name], None)
        known.update(declared)


def rename(unit: Unit, prefix: str, top_class: str) -> tuple[Names, list[tuple[str, str, Node]]]:
    """Prefix a unit in place. Gives its names, and those that are declared twice."""
    declared: dict[str, dict[str, Node]] = {}
    referred: dict[str, dict[str, Node]] = {}
    repeated: list[tuple[str, str, Node]] = []
    bare = not prefix
    for section in unit.root:
        section_tag = section.tag
        if not isinstance(section_tag, str):
            continue
        table = naming_table(section_tag)
        if not table:
            continue
        in_default = section_tag == "default"
        if section_tag == "asset":
            _name_assets(section, bare)
        for element in section.iter():
            tag = element.tag
            actions = table.get(tag)  # type: ignore[call-overload]
            if actions is None:
                continue
            if prefix and (tag == "attach" or tag == "composite"):
                element.set("prefix", prefix + str(element.get("prefix") or ""))
            for key, value in element.items():
                action = actions.get(key)  # type: ignore[call-overload]
                if action is None or not value:
                    continue
                kind, namespace = action
                if kind == DECLARES:
                    if namespace == "default":
                        if in_default and element.getparent() is unit.root:
                            continue
                    name = prefix + value
                    if not bare:
                        element.set(key, name)
                    known = declared.setdefault(namespace, {})
                    if name in known and not _may_repeat(namespace, element):
                        repeated.append((namespace, name, element))
                    else:
                        known[name] = element
                elif kind == REFERS:
                    if value == WORLD and namespace == "body":
                        continue
                    if namespace == "default" and value == MAIN:
                        if not bare:
                            element.set(key, top_class)
                        continue
                    name = prefix + value
                    if not bare:
                        element.set(key, name)
                    if not in_default:  # a class may name what no element takes from it
                        referred.setdefault(namespace, {})[name] = element
                elif kind == LISTS:
                    listed = [item if item == WORLD else prefix + item for item in value.split()]
                    if not bare:
                        element.set(key, " ".join(listed))
                    for name in listed:
                        referred.setdefault(namespace, {})[name] = element
                elif kind != GENERATES:
                    target = object_namespace(element, namespace)
                    if value == WORLD and target in (None, "body"):
                        continue
                    name = prefix + value
                    if not bare:
                        element.set(key, name)
                    if target:
                        referred.setdefault(target, {})[name] = element
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


def _may_repeat(namespace: str, element: Node) -> bool:
    return namespace in ("key", "model")


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

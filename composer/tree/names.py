"""The names of a model by MuJoCo namespace, and the references to them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field
from functools import cache
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR
from composer.tree.files import NAMED_AFTER_FILE, stem

DECLARES, REFERS, REFERS_BY, LISTS, GENERATES = range(5)
Action = tuple[int, str]

# Elements whose expansion creates names that are not written in the model.
GENERATORS = frozenset({"replicate", "flexcomp", "composite", "attach", "model"})
WORLD = "world"

_WITH = etree.XPath("descendant::*/@*[. = $name]")


@dataclass(slots=True)
class Names:
    """The declared names by namespace, each with its element."""

    declared: dict[str, dict[str, Node]] = field(default_factory=dict)

    def find(self, namespace: str, name: str) -> Node | None:
        return self.declared.get(namespace, {}).get(name)

    def of(self, namespace: str) -> list[str]:
        return list(self.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        """Return the namespaces in which the name exists."""
        return [namespace for namespace, declared in self.declared.items() if name in declared]


def word(namespace: str, article: bool = False) -> str:
    """Return the noun in messages for a namespace.

    >>> word("default"), word("actuator", article=True)
    ('default class', 'an actuator')
    """
    noun = {"default": "default class", "instance": "plugin instance", "pair": "contact pair"}.get(
        namespace, namespace
    )
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}" if article else noun


@cache
def naming_table(section: str) -> dict[str, dict[str, Action]]:
    """Return for each tag inside a top-level section which attributes hold names, and what kind of name."""
    table: dict[str, dict[str, Action]] = {}
    for tag, element in GRAMMAR.within(section).items():
        actions: dict[str, Action] = {}
        for attribute in element.attributes.values():
            if attribute.declares:
                actions[attribute.name] = (DECLARES, attribute.declares)
            elif attribute.refers_by:
                actions[attribute.name] = (REFERS_BY, attribute.refers_by)
            elif attribute.type == "references" and attribute.refers:
                actions[attribute.name] = (LISTS, attribute.refers)
            elif attribute.refers and not attribute.refers.startswith("attached:"):
                actions[attribute.name] = (REFERS, attribute.refers)
        if tag in ("attach", "composite"):
            actions["prefix"] = (GENERATES, "")
        if actions:
            table[tag] = actions
    return table


@cache
def declaring(section: str) -> dict[Any, tuple[tuple[str, str], ...]]:
    """Return for each tag the attributes that declare names, with the namespace."""
    return {
        tag: tuple((name, namespace) for name, (kind, namespace) in actions.items() if kind == DECLARES)
        for tag, actions in naming_table(section).items()
    }


@cache
def _referring(section: str) -> dict[Any, tuple[tuple[str, int, str], ...]]:
    """Return for each tag the attributes that refer to names, how, and their namespace or the attribute with it."""
    return {
        tag: tuple(
            (name, *action) for name, action in actions.items() if action[0] not in (DECLARES, GENERATES)
        )
        for tag, actions in naming_table(section).items()
    }


def object_namespace(element: Node, type_attribute: str) -> str | None:
    """Return the namespace that an `objtype`-like attribute names, or None if it is absent or unknown."""
    return GRAMMAR.objtypes.get(str(element.get(type_attribute, "")))


def users(section: Node, namespace: str, name: str) -> Iterator[tuple[Node, str]]:
    """Yield each element in a section that refers to a name, with the attribute. Lists of names are left out.

    >>> excluded = etree.fromstring('<contact><exclude name="world" body1="world" body2="b"/></contact>')
    >>> [attribute for _, attribute in users(excluded, "body", "world")]
    ['body1']
    """
    table = naming_table(str(section.tag))
    found: Any = _WITH(section, name=name)  # libxml2 looks at all attributes in a quarter of Python's time
    for node, attribute in [(each.getparent(), each.attrname) for each in found]:
        kind, target = table.get(node.tag, {}).get(attribute, (DECLARES, ""))
        if (kind, target) == (REFERS, namespace) or (
            kind == REFERS_BY and object_namespace(node, target) == namespace
        ):
            yield node, attribute


def references(top: Node, section: str) -> Iterator[tuple[str, str]]:
    """Yield namespace and name of all references of an element of a section, and of every element in it."""
    for node in top.iter("*"):
        for _, namespace, name, _ in own_references(node, section):
            yield namespace, name


def own_references(node: Node, section: str) -> list[tuple[str, str, str, str]]:
    """Return attribute, namespace and name of each reference of one element of a section.

    The fourth value is the attribute that selects the namespace, such as `objtype`; empty if the grammar determines
    it.
    """
    found = []
    for attribute, kind, namespace in _referring(section).get(node.tag, ()):
        value = node.get(attribute)
        if not value:
            continue
        if kind == REFERS:
            found.append((attribute, namespace, str(value), ""))
        elif kind == LISTS:
            found += [(attribute, namespace, each, "") for each in str(value).split()]
        elif target := object_namespace(node, namespace):
            found.append((attribute, target, str(value), namespace))
    return found


def declaration(node: Node, section: str) -> tuple[str, str] | None:
    """Return namespace and name that an element of a section declares or gets from its file, if it has a name."""
    for key, (kind, namespace) in naming_table(section).get(str(node.tag), {}).items():
        if kind == DECLARES and (value := node.get(key)):
            return namespace, str(value)
    if node.tag in NAMED_AFTER_FILE and section in ("asset", "deformable") and (file := node.get("file")):
        return str(node.tag), stem(str(file))
    return None


def may_be_generated(name: str, root: Node) -> bool:
    """Return whether elements that MuJoCo expands (replicate, flexcomp, …) in that tree can create the name."""
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

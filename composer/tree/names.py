"""The names of a model, by MuJoCo namespace, and who refers to them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR
from composer.tree.files import NAMED_AFTER_FILE, stem

DECLARES, REFERS, REFERS_BY, LISTS, GENERATES = range(5)
Action = tuple[int, str]

# Elements whose expansion makes names that are written nowhere.
GENERATORS = frozenset({"replicate", "flexcomp", "composite", "attach", "model"})
WORLD = "world"


@dataclass(slots=True)
class Names:
    """The names that are declared, by namespace, each with the element that does so."""

    declared: dict[str, dict[str, Node]] = field(default_factory=dict)

    def find(self, namespace: str, name: str) -> Node | None:
        return self.declared.get(namespace, {}).get(name)

    def of(self, namespace: str) -> list[str]:
        return list(self.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        """The namespaces in which something has that name."""
        return [namespace for namespace, declared in self.declared.items() if name in declared]


def word(namespace: str, article: bool = False) -> str:
    """What messages call a thing of that namespace.

    >>> word("default"), word("actuator", article=True)
    ('default class', 'an actuator')
    """
    noun = {"default": "default class", "instance": "plugin instance", "pair": "contact pair"}.get(
        namespace, namespace
    )
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}" if article else noun


@cache
def naming_table(section: str) -> dict[str, dict[str, Action]]:
    """For each tag inside a top-level section: which attributes hold names, and what kind of name."""
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


def object_namespace(element: Node, type_attribute: str) -> str | None:
    """The namespace that a `objtype`-like attribute names, or None where it is absent or unknown."""
    return GRAMMAR.objtypes.get(str(element.get(type_attribute, "")))


def references(top: Node, section: str) -> Iterator[tuple[str, str]]:
    """Namespace and name of what an element of a section, and every element in it, refers to."""
    table = naming_table(section)
    for node in top.iter("*"):
        for key, (kind, namespace) in table.get(str(node.tag), {}).items():
            value = str(node.get(key) or "")
            if kind == REFERS and value:
                yield namespace, value
            elif kind == LISTS:
                yield from ((namespace, each) for each in value.split())
            elif kind == REFERS_BY and value and (target := object_namespace(node, namespace)):
                yield target, value


def declaration(node: Node, section: str) -> tuple[str, str] | None:
    """Namespace and name that an element of a section declares or is given after its file, if it has a name."""
    for key, (kind, namespace) in naming_table(section).get(str(node.tag), {}).items():
        if kind == DECLARES and (value := node.get(key)):
            return namespace, str(value)
    if node.tag in NAMED_AFTER_FILE and section in ("asset", "deformable") and (file := node.get("file")):
        return str(node.tag), stem(str(file))
    return None

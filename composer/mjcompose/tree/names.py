"""The names of a model by namespace, and the references to them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cache
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.words import with_article
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN
from mjcompose.tree.files import NAMED_AFTER_FILE, stem
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.name_order import NameOrder

DECLARES, REFERS, REFERS_BY, LISTS, GENERATES = range(5)
Action = tuple[int, str]

# Elements whose expansion creates names that are not written in the model.
GENERATORS = frozenset({"replicate", "flexcomp", "composite", "attach", "model"})
WORLD = "world"

_WITH = etree.XPath("descendant::*/@*[. = $name]")


class Names(Struct, frozen=False):
    """The declared names by namespace, each with its element."""

    declared: dict[str, dict[str, Node]] = field(default_factory=dict)

    def find(self, namespace: str, name: str) -> Node | None:
        names = self.declared.get(namespace)
        return None if names is None else names.get(name)

    def known(self, namespace: str) -> list[str]:
        return list(self.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        """Return the namespaces in which the name exists."""
        return [namespace for namespace, declared in self.declared.items() if name in declared]


def word(namespace: str, article: bool = False) -> str:
    """Return the noun in messages for a namespace.

    >>> word("default"), word("actuator", article=True)
    ('default class', 'an actuator')
    """
    noun = {"default": "default class", "instance": "plugin instance", "pair": "contact pair"}.get(namespace, namespace)
    return with_article(noun) if article else noun


@cache
def naming_table(section: str) -> dict[str, dict[str, Action]]:
    """Return, for each tag in a section, the attributes with names and their kinds; none for an unknown section."""
    table: dict[str, dict[str, Action]] = {}
    if section in GRAMMAR.root.children:
        for tag, element in GRAMMAR.within(section).items():
            actions: dict[str, Action] = {}
            for name, each in element.attributes.items():
                if each.declares:
                    actions[name] = DECLARES, each.declares
                elif each.refers_by:
                    actions[name] = REFERS_BY, each.refers_by
                elif each.refers and not each.refers.startswith("attached:"):
                    actions[name] = LISTS if each.type == "references" else REFERS, each.refers
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
        if (kind, target) == (REFERS, namespace) or (kind == REFERS_BY and object_namespace(node, target) == namespace):
            yield node, attribute


def references(top: Node, section: str) -> Iterator[tuple[str, str]]:
    """Yield namespace and name of all references of an element of a section, and of every element in it."""
    for node in top.iter("*"):
        for _, namespace, name, _ in own_references(node, section):
            yield namespace, name


def own_references(node: Node, section: str) -> list[tuple[str, str, str, str]]:
    """Return attribute, namespace, name and selector (`objtype`, or empty) of each reference of an element."""
    found = []
    for attribute, kind, namespace in _rows(section).get(node.tag, ()):
        value = node.get(attribute)
        if not value or kind == DECLARES:
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
    names = ((namespace, own_name(node, key)) for key, namespace in declaring(section).get(node.tag, ()))
    return next(((namespace, name) for namespace, name in names if name), None)


def may_be_generated(name: str, root: Node) -> bool:
    """Return whether elements that MuJoCo expands (replicate, flexcomp, …) in that tree can create the name."""
    is_numbered = re.search(r"\d+$", name) is not None
    return any(
        is_numbered
        if each.tag == "replicate"
        else each.tag == "model" or name.startswith(str(each.get("name") or each.get("prefix") or ""))
        for each in root.iter(*GENERATORS)
    )


SEPARATOR = "/"
UP = "../"
"""Before the names of the model that a model of `mjcompose.mjcf` is attached to."""
# MuJoCo allows two `<model>` assets with the same name.
MAY_REPEAT = frozenset({"model"})
ALWAYS = frozenset({("body", WORLD), ("default", MAIN)})
"""Names that exist in every model, with their namespace."""
LEADING_OUT: list[int] = []
"""Its length is the number of models in this process that have referred to something outside themselves."""
_ALWAYS_NAMES = frozenset(name for _, name in ALWAYS)

Use = tuple[Node, str]
"""An element and its attribute that contains a reference."""


class NameIndex(Names, frozen=False):
    """Names and references as written in one model, in both directions.

    `declared` maps names to elements, `uses` maps names to their references; `world` and `main` are in neither,
    because nothing may take these names. A node's names are forgotten before it changes and noted again afterwards.
    `leads_out` is set once a reference begins with `UP`. `repeated` has the names that several elements declare.
    """

    uses: dict[str, dict[str, dict[Use, None]]] = field(default_factory=dict)
    leads_out: bool = False
    repeated: set[tuple[str, str]] = field(default_factory=set)
    _orders: dict[str, tuple[dict[str, Node], NameOrder]] = field(default_factory=dict)

    @classmethod
    def of(cls, root: Node) -> NameIndex:
        """Return the names of a whole `<mujoco>` tree."""
        index = cls()
        for section in root.iterchildren("*"):
            rows = _rows(str(section.tag))
            if rows:
                for node in section.iterdescendants(*rows):
                    index._note_parsed(node, rows[node.tag])
        index.leads_out = any(name.startswith(UP) for names in index.uses.values() for name in names)
        LEADING_OUT.extend([1] if index.leads_out else [])
        return index

    def _note_parsed(self, node: Node, rows: tuple[tuple[str, int, str], ...]) -> None:
        """Add the names of one node of a parsed tree to a new index: as `note` does, in a third of the time."""
        values: dict[str, str] = dict(node.items())  # type: ignore[arg-type]  # text, in a parsed tree
        if not values:
            return
        for attribute, kind, namespace in rows:
            value = values.get(attribute)
            if kind == DECLARES:
                own = value or (own_name(node, attribute) if node.tag in NAMED_AFTER_FILE else None)
                if own and self.declared.setdefault(namespace, {}).setdefault(own, node) is not node:
                    self.repeated.add((namespace, own))
            elif value:
                target = namespace if kind != REFERS_BY else object_namespace(node, namespace)
                names = value.split() if kind == LISTS else (value,)
                for name in names:
                    if target and (name not in _ALWAYS_NAMES or (target, name) not in ALWAYS):
                        self.uses.setdefault(target, {}).setdefault(name, {})[node, attribute] = None

    def note(self, node: Node, section: str, *, declares: bool = True) -> None:
        """Add the names of one node, without the nodes below it; the first of two equal names keeps it."""
        if declares:
            for attribute, namespace in declaring(section).get(node.tag, ()):
                own = own_name(node, attribute)
                if own is None:
                    continue
                if self.declared.setdefault(namespace, {}).setdefault(own, node) is not node:
                    self.repeated.add((namespace, own))
                if namespace in self._orders:
                    self._orders[namespace][1].add(own)
        for attribute, namespace, name, _ in own_references(node, section):
            if name not in _ALWAYS_NAMES or (namespace, name) not in ALWAYS:
                self.uses.setdefault(namespace, {}).setdefault(name, {})[node, attribute] = None
                if not self.leads_out and name.startswith(UP):
                    self.leads_out = True
                    LEADING_OUT.append(1)

    def forget(self, node: Node, section: str) -> None:
        """Drop the names of one node, as they are written in it now."""
        for attribute, namespace in declaring(section).get(node.tag, ()):
            names = self.declared.get(namespace, {})
            own = own_name(node, attribute)
            if own is not None and names.get(own) is node:
                del names[own]
                if namespace in self._orders:
                    self._orders[namespace][1].discard(own)
        for attribute, namespace, name, _ in own_references(node, section):
            known = self.uses.get(namespace, {})
            known.get(name, {}).pop((node, attribute), None)
            if not known.get(name):
                known.pop(name, None)

    def order(self, namespace: str) -> NameOrder:
        """Return the names of a namespace in order, which is made on first use."""
        declared = self.declared.get(namespace, {})
        names, order = self._orders.get(namespace, (None, None))
        # Others than `note` and `forget` only add names, or replace the table.
        if order is None or names is not declared or len(order) != len(declared):
            order = NameOrder(declared)
            self._orders[namespace] = (declared, order)
        return order

    def users(self, namespace: str, name: str) -> list[Use]:
        """Return the references to a name, in the order in which they were added."""
        return list(self.uses.get(namespace, {}).get(name, ()))

    def follow(self, namespace: str, names: Mapping[str, str]) -> None:
        """Change all references to these names to the new names at once, so two names can be swapped."""
        uses = self.uses.get(namespace, {})
        moved = {old: users for old in names if (users := uses.pop(old, None))}
        lists: dict[Use, None] = {}
        for old, users in moved.items():
            for node, attribute in users:
                if node.get(attribute) == old:
                    journal.write(node, attribute, names[old])
                else:
                    lists[node, attribute] = None
        for node, attribute in lists:
            journal.write(node, attribute, " ".join(names.get(each, each) for each in str(node.get(attribute)).split()))
        for old, users in moved.items():
            uses.setdefault(names[old], {}).update(users)


@cache
def _rows(section: str) -> dict[Any, tuple[tuple[str, int, str], ...]]:
    """Return for each tag the attributes that declare names, and then the attributes that refer to names."""
    kinds = (DECLARES,), (REFERS, LISTS, REFERS_BY)
    return {
        tag: tuple((name, *each) for of in kinds for name, each in actions.items() if each[0] in of)
        for tag, actions in naming_table(section).items()
    }


def own_name(node: Node, attribute: str) -> str | None:
    """Return the name that a node declares: the attribute, or MuJoCo's name for an asset from its file."""
    value = node.get(attribute)
    if value:
        return str(value)
    file = node.get("file") if attribute == "name" and node.tag in NAMED_AFTER_FILE else None
    parent = node.getparent() if file else None
    return stem(str(file)) if parent is not None and parent.tag in ("asset", "deformable") else None


def is_list(node: Node, attribute: str, section: str) -> bool:
    """Return whether a referring attribute holds several names."""
    return naming_table(section)[str(node.tag)][attribute][0] == LISTS

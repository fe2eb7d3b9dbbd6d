"""The names of one model by namespace, and the references to them, kept up to date through every edit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cache
from typing import Any

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.tree.classes import MAIN
from composer.tree.files import NAMED_AFTER_FILE, stem
from composer.tree.names import (
    DECLARES,
    LISTS,
    REFERS,
    REFERS_BY,
    WORLD,
    declaring,
    naming_table,
    object_namespace,
    own_references,
)

SEPARATOR = "/"
UP = "../"
"""Before the names of the model that a model of `composer.mjcf` is attached to."""
# MuJoCo allows two `<model>` assets with the same name.
MAY_REPEAT = frozenset({"model"})
ALWAYS = frozenset({("body", WORLD), ("default", MAIN)})
"""Names that exist in every model, with their namespace."""
LEADING_OUT: list[int] = []
"""As long as the number of models of this process, so far, that refer to something outside of themselves."""
_ALWAYS_NAMES = frozenset(name for _, name in ALWAYS)

Use = tuple[Node, str]
"""An element and its attribute that contains a reference."""


@dataclass(slots=True)
class NameIndex:
    """Names and references as written in one model, in both directions.

    `declared` maps names to elements, `uses` maps names to their references; `world` and `main` are in neither,
    because nothing may take these names. A node's names are forgotten before it changes and noted again afterwards.
    `leads_out` is set once a reference begins with `UP`.
    """

    declared: dict[str, dict[str, Node]] = field(default_factory=dict)
    uses: dict[str, dict[str, dict[Use, None]]] = field(default_factory=dict)
    leads_out: bool = False

    @classmethod
    def of(cls, root: Node) -> NameIndex:
        """Return the names of a whole `<mujoco>` tree."""
        index = cls()
        declared, uses = index.declared, index.uses
        for section in root.iterchildren("*"):
            rows = _rows(str(section.tag))
            for node in (
                section.iterdescendants(*rows) if rows else ()
            ):  # as `note` does, in a third of the time
                values: dict[str, str] = dict(node.items())  # type: ignore[arg-type]  # of a parsed tree
                for attribute, kind, namespace in rows[node.tag] if values else ():
                    value = values.get(attribute)
                    if kind == DECLARES:
                        own = value or (own_name(node, attribute) if node.tag in NAMED_AFTER_FILE else None)
                        if own:
                            declared.setdefault(namespace, {}).setdefault(own, node)
                        continue
                    if not value:
                        continue
                    target = namespace if kind != REFERS_BY else object_namespace(node, namespace)
                    for name in value.split() if kind == LISTS else (value,):
                        if target and (name not in _ALWAYS_NAMES or (target, name) not in ALWAYS):
                            uses.setdefault(target, {}).setdefault(name, {})[node, attribute] = None
        index.leads_out = any(name.startswith(UP) for names in uses.values() for name in names)
        LEADING_OUT.extend([1] if index.leads_out else [])
        return index

    def find(self, namespace: str, name: str) -> Node | None:
        names = self.declared.get(namespace)
        return None if names is None else names.get(name)

    def note(self, node: Node, section: str, *, declares: bool = True) -> None:
        """Add the names of one node, without the nodes below it; the first of two equal names keeps it."""
        for attribute, namespace in declaring(section).get(node.tag, ()) if declares else ():
            if (own := own_name(node, attribute)) is not None:
                self.declared.setdefault(namespace, {}).setdefault(own, node)
        for attribute, namespace, name, _ in own_references(node, section):
            if name not in _ALWAYS_NAMES or (namespace, name) not in ALWAYS:
                self.uses.setdefault(namespace, {}).setdefault(name, {})[node, attribute] = None
                if not self.leads_out and name.startswith(UP):
                    self.leads_out = True
                    LEADING_OUT.append(1)

    def forget(self, node: Node, section: str) -> None:
        """Drop the names of one node, as they are written in it now."""
        for attribute, namespace in declaring(section).get(node.tag, ()):
            names, own = self.declared.get(namespace, {}), own_name(node, attribute)
            if own is not None and names.get(own) is node:
                del names[own]
        for attribute, namespace, name, _ in own_references(node, section):
            users = self.uses.get(namespace, {}).get(name, {})
            users.pop((node, attribute), None)
            if not users:
                self.uses.get(namespace, {}).pop(name, None)

    def users(self, namespace: str, name: str) -> list[Use]:
        """Return the references to a name, in the order in which they were added."""
        return list(self.uses.get(namespace, {}).get(name, ()))

    def follow(self, namespace: str, names: Mapping[str, str]) -> None:
        """Change all references to these names to the new ones, all at once, so that two names can swap."""
        uses = self.uses.get(namespace, {})
        moved = {old: users for old in names if (users := uses.pop(old, None))}
        lists: dict[Use, None] = {}
        for old, users in moved.items():
            new = names[old]
            for node, attribute in users:
                if node.get(attribute) == old:
                    node.set(attribute, new)
                else:
                    lists[node, attribute] = None
        for node, attribute in lists:
            node.set(attribute, " ".join(names.get(each, each) for each in str(node.get(attribute)).split()))
        for old, users in moved.items():
            uses.setdefault(names[old], {}).update(users)


@cache
def _rows(section: str) -> dict[Any, tuple[tuple[str, int, str], ...]]:
    """Return for each tag the attributes that declare names, and then those that refer to names."""
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
    if attribute == "name" and node.tag in NAMED_AFTER_FILE:
        file = node.get("file")
        parent = node.getparent()
        if file and parent is not None and parent.tag in ("asset", "deformable"):
            return stem(str(file))
    return None


def is_list(node: Node, attribute: str, section: str) -> bool:
    """Return whether a referring attribute holds several names."""
    return naming_table(section)[str(node.tag)][attribute][0] == LISTS

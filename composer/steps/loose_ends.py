"""Names that the recipe's own elements declare and refer to, checked against the whole model."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.suggest import closest, exists_note
from composer.link.linking import Linking
from composer.link.names import may_be_generated
from composer.steps.elements import Making
from composer.tree.names import DECLARES, LISTS, REFERS, WORLD, naming_table, object_namespace


def check_names(linking: Linking, making: Making) -> None:
    """First every new name is declared, then every reference looked up: elements may refer to later ones."""
    references: list[tuple[Node, str, str, str]] = []
    for top, section in making.registered:
        table = naming_table(section)
        for node in top.iter():
            actions = table.get(node.tag, {})  # type: ignore[call-overload]
            for name, value in node.items():
                action = actions.get(name)
                if action is None or not value:
                    continue
                kind, namespace = action
                if kind == DECLARES:
                    _declare(linking, making, node, name, namespace, value)
                elif kind == REFERS:
                    references.append((node, name, namespace, value))
                elif kind == LISTS:
                    references.extend((node, name, namespace, item) for item in value.split())
                else:
                    target = object_namespace(node, namespace)
                    if target:
                        references.append((node, name, target, value))
    for node, name, namespace, value in references:
        _look_up(linking, making, node, name, namespace, value)


def _declare(linking: Linking, making: Making, node: Node, name: str, namespace: str, value: str) -> None:
    known = linking.names.declared.setdefault(namespace, {})
    earlier = known.setdefault(value, node)
    if earlier is not node and namespace != "key":
        making.sink.error(
            "name-clash",
            f"there is a {namespace} `{value}` already",
            _span(making, linking, node, name),
            notes=(Note("it is declared here", linking.span(linking.base, earlier)),),
        )


def _look_up(linking: Linking, making: Making, node: Node, name: str, namespace: str, value: str) -> None:
    names = linking.names
    if names.find(namespace, value) is not None or (namespace == "body" and value == WORLD):
        return
    if namespace == "default" and value == "main":
        if linking.base_class is not None:
            node.set(name, linking.base_class)
        return
    if may_be_generated(value, "", linking.base.root):
        return
    near = closest(value, names.of(namespace))
    making.sink.error(
        "unknown-name",
        f"there is no {namespace} `{value}`",
        _span(making, linking, node, name),
        notes=(exists_note(namespace, names.of(namespace), value),),
        help=f"did you mean `{name}: {near[0]}`?" if near else None,
    )


def _span(making: Making, linking: Linking, node: Node, name: str):  # type: ignore[no-untyped-def]
    element = making.made.get(node)
    if element is None:
        return linking.span(linking.base, node)
    return making.span(element, name)

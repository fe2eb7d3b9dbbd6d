"""Check the names that the recipe's own elements declare and refer to against the whole model."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.compose.elements import ElementBuilder
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.key_layouts import keys_of
from composer.link.linking import Linking
from composer.tree.classes import MAIN
from composer.tree.names import DECLARES, naming_table, own_references, word
from composer.tree.references import resolves, unresolved


def check_names(linking: Linking, making: ElementBuilder) -> None:
    """First every new name is declared, then every reference looked up: elements may refer to later ones.

    Those to keys wait for `check_names_of_keys`.
    """
    references: list[tuple[Node, str, str, str, str]] = []
    for top, section in making.registered:
        for node in top.iter("*"):
            written = making.written(node)
            for name, (kind, namespace) in naming_table(section).get(str(node.tag), {}).items():
                if kind == DECLARES and name in written and (value := node.get(name)):
                    _declare(linking, making, node, name=name, namespace=namespace, value=str(value))
            references += [(node, *each) for each in own_references(node, section) if each[0] in written]
    for node, name, namespace, value, typed_by in references:
        if namespace == "key":
            making.of_keys.append((node, name, value, typed_by))
        else:
            _look_up(linking, making, node, name=name, namespace=namespace, value=value, typed_by=typed_by)


def check_names_of_keys(linking: Linking, making: ElementBuilder) -> None:
    """Look up the references to keys, when these are laid out."""
    if making.of_keys:
        linking.names.declared["key"] = {str(key.get("name") or ""): key for key in keys_of(linking.base)}
    for node, name, value, typed_by in making.of_keys:
        _look_up(linking, making, node, name=name, namespace="key", value=value, typed_by=typed_by)


def check_class(linking: Linking, sink: Sink, name: str, span: Span) -> None:
    """Report a default class that the recipe names by its final name and that does not exist."""
    if name != MAIN and linking.find_node("default", name) is None:
        sink.add(unresolved(linking, "default", name, span=span, written="class: {}"))


def refer_to_top_class(linking: Linking, node: Node, attribute: str) -> bool:
    """If the attribute names the class `main`, write its name in the model. Return whether it does."""
    if node.get(attribute) != MAIN:
        return False
    if linking.base_class is not None:
        node.set(attribute, linking.base_class)
    return True


def _declare(
    linking: Linking, making: ElementBuilder, node: Node, name: str, namespace: str, value: str
) -> None:
    known = linking.names.declared.setdefault(namespace, {})
    earlier = known.setdefault(value, node)
    if earlier is not node and namespace != "key":
        making.sink.error(
            "class-clash" if namespace == "default" else "name-clash",
            f"the name `{value}` is taken by another {word(namespace)}",
            making.span_of(node, name),
            notes=(Note("it is declared here", linking.span(linking.base, earlier, "name")),),
            help="choose another name",
            subjects=(value,),
        )


def _look_up(
    linking: Linking, making: ElementBuilder, node: Node, name: str, namespace: str, value: str, typed_by: str
) -> None:
    if namespace == "default" and refer_to_top_class(linking, node, name):
        return
    if not resolves(linking, namespace, value):
        span = making.span_of(node, name)
        making.sink.add(
            unresolved(linking, namespace, value, span=span, written=f"{name}: {{}}", typed_by=typed_by)
        )

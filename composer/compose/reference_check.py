"""Names that the recipe's own elements declare and refer to, checked against the whole model."""

from __future__ import annotations

from collections.abc import Iterable

from lxml.etree import _Element as Node

from composer.compose.elements import ElementBuilder
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import closest, exists_note
from composer.grammar import GRAMMAR
from composer.link.key_layouts import keys_of
from composer.link.linking import Linking
from composer.link.names import may_be_generated
from composer.tree.classes import MAIN
from composer.tree.names import (
    DECLARES,
    LISTS,
    REFERS,
    REFERS_BY,
    WORLD,
    naming_table,
    object_namespace,
    word,
)


def check_names(linking: Linking, making: ElementBuilder) -> None:
    """First every new name is declared, then every reference looked up: elements may refer to later ones.

    Those to keys wait for `check_names_of_keys`.
    """
    references: list[tuple[Node, str, str, str, str]] = []
    for top, section in making.registered:
        table = naming_table(section)
        for node in top.iter("*"):
            actions = table.get(str(node.tag), {})
            written = making.written(node)
            for key, text in node.items():
                name, value = str(key), str(text)
                action = actions.get(name)
                if action is None or not value or name not in written:
                    continue
                kind, namespace = action
                if kind == DECLARES:
                    _declare(linking, making, node, name, namespace, value)
                elif kind == REFERS:
                    references.append((node, name, namespace, value, ""))
                elif kind == LISTS:
                    references.extend((node, name, namespace, item, "") for item in value.split())
                elif kind == REFERS_BY:
                    target = object_namespace(node, namespace)
                    if target:
                        references.append((node, name, target, value, namespace))
    for node, name, namespace, value, typed_by in references:
        if namespace == "key":
            making.of_keys.append((node, name, value, typed_by))
        else:
            _look_up(linking, making, node, name, namespace, value, typed_by)


def check_names_of_keys(linking: Linking, making: ElementBuilder) -> None:
    """Look up the references to keys, when these are laid out."""
    if making.of_keys:
        linking.names.declared["key"] = {str(key.get("name") or ""): key for key in keys_of(linking.base)}
    for node, name, value, typed_by in making.of_keys:
        _look_up(linking, making, node, name, "key", value, typed_by)


def check_class(linking: Linking, sink: Sink, name: str, span: Span) -> None:
    """Tell it where a default class that the recipe names by its final name is not there."""
    if name != MAIN and linking.names.find("default", name) is None:
        not_there(linking, sink, "default", name, span, "class: NAME")


def not_there(
    linking: Linking,
    sink: Sink,
    namespace: str,
    name: str,
    span: Span,
    written: str,
    *,
    purpose: str = "",
    help: str | None = None,
) -> None:
    """Tell that nothing of that kind has that name; `written` is how a recipe writes another NAME there."""
    names = linking.names.of(namespace)
    near = closest(name, names)
    notes: Iterable[Note] = (exists_note(word(namespace), names, name),)
    if help is None and near:
        help = f"did you mean `{written.replace('NAME', near[0])}`?"
    elif help is None:
        other = [kind for kind in linking.names.kinds_of(name) if kind != namespace]
        notes = (*(Note(f"`{name}` is {word(kind, article=True)}") for kind in other[:1]), *notes)
    sink.error(
        "unknown-name",
        f"there is no {word(namespace)} `{name}`{purpose}",
        span,
        notes=notes,
        help=help,
        subjects=(name,),
    )


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
    names = linking.names
    if names.find(namespace, value) is not None or (namespace == "body" and value == WORLD):
        return
    if namespace == "default" and value == MAIN:
        if linking.base_class is not None:
            node.set(name, linking.base_class)
        return
    if may_be_generated(value, linking.base.root):
        return
    help = None
    if typed_by:
        types = [kind for kind in names.kinds_of(value) if GRAMMAR.objtypes.get(kind) == kind]
        help = (
            f"`{value}` is {word(types[0], article=True)}: write `{typed_by}: {types[0]}`" if types else None
        )
    not_there(linking, making.sink, namespace, value, making.span_of(node, name), f"{name}: NAME", help=help)

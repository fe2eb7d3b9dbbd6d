"""The words of other packages in a recipe: they are loaded, or refused in a recipe that was fetched."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mjcompose.base import extensions
from mjcompose.base.diagnostic import DiagnosticError, Span
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import Plan
from mjcompose.language.check import KINDS, SEVERITY
from mjcompose.language.datasheets import SHEETS, library
from mjcompose.language.edit import VERBS, Edit
from mjcompose.sources.kinds import EXTENDED
from mjcompose.sources.reference import Origin
from mjcompose.text.node import Mapping, Node, Scalar, Sequence

_TABLES: dict[str, extensions.Table[Any]] = {"checks": KINDS, "verbs": VERBS, "datasheets": SHEETS}
_OURS = {"checks": {*KINDS.own, SEVERITY, "when"}, "verbs": {*Edit.key_names()}}


def load_named_extensions(node: Mapping, origin: Origin | None, sink: Sink) -> None:
    """Load the extensions for the words of one file. If it was fetched with `origin`, they are errors.

    Words that no installed package knows are left to the validation.
    """
    for group, word, span in _words(node):
        try:
            if origin is not None and origin.is_fetched:
                if extensions.is_registered(group, word):
                    raise extensions.refuse(group, word, origin.id)
            elif word not in (table := _TABLES[group]) and extensions.is_registered(group, word):
                table[word]
        except DiagnosticError as error:
            sink.add(error.at(span))


def load_all() -> list[DiagnosticError]:
    """Load the extensions of all installed packages, for editors; return the failures."""
    return [error for table in [*_TABLES.values(), EXTENDED] for error in table.load_all()]


def packages_of(plan: Plan) -> dict[str, str]:
    """Return the packages whose code the recipes of a plan name, with their versions."""
    if not extensions.LOADED:
        return {}
    words = [(group, word) for each in plan.plans() for group, word, _ in _words(each.document)]
    words += [("sources", source.kind.name) for source in plan.sources()]
    words += [("sources", source.origin.kind.name) for source in plan.sources() if source.origin is not None]
    return extensions.versions(words)


def _words(node: Node) -> Iterator[tuple[str, str, Span]]:
    """Yield each word that may be one of another package, with its group and its place."""
    waiting: list[Node] = [node]
    while waiting:
        each = waiting.pop()
        if isinstance(each, Sequence):
            waiting += each.items
        if not isinstance(each, Mapping):
            continue
        for name, (_, value) in each.entries.items():
            if name == "check" and isinstance(value, Mapping):
                for _, check in value.entries.values():
                    yield from _foreign_words("checks", check)
            elif name == "edit" and isinstance(value, Sequence):
                for entry in value.items:
                    yield from _foreign_words("verbs", entry)
                    yield from _sheets(entry)
            waiting.append(value)


def _foreign_words(group: str, node: Node) -> Iterator[tuple[str, str, Span]]:
    if isinstance(node, Mapping):
        yield from ((group, word, key.span) for word, (key, _) in node.entries.items() if word not in _OURS[group])


def _sheets(entry: Node) -> Iterator[tuple[str, str, Span]]:
    verb = entry.entries.get("datasheet") if isinstance(entry, Mapping) else None
    model = verb[1].entries.get("model") if verb is not None and isinstance(verb[1], Mapping) else None
    if model is not None and isinstance(model[1], Scalar) and model[1].text not in library():
        yield "datasheets", model[1].text, model[1].span

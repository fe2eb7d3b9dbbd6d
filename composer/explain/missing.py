"""Report a query that matches nothing in the model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.diagnostics.unknown import unknown_attribute
from composer.explain.derived import derived_names
from composer.explain.query import Asked, find, labels, name_of, ordered
from composer.tree.kinds import kind_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


def not_found(asked: Asked, root: Node, sink: Sink, notes: Iterable[Note] = ()) -> None:
    """Report that nothing matches a query, what exists, and what was probably meant."""
    notes = tuple(notes)
    word = asked.text.split()[0].split("#")[0] if asked.kinds is not None else "element"
    if asked.line is not None:
        file, line = asked.line
        sink.error("unknown-name", f"nothing in the model comes from `{file}:{line}`", notes=notes)
    elif asked.number is not None:
        count = len(find(Asked(asked.text, asked.kinds), root, "/"))
        existing = f"there are {count}, the first is `{word}#0`" if count else "there are none"
        sink.error("unknown-name", f"`{word}#{asked.number}` does not exist: {existing}", notes=notes)
    elif asked.name is None:
        sink.error("unknown-name", f"the model has no {word}", notes=notes)
    else:
        _no_such_name(asked, asked.name, word, root=root, sink=sink, notes=notes)


def _no_such_name(
    asked: Asked, name: str, word: str, root: Node, sink: Sink, notes: tuple[Note, ...]
) -> None:
    fitting = find(Asked("", asked.kinds), root, "/")
    names = [found for node in fitting if (found := name_of(node)) is not None]
    other = next((node for node in ordered(root) if name_of(node) == name), None)
    help = did_you_mean(name, names, f"{f'{word} ' if asked.kinds else ''}{{}}")
    if other is not None:
        help = f"did you mean `{labels(root)[other]}`?"
    unnamed = len(fitting) - len(names) if asked.kinds else 0
    if unnamed:
        count = "there is 1" if unnamed == 1 else f"there are {unnamed}"
        notes = (*notes, Note(f"{count} without a name: write `{word}#0`, …"))
    if names or not unnamed:
        notes = (*notes, exists_note(word, names, name))
    missing = f"nothing in the model is called `{name}`"
    message = missing if asked.kinds is None else f"the {word} `{name}` does not exist"
    sink.error("unknown-name", message, notes=notes, help=help)


def no_attribute(node: Node, name: str, sink: Sink) -> None:
    """Report that elements of this kind do not have the attribute."""
    known = sorted({*kind_of(node).attributes, *derived_names(kind_of(node))})
    sink.add(unknown_attribute(name, f"`<{node.tag}>`", known))

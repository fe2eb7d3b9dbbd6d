"""Hover for a setting of the whole model: the value of each part, and the value in effect."""

from __future__ import annotations

from collections.abc import Iterator

from composer.grammar import GRAMMAR
from composer.lsp.answers import Hover
from composer.lsp.language import doc_of
from composer.lsp.question import Question

SECTIONS = ("option", "size", "statistic", "visual")


def show(question: Question) -> Hover | None:
    """Return the setting at the cursor with the value of each part, or None."""
    path = (*question.path, question.cursor.whole) if question.cursor.role == "key" else question.path
    if len(path) < 2 or path[0] not in SECTIONS or not all(isinstance(step, str) for step in path):
        return None
    place = "/".join(map(str, path[:-1]))
    if place not in GRAMMAR.paths or path[-1] not in GRAMMAR.element(place).attributes:
        return None
    lines = [f"**`{'.'.join(map(str, path))}`**", "", doc_of(path, question.data), ""]
    rows = list(_wishes(tuple(map(str, path)), question))
    if rows:
        lines += ["| who | wants |", "|---|---|", *rows]
    return Hover("\n".join(lines), question.word)


def _wishes(path: tuple[str, ...], question: Question) -> Iterator[str]:
    analysis = question.analysis
    for part, unit in analysis.names.sources.items():
        for element in unit.root.iterfind("/".join(path[:-1])):
            value = element.get(path[-1])
            if value is not None:
                span = unit.origins.span(element, unit.file, path[-1])
                yield f"| `{part}` | `{value}` ({span.file}:{span.line}) |"
    if analysis.model is not None:
        for element in analysis.model.unit.root.iterfind("/".join(path[:-1])):
            if (value := element.get(path[-1])) is not None:
                yield f"| **the model** | **`{value}`** |"

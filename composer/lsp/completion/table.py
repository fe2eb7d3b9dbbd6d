"""All kinds of completion, one row for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from composer.diagnostics.span import Span
from composer.document.quote import quoted
from composer.lsp.answers import Completion, Item
from composer.lsp.completion import expressions, keys, names, parameters, references, selectors, words
from composer.lsp.question import Question

Offer = Callable[[Question], Iterator[Item]]
_OPENING = ("*", "&", "!", "|", ">", "%", "@", "`", '"', "'", "#", "?", "{", "}", "[", "]", ",", ":", "-")
OFFERS: tuple[Offer, ...] = (
    names.offer,
    parameters.offer,
    references.offer,
    selectors.offer,
    words.offer,
    keys.offer,
)


def complete(question: Question) -> Completion:
    """Return the completions at the cursor. Inside `${…}`, only parts of expressions are offered."""
    cursor = question.cursor
    if cursor.role == "text":
        return Completion()
    name = expressions.begun(question)
    if name is not None:
        begin = cursor.start + len(cursor.word) - len(name)
        return Completion(tuple(expressions.offer(question)), _span(question, begin, question.column))
    found: dict[str, Item] = {}
    for offer in OFFERS:
        for item in offer(question):
            found.setdefault(item.label, item)
    items = sorted((_quoted(each, question) for each in found.values()), key=lambda each: each.rank)
    return Completion(tuple(items), _span(question, cursor.start, cursor.end))


def _quoted(item: Item, question: Question) -> Item:
    """Return a value in quotes if it needs quotes in YAML and has none yet."""
    cursor = question.cursor
    plain = item.label[:1] not in _OPENING and not any(each in item.label for each in (": ", " #"))
    if cursor.in_flow:
        plain = plain and not any(each in item.label for each in ",[]{}")
    if item.insert or cursor.quote or plain:
        return item
    return replace(item, insert=quoted(item.label))


def _span(question: Question, start: int, end: int) -> Span:
    return Span(question.analysis.file, question.line + 1, start + 1, question.line + 1, end + 1)

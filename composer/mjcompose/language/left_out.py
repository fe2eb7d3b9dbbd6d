"""Entries that a recipe writes and that its model leaves out: by `when`, by an empty `for`, or with another variant."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping as Map
from fnmatch import fnmatchcase
from typing import Literal, NamedTuple

from mjcompose.base.diagnostic import Span
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError, Value, shown
from mjcompose.text.merge import Path
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, is_template, walk

_EXPRESSION = re.compile(r"\$\{[^}]*\}")
_OF_SECTIONS = {"attach": "part", "keyframe": "key"}
"""The sections whose keys are names: of parts, and of keys of a model."""


class LeftOut(NamedTuple):
    """An entry that is left out, with the condition, the `for` or the variant that did it, and the values at that time.

    `cause` is the value of `when` or `for`, and for a variant the key of the piece.
    """

    path: Path
    entry: Node
    by: Literal["when", "for", "variant"]
    cause: Node
    scope: Map[str, Value]

    @property
    def span(self) -> Span:
        return self.cause.span

    @property
    def words(self) -> str:
        """The reason in words, with the text of the condition and the values that it looks at."""
        if self.by == "variant":
            assert isinstance(self.cause, Scalar)
            axis = str(self.path[1])
            return f"belongs to `{axis}: {self.cause.text}`, and this model has `{axis}: {shown(self.scope[axis])}`"
        if self.by == "for":
            return "its `for` has no values, so it makes no entry"
        if isinstance(self.cause, Scalar) and self.cause.value is False:
            return "its `when` is false"
        values = ", ".join(f"`{name}` is {shown(self.scope[name])}" for name in _looked_at(self.cause, self.scope))
        return f"`when: {_text(self.cause)}` is false{f': {values}' if values else ''}"

    def names(self) -> Iterator[EntryName]:
        """Yield the names in the entry. Without its own name, an element cannot be found."""
        around = () if self.by == "variant" else self.path
        for visit in walk(self.entry, around):
            path = visit.path
            if len(path) == 2 and path[0] in _OF_SECTIONS:
                yield EntryName(_OF_SECTIONS[str(path[0])], self._settled(str(path[1])), visit.node.span)
            elif path[-1:] == ("name",) and isinstance(visit.node, Scalar):
                tags = [str(step) for step in path[:-1] if isinstance(step, str)]
                yield EntryName(tags[-1] if tags else "", self._settled(visit.node.text), visit.node.span)

    def covers(self, file: str, line: int) -> bool:
        """Return whether a line of a file has a piece of the entry."""
        spans = [visit.node.span for visit in walk(self.entry)]
        spans += [visit.key.span for visit in walk(self.entry) if visit.key is not None]
        return any(span.line == line and span.is_in(file) for span in spans)

    def _settled(self, text: str) -> str:
        try:
            return str(Template.parse(text).value(self.scope)) if is_template(text) else text
        except ExpressionError:  # of the names of a `for` without values
            return _EXPRESSION.sub("*", text)


class EntryName(NamedTuple):
    """A name that an entry gives to an element, a part or a key, with its tag, or `part` or `key`."""

    tag: str
    name: str
    span: Span

    def is_of(self, name: str) -> bool:
        return fnmatchcase(name, self.name) if "*" in self.name else name == self.name


def other_pieces(document: Mapping, chosen: Map[str, str], scope: Map[str, Value]) -> Iterator[LeftOut]:
    """Yield the pieces of the variants of a recipe that were not chosen."""
    variants = document.entries.get("variants")
    axes = variants[1].entries if variants is not None and isinstance(variants[1], Mapping) else {}
    for axis, (_, pieces) in axes.items():
        if axis not in chosen or not isinstance(pieces, Mapping):
            continue
        for value, (key, piece) in pieces.entries.items():
            if value != chosen[axis]:
                cause = Scalar(value, key.span, value, plain=True)
                yield LeftOut(("variants", axis, value), piece, "variant", cause, scope)


def _looked_at(condition: Node, scope: Map[str, Value]) -> list[str]:
    """Return the names whose values a condition looks at."""
    names: list[str] = []
    if isinstance(condition, Mapping):
        names = list(condition.entries)
    elif isinstance(condition, Scalar) and is_template(condition.text):
        names = [each.name for each in Template.parse(condition.text).names()]
    return [name for name in dict.fromkeys(names) if name in scope]


def _text(node: Node) -> str:
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {_text(value)}' for name, (_, value) in node.entries.items())}}}"
    if isinstance(node, Sequence):
        return f"[{', '.join(map(_text, node.items))}]"
    return node.text

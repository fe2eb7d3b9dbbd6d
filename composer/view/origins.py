"""The origin of every element of a model, as data for the page."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.side import Side
from composer.explain import query
from composer.explain.explanation import Changed
from composer.explain.traced import Traced
from composer.view.names import Names

KINDS = ("body", "joint", "geom", "site", "camera", "light", "tendon", "actuator", "key", "skin", "flex")
_MOST_CHANGES = 12

Place = list[int] | None
"""The number of a file, a line and a column."""


@dataclass(slots=True)
class _Table:
    """Repeated texts, each stored once."""

    rows: dict[str, int] = field(default_factory=dict)

    def number(self, text: str) -> int:
        return self.rows.setdefault(text, len(self.rows))


class Origins:
    """The origins of elements for the page.

    Files have the names in `names`, or their reference if they were fetched. `absolute` has the files of this
    machine by these names, for links into an editor.
    """

    def __init__(self, side: Side, names: Names) -> None:
        self.side, self.names = side, names
        self.absolute: dict[str, str] = {}
        self._files, self._parts = _Table(), _Table()
        self._part_places: list[Any] = []
        self._numbers: dict[str, int] = {}

    def data(self, names: Mapping[str, Sequence[str]], excluded: Sequence[tuple[str, str]]) -> dict[str, Any]:
        """Return for each kind a list as long as its `names`: place, part, words and changes of an element, or null.

        `excluded` are the pairs of bodies that are excluded from contact; there is a list for these too.
        """
        traced = self.side.traced
        of = (
            {}
            if traced is None
            else {kind: self._of_kind(kind, names[kind], traced) for kind in KINDS if kind in names}
        )
        exclude = self._of_excludes(excluded)  # the files that it names are listed, too
        return {"files": list(self._files.rows), "parts": self._part_places, "of": of, "exclude": exclude}

    def _of_excludes(self, pairs: Sequence[tuple[str, str]]) -> list[Any]:
        """Return for each pair its place, words, and why it is excluded, or null: `exclude: auto` has a reason."""
        why = {frozenset((each.one, each.other)): each.why for each in self.side.excluded if each.why}
        traced = self.side.traced
        nodes = () if traced is None else traced.model.root.iterfind("contact/exclude")
        found = {frozenset((str(node.get("body1")), str(node.get("body2")))): node for node in nodes}
        rows: list[Any] = []
        for pair in map(frozenset, pairs):
            place, words = None, ""
            if traced is not None and pair in found:
                place, _, words, _ = self._element(found[pair], traced)
            rows.append([place, words, why.get(pair)])
        return rows

    def _of_kind(self, kind: str, names: Sequence[str], traced: Traced) -> list[Any]:
        asked = query.read(kind, None, Sink())
        nodes = [] if asked is None else query.find(asked, traced.model.root, traced.separator)
        if len(nodes) == len(names):
            return [self._element(node, traced) for node in nodes]
        # Copies made by MuJoCo have no node of their own.
        known = {name: node for node in nodes if (name := query.name_of(node)) is not None}
        return [self._element(known[name], traced) if name in known else None for name in names]

    def _element(self, node: Any, traced: Traced) -> list[Any]:
        life = traced.watch.life(node)
        written = list(traced.written(life))
        place = next((self._place(each.span) for each in written if each.span is not None), None)
        words = " ".join(dict.fromkeys(each.words for each in written if each.words != "read from"))
        changes = [self._change(each) for each in list(traced.changes(life))[:_MOST_CHANGES]]
        parts = list(traced.parts(life))
        part = self._part(parts[0].words, parts[0].span) if parts else -1
        return [place, part, words, changes]

    def _change(self, change: Changed) -> list[Any]:
        what = change.attribute or ""
        return [what, change.before, change.after, change.reason.words, self._place(change.reason.span)]

    def _part(self, words: str, span: Span | None) -> int:
        number = self._parts.number(words)
        if number == len(self._part_places):
            self._part_places.append([words, self._place(span)])
        return number

    def _place(self, span: Span | None) -> Place:
        if span is None or span.file.startswith("--"):
            return None
        if span.file not in self._numbers:
            self._numbers[span.file] = self._number(span)
        return [self._numbers[span.file], span.line, span.column]

    def _number(self, span: Span) -> int:
        """Return the number of the file. Finding out how a file was fetched takes long, so it is done once for each."""
        operand = self.side.operand
        name = self.names.of(operand.located(span).file)
        if os.path.isfile(path := os.path.abspath(operand.context.folder / span.file)):
            self.absolute.setdefault(name, path)
        return self._files.number(name)

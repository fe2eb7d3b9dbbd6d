"""Find the lines that differ between the files of A and B: only such a line can cause a difference."""

from __future__ import annotations

import os
from collections.abc import Iterator
from difflib import SequenceMatcher
from pathlib import Path

from composer.diagnostics.span import Span
from composer.diff.change import Cause
from composer.diff.excerpt import extent
from composer.diff.recipes import Recipes
from composer.diff.side import Side


class Written:
    """The files of both sides, each with its counterpart on the other side."""

    def __init__(self, a: Recipes, b: Recipes) -> None:
        self.sides = a.side, b.side
        self._known: dict[tuple[str, str], tuple[frozenset[int], frozenset[int]]] = {}
        self._named = tuple(
            {name(each.side, file): file for file in _files(each.side, each)} for each in (a, b)
        )
        self._paths = tuple(
            {real(each.side, file): file for file in _files(each.side, each)} for each in (a, b)
        )

    def changed(self, side: int, span: Span | None) -> Span | None:
        """Return the first line of a place that the other side does not have, or None if it has all of them."""
        if span is None:
            return None
        lines = extent(span, self.sides[side])
        there = self._counterpart(side, span.file)
        if there is None:
            return span
        pair = (span.file, there) if side == 0 else (there, span.file)
        changed = self._lines(*pair)[side]
        for number in lines:
            if number == span.line and number in changed:
                return span
            if number in changed:
                return _line(self.sides[side], span.file, number)
        return None

    def twin(self, side: int, span: Span) -> Span | None:
        """Return the line of the other side that takes the place of a differing line."""
        there = self._counterpart(side, span.file)
        if there is None:
            return None
        for ends in self._stretches(*((span.file, there) if side == 0 else (there, span.file))):
            here, other = (ends[:2], ends[2:]) if side == 0 else (ends[2:], ends[:2])
            if here[0] < span.line <= here[1] and here[1] - here[0] == other[1] - other[0]:
                return _line(self.sides[1 - side], there, span.line + other[0] - here[0])
        return None

    def is_within(self, side: int, item: Span, span: Span) -> bool:
        """Return whether a place lies in an item of a recipe."""
        return item.file == span.file and span.line in extent(item, self.sides[side])

    def only(self) -> Cause | None:
        """Return the differing stretch of lines if it is the only one in all files, and so the only possible cause."""
        found: list[Cause] = []
        pairs = {(file, self._counterpart(0, file)) for file in self._named[0].values()} | {
            (self._counterpart(1, file), file) for file in self._named[1].values()
        }
        for a, b in pairs:
            if a is None or b is None:
                return None
            for first, last, start, end in self._stretches(a, b):
                before = _line(self.sides[0], a, first + 1) if last > first else None
                after = _line(self.sides[1], b, start + 1) if end > start else None
                found.append(Cause("line", before, after))
        return found[0] if len(found) == 1 else None

    def _counterpart(self, side: int, file: str) -> str | None:
        """Return the file at the same place on the other side; the counterpart of A itself is B."""
        here, there = self.sides[side], self.sides[1 - side]
        if (found := self._paths[1 - side].get(real(here, file))) is not None:
            return found
        called = name(here, file)
        if (found := self._named[1 - side].get(called)) is not None:
            return found
        mains = [each.operand.context.shown(each.operand.path) for each in (here, there)]
        alike = Path(mains[0]).suffix == Path(mains[1]).suffix and here.operand.kind is there.operand.kind
        if file == mains[0] and alike and name(there, mains[1]) not in self._named[side]:
            return mains[1]
        lines = here.lines(file)  # in a renamed file, every line is known
        return next((each for each in self._named[1 - side].values() if there.lines(each) == lines), None)

    def _lines(self, a: str, b: str) -> tuple[frozenset[int], frozenset[int]]:
        """Return the numbers of the lines that only A has, and of those that only B has."""
        if (a, b) not in self._known:
            found: tuple[set[int], set[int]] = set(), set()
            for first, last, start, end in self._stretches(a, b):
                found[0].update(range(first + 1, last + 1))
                found[1].update(range(start + 1, end + 1))
            self._known[a, b] = frozenset(found[0]), frozenset(found[1])
        return self._known[a, b]

    def _stretches(self, a: str, b: str) -> list[tuple[int, int, int, int]]:
        ours, theirs = (
            [line.strip() for line in side.lines(file)] for side, file in zip(self.sides, (a, b), strict=True)
        )
        return list(_different(ours, theirs))


def name(side: Side, file: str | None) -> str:
    """Return a file's path relative to A or B, so that two folders with the same layout have equal paths.

    A fetched file is named by its reference, whatever the commit or archive.
    """
    operand = side.operand
    there = operand.context.folder / (file or "")
    return operand.fetched(there) or os.path.relpath(there, operand.path.parent)


def real(side: Side, file: str | None) -> str:
    """Return the real path of a file, by which two sides can share one."""
    return os.path.realpath(side.operand.context.folder / (file or ""))


def _files(side: Side, recipes: Recipes) -> Iterator[str]:
    """Yield every file of the model, as messages name it."""
    yield side.operand.context.shown(side.operand.path)
    yield from recipes.files
    if side.traced is not None:
        yield from dict.fromkeys(
            life.owner for life in side.traced.watch.lives.values() if isinstance(life.owner, str)
        )


def _different(ours: list[str], theirs: list[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the stretches of lines that differ. Common lines at the start and the end are skipped quickly."""
    head = next(
        (at for at, (x, y) in enumerate(zip(ours, theirs, strict=False)) if x != y),
        min(len(ours), len(theirs)),
    )
    rest = min(len(ours), len(theirs)) - head
    tail = next(
        (at for at, (x, y) in enumerate(zip(ours[::-1], theirs[::-1], strict=False)) if x != y or at == rest),
        rest,
    )
    mine, yours = ours[head : len(ours) - tail], theirs[head : len(theirs) - tail]
    for tag, first, last, start, end in SequenceMatcher(None, mine, yours, autojunk=False).get_opcodes():
        if tag != "equal":
            yield first + head, last + head, start + head, end + head


def _line(side: Side, file: str, number: int) -> Span:
    text = side.lines(file)[number - 1]
    return Span(file, number, len(text) - len(text.lstrip()) + 1)

"""Whether every origin that `explain` names is true: the text that stands there is the value, or what changed it is named.

`faults` asks for every attribute of every element of a model that was put together under observation. It reads the files
itself: nothing but the answers comes from the code that it judges.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import unescape
from itertools import permutations
from pathlib import Path

from lxml.etree import _Element as Node
from mjcompose.base.diagnostic import Span
from mjcompose.base.rotation import quat_from_axisangle, quat_from_euler
from mjcompose.trace.explanation import ChangeExplained, LevelExplained, RowExplained
from mjcompose.trace.traced import Traced

_START_TAG = re.compile(r"<(\w+)((?:\s+[\w:]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*/?>", re.DOTALL)
_OWN_FORM = "in the recipe's own unit or form"
_ATTRIBUTE = re.compile(r"([\w:]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')", re.DOTALL)


@dataclass
class Proof:
    """The answers about one model, judged; `seen` counts how many were judged in each way."""

    traced: Traced
    folder: Path
    seen: dict[str, int] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)

    def faults(self) -> Iterator[str]:
        for node in self.traced.model.root.iter("*"):
            for name in map(str, node.keys()):
                yield from self._attribute(node, name)
            yield from self._given(node)

    def _attribute(self, node: Node, name: str) -> Iterator[str]:
        told = self.traced.attribute(node, name)
        level = told.levels[0]
        if told.rows:
            for row in told.rows:
                if (fault := self._row(row)) is not None:
                    yield f"{told.label} {name}: {fault}"
        elif (fault := self._level(level, name)) is not None:
            yield f"{told.label} {name} = {level.text!r}: {fault}"

    def _given(self, node: Node) -> Iterator[str]:
        """What classes give: the same answers, by way of the element that it reaches."""
        for given in self.traced.element(node).given:
            told = self.traced.attribute(node, given.attribute)
            level = next(each for each in told.levels if each.name == given.by)
            if level.span != given.span or level.text != given.value:
                yield f"{told.label} {given.attribute}: two answers, {given} and {level}"

    # -- one answer --------------------------------------------------------------------------------------------

    def _level(self, level: LevelExplained, name: str) -> str | None:
        """Why the answer is not true, if it is not."""
        chain = list(level.changes)
        now = level.text
        assert now is not None
        for change in reversed(chain):
            if not _same(change.after, now):
                return f"{change.reason.words!r} leaves {change.after!r}, and then it is {now!r}"
            if not _is_reason(change):
                return f"{change.before!r} → {change.after!r} is not {change.reason.words!r}"
            now = change.before
        if level.words.endswith(_OWN_FORM):
            assert level.span is not None
            fault = None if _converted(self._text(level.span), str(now)) else "is no form of it"
            return self._count("in the recipe's form", fault and f"{self._text(level.span)!r} {fault}")
        if level.words:
            return self._count("made")
        if level.span is None:
            return self._count("computed") if chain else "no place, no change and no words"
        if now is not None and self._stands(level.span, name, now):
            return self._count("as it was read")
        if self._stands(level.span, name, str(level.text)):
            return self._count("as it was set")
        if any(change.reason.span == level.span for change in chain):
            return self._count("what changed it")
        if now is None and chain:
            return self._count("made by a change")
        return f"{_place(level.span)} has {self._text(level.span)!r} and not {now!r}"

    def _row(self, row: RowExplained) -> str | None:
        if row.origin in ("reference", "zero"):
            return self._count(row.origin) if row.reason.span is None else "a place of what nobody writes"
        if row.origin == "unknown" or row.reason.span is None:
            return f"{row.label} {row.value}: not known"
        if row.origin == "file" and not any("moved" in each.words for each in row.on_the_way):
            if _same(self._text(row.reason.span), row.value):
                return self._count("a number of a key")
            return f"{row.label} {row.value}: {_place(row.reason.span)} has {self._text(row.reason.span)!r}"
        if row.reason.words.startswith("computed") and self._text(row.reason.span) in (
            "hold",
            "positions",
            "forces",
            "keys",
        ):
            return self._count("computed for a key")
        if row.origin == "entry" and not row.on_the_way and not _converted(self._text(row.reason.span), row.value):
            return f"{row.label} {row.value}: {_place(row.reason.span)} has {self._text(row.reason.span)!r}"
        return self._count(f"{row.origin} of a key")

    def _count(self, what: str, fault: str | None = None) -> str | None:
        self.seen[what] = self.seen.get(what, 0) + 1
        return fault

    # -- what stands there -------------------------------------------------------------------------------------

    def _stands(self, span: Span, name: str, value: str) -> bool:
        """Whether the value stands at the place, or in the attribute of the start tag that begins there."""
        text = self._text(span)
        if not text.startswith("<"):
            return _same(text, value) or _is_a_turn(text, value)
        tag = _START_TAG.match(self._file(span.file), self._at(span.file, span.line, span.column))
        if tag is None:
            return False
        return any(each[1] == name and _same(each[2] or each[3] or "", value) for each in _ATTRIBUTE.finditer(tag[2]))

    def _text(self, span: Span) -> str:
        text = self._file(span.file)
        start = self._at(span.file, span.line, span.column)
        end = self._at(span.file, span.end_line or span.line, span.end_column or span.column)
        found = text[start:end]
        if found.startswith("- "):  # of a list with an item on each line that is the first one
            block = re.match(rf"(?:[ ]{{{span.column - 1}}}- .*\n?)+", text[start - span.column + 1 :])
            return " ".join(re.findall(r"^ *- (.*)$", block[0], re.MULTILINE)) if block else found
        return found

    def _at(self, file: str, line: int, column: int) -> int:
        lines = self._file(file).split("\n")
        return sum(len(each) + 1 for each in lines[: line - 1]) + column - 1

    def _file(self, file: str) -> str:
        if file not in self.texts:
            data = (self.folder / file).read_bytes().decode("utf-8-sig")
            self.texts[file] = data.replace("\r\n", "\n")
        return self.texts[file]


def _is_reason(change: ChangeExplained) -> bool:
    """Whether a change is what its words say, where that can be reckoned here."""
    words = change.reason.words
    before = change.before
    after = change.after
    if words.startswith("degrees → radians"):
        return _converted(str(before), str(after))
    if words.startswith("prefix of the part"):
        return str(after) == words.split("`")[1] + str(before)
    if words.endswith(_OWN_FORM):
        return _converted(str(before), str(after))
    return bool(words)


def _is_a_turn(key: str, value: str) -> bool:
    """Whether a key with `${…}`, which `for` repeats, gives that name."""
    pieces = re.split(r"\$\{[^}]*\}", key.strip("\"'"))
    return len(pieces) > 1 and re.fullmatch(".*".join(map(re.escape, pieces)), value) is not None


def _converted(recipe: str, text: str) -> bool:
    """Whether a text of a recipe gives that value: by an expression, as it is, in degrees, or as an orientation."""
    if "${" in recipe or _same(recipe, text):
        return True
    values = [_number(word) for word in re.sub(r"""[][,"']""", " ", recipe).split()]
    wanted = [_number(word) for word in text.split()]
    if not all(values) or not all(wanted):
        return False
    said = [each for each in values if each]
    given = [each[0] for each in wanted if each]
    if len(said) == len(given) and all(map(_same_number, said, given)):
        return True
    if len(given) != 4:
        return False
    for factor in (1.0, math.pi / 180):
        radians = [
            value * (1.0 if unit == "rad" else math.pi / 180 if unit == "deg" else factor) for value, unit in said
        ]
        if len(said) == 4 and _same_pose(quat_from_axisangle([value for value, _ in said[:3]], radians[3]), given):
            return True
        if len(said) == 3:
            for axes in permutations("xyz"):
                for sequence in ("".join(axes), "".join(axes).upper()):
                    if _same_pose(quat_from_euler(radians, sequence), given):
                        return True
    return False


def _number(word: str) -> tuple[float, str] | None:
    found = re.fullmatch(r"([-+.\deE]+|nan|-?inf)(deg|rad)?", word)
    try:
        return None if found is None else (float(found[1]), found[2] or "")
    except ValueError:
        return None


def _same_number(said: tuple[float, str], given: float) -> bool:
    value, unit = said
    forms = {"deg": [math.radians(value), value], "rad": [value, math.degrees(value)]}
    close = forms.get(unit, [value, math.radians(value), math.degrees(value)])
    return any(math.isclose(each, given, rel_tol=1e-12, abs_tol=1e-15) for each in close)


def _same_pose(first: Sequence[float], second: Sequence[float]) -> bool:
    dot = sum(a * b for a, b in zip(first, second, strict=True))
    return math.isclose(abs(dot), 1, abs_tol=1e-12)


def _place(span: Span) -> str:
    return f"{span.file}:{span.line}:{span.column}"


def _same(ours: str | None, theirs: str | None) -> bool:
    """Whether two texts are the same value, one as YAML and the other as MJCF writes it."""
    if ours is None or theirs is None:
        return ours is theirs
    first, second = (re.sub(r"""[][,"']""", " ", unescape(each)).split() for each in (ours, theirs))
    return len(first) == len(second) and all(map(_same_word, first, second))


def _same_word(ours: str, theirs: str) -> bool:
    try:
        return ours == theirs or float(ours) == float(theirs)
    except ValueError:
        return False

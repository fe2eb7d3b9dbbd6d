"""Find the owner and origin of each number of a keyframe, from the linker's notes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, NamedTuple

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.explain.trace import Change, Life, Trace
from composer.link import numbers
from composer.link.key_layouts import VECTORS as VECTORS
from composer.link.key_layouts import holders
from composer.link.layout import Layout, Unknown, lay_out
from composer.link.multiplied import element_of
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.tree.key_number import KeySource, Number
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

Kind = Literal["file", "entry", "edit", "reference", "zero", "mujoco", "unknown"]


@dataclass(frozen=True, slots=True)
class NumberOrigin:
    """Where numbers of a key come from.

    - `file`: a `<key>` of a file writes them;
    - `entry`: an entry of a `keyframe` section of a recipe writes them;
    - `edit`: an edit or a draw of a recipe made them: `change`;
    - `reference`: nobody writes them, and they are the reference configuration; `zero` if they are 0;
    - `mujoco`: the row of the key at `span` is too short, and MuJoCo has filled it up;
    - `unknown`.

    `span` is the place of the numbers themselves if that is known; `written` is the text there. `taken` are the
    `from` entries of recipes that passed them on. `moved` are the parts whose place changed them, each with the
    place of its attachment. `lost` is the origin of numbers in a key that edits have made meaningless.
    """

    kind: Kind
    span: Span | None = None
    written: str | None = None
    taken: tuple[Span, ...] = ()
    moved: tuple[tuple[str, Span | None], ...] = ()
    change: Change | None = None
    lost: NumberOrigin | None = None


class Row(NamedTuple):
    """Numbers of one joint, actuator or mocap body that have one origin."""

    holder: Node
    numbers: str
    origin: NumberOrigin


def rows(model: Unit, key: Node, vector: str, trace: Trace) -> list[Row]:
    """Return at least one row for each owner of numbers; none if only MuJoCo knows their layout."""
    reading = _Reading(model, trace)
    known = reading.settled(key, vector)
    layout = _layout(model, trace.life(key))
    owners = [] if layout is None else holders(layout, vector)
    if not known or sum(width for _, width in owners) != len(known):
        return []
    found, at = [], 0
    for holder, width in owners:
        for run in _runs(known[at : at + width]):
            text = " ".join(each.number.text for each in run)
            found.append(Row(element_of(holder), text, reading.origin(run)))
        at += width
    return found


def key_origins(model: Unit, key: Node, attribute: str, trace: Trace) -> list[NumberOrigin]:
    """Return the origins of all numbers in an attribute of a key, including `time`, in order."""
    reading = _Reading(model, trace)
    return [reading.origin(run) for run in _runs(reading.settled(key, attribute))]


class _Known(NamedTuple):
    """A number of a key, and the edit or draw that made it, if any."""

    number: Number
    change: Change | None = None


class _Reading:
    """Reads the linker's records of keys, and the observed changes to them."""

    def __init__(self, model: Unit, trace: Trace) -> None:
        self.model, self.trace = model, trace
        self.known: dict[tuple[Node, str], list[_Known]] = {}

    def settled(self, key: Node, vector: str) -> list[_Known]:
        """Return the numbers of a key, each with the file attribute, entry or edit that it comes from."""
        return [self._settled(each) for each in self._numbers(key, vector)]

    def _settled(self, known: _Known) -> _Known:
        source = known.number.source
        if known.change is not None or source.key is None or source.key not in self.trace.lives:
            return known
        if source.kind not in ("key", "edited"):
            return known
        if source.kind == "key" and self._noted(source.key, source.vector) is not None:
            return known  # as in the file: the record shows later values
        there = self._numbers(source.key, source.vector)
        if known.number.at >= len(there):
            return _Known(Number(known.number.text, KeySource("edited", source.vector)))
        found = there[known.number.at]
        if found.number.source is not source:
            if found.number.source.key is not source.key:
                found = self._settled(found)
            ours, theirs = source, found.number.source
            both = replace(
                theirs, taken=theirs.taken + ours.taken, moved=theirs.moved + ours.moved, lost=theirs.lost
            )
            found = _Known(Number(known.number.text, both, found.number.at), found.change)
        return found

    def _noted(self, key: Node, vector: str) -> list[Number] | None:
        record = self.model.origins.keys.get(key)
        return None if record is None else record.numbers.get(vector)

    def _numbers(self, key: Node, vector: str) -> list[_Known]:
        """Return the numbers of an element from the linker's notes, updated by later edits and draws."""
        if (key, vector) not in self.known:
            life, noted = self.trace.life(key), self._noted(key, vector)
            if noted is None:
                source = KeySource("key", vector, key)
                written = life.attributes.get(vector, "").split()
                noted = [Number(text, source, at) for at, text in enumerate(written)]
            changes = [
                each for each in life.of(vector) if isinstance(each.cause.done, EditElements | DrawValues)
            ]
            now = str(key.get(vector) or "").split()
            self.known[key, vector] = _after([_Known(each) for each in noted], now, changes, vector=vector)
        return self.known[key, vector]

    def origin(self, run: list[_Known]) -> NumberOrigin:
        first, last = run[0], run[-1]
        source = first.number.source
        lost = None
        if source.lost is not None:
            lost = self._of(source.lost.source, (source.lost.at, source.lost.at))
        if first.change is not None:
            found = NumberOrigin("edit", change=first.change)
        else:
            found = self._of(source, (first.number.at, last.number.at))
        if found.written is not None and not source.moved:
            text = [each.number.text for each in run]
            if numbers.read(found.written) != numbers.read(" ".join(text)):
                found = NumberOrigin("unknown")
        return replace(found, taken=source.taken, moved=source.moved, lost=lost)

    def _of(self, source: KeySource, at: tuple[int, int]) -> NumberOrigin:
        if source.kind == "entry":
            return NumberOrigin("entry", source.span)
        if source.kind in ("reference", "zero"):
            return NumberOrigin("reference" if source.kind == "reference" else "zero")
        life = None if source.key is None else self.trace.lives.get(source.key)
        if life is None or (source.kind == "edited"):
            return NumberOrigin("unknown")
        span = life.span(self.model.origins, source.vector)
        if source.kind == "mujoco":
            return NumberOrigin("mujoco", span)
        return self._in_file(source, at, life) or NumberOrigin("file", span)

    def _in_file(self, source: KeySource, at: tuple[int, int], life: Life) -> NumberOrigin | None:
        """Return the place of the numbers themselves if they are on one line."""
        if not isinstance(life.owner, str) or life.line is None:
            return None
        text = self.model.origins.text(life.owner)
        found = None if text is None else text.items(life.tag, life.line, life.attributes, source.vector, *at)
        if found is None:
            return None
        first, last, words = found
        span = Span(life.owner, first.line, first.column, end_line=last.line, end_column=last.end_column)
        return NumberOrigin("file", span, " ".join(words.split()))


def _after(known: list[_Known], now: list[str], changes: list[Change], vector: str) -> list[_Known]:
    """Apply the changes of recipe steps to the numbers; numbers that no step accounts for become unknown."""
    for change in changes:
        before, after = (change.before or "").split(), (change.after or "").split()
        source = KeySource("edited", vector)
        made = [_Known(Number(text, source, at), change) for at, text in enumerate(after)]
        if len(after) == len(before) and [each.number.text for each in known] == before:
            pairs = zip(known, made, strict=True)
            made = [old if old.number.text == new.number.text else new for old, new in pairs]
        if after or not now:
            known = made
    if [each.number.text for each in known] == now:
        return known
    source = KeySource("edited", vector)
    return [_Known(Number(text, source, at)) for at, text in enumerate(now)]


def _layout(model: Unit, life: Life) -> Layout | None:
    """Return the layout of a key's numbers: the linker's, or else the one that the tree implies."""
    linking = None if life.made_by is None else life.made_by.linking
    if linking is not None and linking.keys.final_layout is not None:
        return linking.keys.final_layout
    try:
        return lay_out(model, {})
    except Unknown:
        return None


def _runs(numbers: list[_Known]) -> Iterator[list[_Known]]:
    """Yield runs of neighbouring numbers with one origin."""
    run: list[_Known] = []
    for each in numbers:
        if run and not _goes_on(run[-1], each):
            yield run
            run = []
        run.append(each)
    if run:
        yield run


def _goes_on(before: _Known, after: _Known) -> bool:
    if before.change is not after.change or before.number.source != after.number.source:
        return False
    return before.number.source.kind != "key" or after.number.at == before.number.at + 1

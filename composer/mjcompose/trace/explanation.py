"""An explanation as data and as text."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby, zip_longest
from typing import Any, Literal

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span, plain_data
from mjcompose.base.report import Paint, as_lines


class Reason(Struct):
    """A reason in words, and the place where it is written."""

    words: str
    span: Span | None = None


class ChangeExplained(Struct):
    """A changed attribute: values as MJCF text, None if it is not written."""

    attribute: str | None
    before: str | None
    after: str | None
    reason: Reason


class Given(Struct):
    """An attribute that a default class gives to an element."""

    attribute: str
    value: str
    by: str
    span: Span | None


class ClassStep(Struct):
    """A default class that reaches an element."""

    name: str
    reason: Reason


class ListedElement(Struct):
    """One of several elements; `value` is the value of an attribute, or the start tag."""

    label: str
    value: str | None
    reason: Reason


class RowExplained(Struct):
    """Numbers of a keyframe that belong to one joint, actuator or mocap body and have one origin.

    `origin` says where they come from: `file`, `entry` (of a `keyframe` section), `edit`, `reference` (configuration),
    `zero`, `mujoco` or `unknown`. `written` is the text at the place in `reason`. `on_the_way` has every step that
    passed the numbers on or changed them, in order.
    """

    label: str
    value: str
    origin: str
    reason: Reason
    written: str | None
    on_the_way: tuple[Reason, ...]


class ElementExplained(Struct):
    """An element of the model, and its history.

    `shared` has the names of the assets of other copies that it replaces. `written` has the places where it was read or
    created: several if elements were merged; `end_line` is the last line of the first start tag. `parts` are the parts
    that it belongs to, the innermost first. `sets` lists the settings of a default class for each kind of element.
    """

    label: str
    text: str
    holder: str | None
    shared: tuple[str, ...]
    written: tuple[Reason, ...]
    end_line: int | None
    parts: tuple[Reason, ...]
    changes: tuple[ChangeExplained, ...]
    in_force: Reason | None
    classes: tuple[ClassStep, ...]
    given: tuple[Given, ...]
    sets: tuple[ListedElement, ...]


class LevelExplained(Struct):
    """One place that an attribute may come from.

    If it `wins`, its text is in effect, or only `part_of_it`: a shorter list leaves the remaining numbers to the next
    level that has them. The text is written at `span`, apart from the `changes`; if there are `words`, they describe
    its origin instead.
    """

    kind: Literal["element", "class", "mujoco"]
    name: str
    text: str | None
    wins: bool
    part_of_it: str | None
    span: Span | None
    changes: tuple[ChangeExplained, ...]
    words: str = ""


class AttributeExplained(Struct):
    """One attribute of an element: the value in effect, and every level from which it may come, the nearest first.

    `about` is the grammar's description of the attribute. `rows` lists the numbers of a keyframe by their owners.
    """

    label: str
    attribute: str
    value: str | None
    levels: tuple[LevelExplained, ...]
    in_force: Reason | None
    about: str | None
    rows: tuple[RowExplained, ...]
    notes: tuple[str, ...]


class Absence(Struct):
    """An element or attribute that the model does not have: its last text, its lines in the files, and the cause.

    `now` is the element of the model that replaces it, if any. `instead` names the value that counts without the
    attribute.
    """

    label: str
    text: str
    written: tuple[Reason, ...]
    reason: Reason
    now: str | None = None
    instead: str = ""


class AbsenceExplained(Struct):
    """The absent elements or attributes that a query matches: several if several elements had that name."""

    query: str
    found: tuple[Absence, ...]


Explained = ElementExplained | AttributeExplained | AbsenceExplained | tuple[ListedElement, ...]


def as_data(explained: Explained) -> dict[str, Any]:
    """Return the explanation as JSON data; `explains` says which of the four kinds it is."""
    if isinstance(explained, tuple):
        return {"explains": "list", "found": [plain_data(each) for each in explained]}
    if isinstance(explained, AbsenceExplained):
        return {"explains": "absence", **plain_data(explained)}
    kind = "element" if isinstance(explained, ElementExplained) else "attribute"
    return {"explains": kind, **plain_data(explained)}


ReadSource = Callable[[str], str | None]
_WIDE = 100
_VALUE = 46
_PATH = 48
_MOST_LINES = 5
_MOST_NAMES = 8


def render(explained: Explained, read_source: ReadSource | None = None, color: bool = False) -> str:
    """Return the explanation without a final line break; `read_source` gives the source lines to show.

    `color` adds ANSI colors as in diagnostics.
    """
    paint = Paint(color)
    if isinstance(explained, tuple):
        lines = _list(explained)
    elif isinstance(explained, ElementExplained):
        lines = _element(explained, read_source, paint)
    elif isinstance(explained, AbsenceExplained):
        lines = _absence(explained, read_source, paint)
    else:
        lines = _attribute(explained, read_source, paint)
    return as_lines(line.rstrip() for line in lines)


def _element(it: ElementExplained, read_source: ReadSource | None, paint: Paint) -> Iterator[str]:
    yield paint("bold", it.label)
    yield from textwrap.wrap(
        it.text, _WIDE, initial_indent="  ", subsequent_indent="      ", break_long_words=False, break_on_hyphens=False
    )
    if it.holder:
        yield f"  in {it.holder}"
    if it.shared:
        yield from textwrap.wrap(
            f"shared with {with_count(it.shared)}", _WIDE, initial_indent="  ", subsequent_indent="      "
        )
    yield from ("", paint("bold", "where it comes from"))
    for number, each in enumerate(it.written):
        comma = "" if each.words == "read from" else ","
        place = "" if each.span is None else f"{comma} {each.span.file}:{each.span.line}{each.span.origin}"
        yield f"  {each.words}{place}"
        yield from _source(each.span, it.end_line if number == 0 else None, read_source, paint=paint)
    yield from _table([("part", each.words, _at(each.span)) for each in it.parts])
    if it.sets:
        yield from ("", paint("bold", "settings"))
        yield from _table([(each.label, _cut(each.value or ""), _at(each.reason.span)) for each in it.sets])
    if it.changes:
        yield from ("", paint("bold", "changes"))
        yield from _changes(it.changes)
    if it.classes:
        yield from ("", paint("bold", "default classes, the nearest first"))
        if it.in_force is not None:
            yield f"  in force {it.in_force.words}{_at(it.in_force.span, ', ')}"
        yield from _classes(it)


def _absence(it: AbsenceExplained, read_source: ReadSource | None, paint: Paint) -> Iterator[str]:
    for number, absence in enumerate(it.found):
        yield from [""] if number else []
        where = f": it is `{absence.now}` now" if absence.now else ""
        yield paint("bold", f"{absence.label} is not in the model{where}")
        yield from textwrap.wrap(absence.text, _WIDE, initial_indent="  ", subsequent_indent="      ")
        for reason in absence.written:
            comma = "" if reason.words == "read from" or not reason.span else ","
            yield f"  {reason.words}{comma}{_at(reason.span, ' ')}"
        yield from ("", paint("bold", "why"))
        yield f"  {_placed(absence.reason)}"
        yield from _source(absence.reason.span, None, read_source, paint=paint)
        if absence.instead:
            yield f"  instead, {absence.instead}"


def with_count(names: Sequence[str]) -> str:
    """Return the first names, and how many there are if that is more.

    >>> with_count(["b/link", "c/link"]), with_count(["a"] * 12)
    ('b/link, c/link', 'a, a, a, a, a, a, a, a, … (12 in all)')
    """
    shown = ", ".join(names[:_MOST_NAMES])
    return shown if len(names) <= _MOST_NAMES else f"{shown}, … ({len(names)} in all)"


def _classes(it: ElementExplained) -> Iterator[str]:
    width = max((len(each.attribute) for each in it.given), default=0)
    values = max((len(_cut(each.value)) for each in it.given), default=0)
    names = max(len(step.name) for step in it.classes)
    for step in it.classes:
        made = "" if step.reason.words == "read from" else f"{step.reason.words}{', ' if step.reason.span else ''}"
        yield f"  {step.name:<{names}}  {made}{_at(step.reason.span)}"
        for each in it.given:
            if each.by == step.name:
                yield f"      {each.attribute:<{width}}  {_cut(each.value):<{values}}  {_at(each.span)}"


def _attribute(it: AttributeExplained, read_source: ReadSource | None, paint: Paint) -> Iterator[str]:
    yield paint("bold", f"{it.attribute} of {it.label}")
    yield from textwrap.wrap(_value_of(it), _WIDE, initial_indent="  ", subsequent_indent="  ") or ['  ""']
    if it.about:
        yield f"  # {it.about}"
    yield from ("", paint("bold", "where it comes from"))
    yield from _table([_level(level) for level in it.levels])
    winner = next((level.span for level in it.levels if level.wins and level.span is not None), None)
    if winner is not None:
        yield f"  {winner.file}:{winner.line}{winner.origin}"
        yield from _source(winner, None, read_source, paint=paint)
    yield from _numbers(it, paint)
    first = next((level for level in it.levels if level.kind == "class"), None)
    if it.in_force is not None and first is not None:
        yield from ("", f"class {first.name} is in force {it.in_force.words}{_at(it.in_force.span, ', ')}")
    yield from _changes_of_levels(it.levels, paint)
    for note in it.notes:
        yield from ("", f"{paint('note', 'note')}: {note}")


def _value_of(it: AttributeExplained) -> str:
    if it.value is not None:
        return it.value
    return "computed by MuJoCo" if any(level.wins for level in it.levels) else "not set"


def _numbers(it: AttributeExplained, paint: Paint) -> Iterator[str]:
    """Yield a table with the reason of each number, if they have different ones."""
    if it.rows:
        yield from ("", paint("bold", "number by number"))
        passed = ("".join(f", {reason.words}{_at(reason.span, ' ')}" for reason in row.on_the_way) for row in it.rows)
        pairs = zip(it.rows, passed, strict=True)
        yield from _table([(row.label, row.value, f"{_placed(row.reason)}{more}") for row, more in pairs])


def _changes_of_levels(levels: Sequence[LevelExplained], paint: Paint) -> Iterator[str]:
    for level in levels:
        if not level.changes:
            continue
        place = f"in the class {level.name}" if level.kind == "class" else "on the element"
        if levels[0].name[0] != "<":  # the attribute of another element that determines this one
            place = f"in {level.name}"
        yield from ("", paint("bold", f"changes {place}"))
        yield from _changes(level.changes, name=False)


def _level(each: LevelExplained) -> tuple[str, str, str, str]:
    name = f"class {each.name}" if each.kind == "class" else each.name
    text = "none" if each.kind == "mujoco" and each.text is None else _value(each.text)
    verdict = "overridden" if each.text is not None and each.kind != "mujoco" else ""
    if each.wins:
        verdict = "in effect" if each.part_of_it is None else f"in effect: {each.part_of_it}"
    return name, text, verdict, _placed(Reason(each.words, each.span))


def _placed(reason: Reason) -> str:
    return f"{reason.words}{_at(reason.span, ', ' if reason.words else '')}"


def _changes(changes: Iterable[ChangeExplained], name: bool = True) -> Iterator[str]:
    for reason, alike in groupby(changes, key=lambda each: f"{each.reason.words}{_at(each.reason.span, ', ')}"):
        yield f"  {reason}"
        rows = [each for each in alike if each.attribute is not None]
        width = max((len(str(each.attribute)) for each in rows), default=0) if name else 0
        for each in rows:
            called = f"{each.attribute:<{width}}  " if name else ""
            change = f"{_value(each.before)} → {_value(each.after)}"
            if each.before == each.after:
                change = f"{_value(each.after)}, as before"
            yield f"      {called}{change}"


def _value(text: str | None) -> str:
    return "-" if text is None else _cut(text) or '""'


def _list(found: Iterable[ListedElement]) -> Iterator[str]:
    rows = []
    for each in found:
        words = "" if each.reason.words == "read from" else each.reason.words
        value = (_cut(each.value),) if each.value is not None else ()
        rows.append((each.label, *value, words, _at(each.reason.span)))
    yield from _table(rows, indent="")


def _table(rows: list[tuple[str, ...]], indent: str = "  ") -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip_longest(*(row[:-1] for row in rows), fillvalue="")]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row[:-1], widths, strict=False)]
        yield indent + "  ".join([*(cell for cell in cells if cell), row[-1]])


def _source(span: Span | None, last: int | None, read_source: ReadSource | None, paint: Paint) -> Iterator[str]:
    text = read_source(span.file) if span is not None and read_source is not None else None
    if text is None or span is None:
        return
    lines = text.split("\n")
    end = min(max(last or span.line, span.line), len(lines), span.line + _MOST_LINES - 1)
    margin = len(str(end))
    for number in range(span.line, end + 1):
        line = lines[number - 1].rstrip()
        gutter = paint("gutter", f"{number:>{margin}} |")
        yield f"    {gutter} {line if len(line) <= _WIDE else line[: _WIDE - 1] + '…'}"


def _at(span: Span | None, before: str = "") -> str:
    """Return file and line; only the end of a long path, because the whole path is shown once."""
    if span is None:
        return ""
    file = span.file
    if len(file) > _PATH and file.count("/") > 2:
        file = "…/" + "/".join(file.rsplit("/", 2)[1:])
    return f"{before}{file}:{span.line}{span.where}"


def _cut(text: str) -> str:
    text = " ".join(text.split())
    if len(text) <= _VALUE:
        return text
    half = (_VALUE - 3) // 2
    return f"{text[:half].rstrip()} … {text[-half:].lstrip()}"

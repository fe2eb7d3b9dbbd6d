"""A diff in words: terminal, JSON, Markdown."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, TypeAlias

from mjcompose.base.diagnostic import plain_data
from mjcompose.base.report import as_lines, code_span, markdown_text, printable
from mjcompose.base.words import counted, plural
from mjcompose.contrast.changes import (
    SETTINGS,
    AddressMove,
    Breaking,
    CausedChanges,
    CauseLines,
    Diff,
    FieldChange,
    SizeChange,
    Value,
    View,
)
from mjcompose.mujoco.arrays import about, is_place, unit
from mjcompose.sides.side import End

_NAMED = 5
_SINGULARS = {"key": "keyframe"}
Between: TypeAlias = Callable[[Value, Value, str], str]
_ORDER = ("renamed", "removed", "added", "changed")


def sentences(changes: Iterable[FieldChange], between: Between | None = None) -> Iterator[str]:
    """Yield one line for each change, or for all equal changes of several elements.

    `between` puts a value and its new value into words, with their unit; the default is an arrow.
    """
    changes = sorted(changes, key=lambda each: (_ORDER.index(each.what), about(each.field).rank))
    found: dict[tuple[object, ...], list[FieldChange]] = defaultdict(list)
    for change in changes:
        key: tuple[object, ...] = (change.what, change.kind)
        if change.what == "renamed":
            key = (change.what, _prefixes(change) or (change.kind, change.name))
        elif change.what == "changed":
            key = (
                change.kind,
                change.field,
                change.before,
                change.after,
                change.note,
                change.form,
                change.name if change.kind == "key" else "",
            )
        found[key].append(change)
    yield from (_sentence(alike, between) for alike in found.values())


def count(size: SizeChange) -> str:
    """`nq 9 → 16`, `bodies 12 → 13`."""
    word = size.name if size.name.startswith(("n", "total")) and size.name != "numeric" else plural_of(size.name)
    return f"{word} {arrow(size.before, size.after, size.unit, share=bool(size.unit))}"


def moved(moves: Iterable[AddressMove]) -> Iterator[str]:
    """Yield changed addresses: one line for a run of elements that all move by the same number of places."""
    for (vector, kind, by), run in groupby(moves, key=lambda each: (each.vector, each.kind, each.after - each.before)):
        several = list(run)
        first = several[0]
        last = several[-1]
        of = f"of {subject(kind, [each.name for each in several])} in {vector}:"
        if len(several) == 1:
            yield f"address {of} {first.before} → {first.after}"
        else:
            shift = f"{by:+d}".replace("-", "−")
            yield f"addresses {of} {first.before}…{last.before} → {first.after}…{last.after} ({shift})"


def subject(kind: str, names: Sequence[str]) -> str:
    """``geom `pad```, or ``3 geoms `a`, `b`, `c```.

    >>> subject("body", ["a", "b"])
    '2 bodies `a`, `b`'
    """
    shown = ", ".join(_quoted(names[:_NAMED]))
    if len(names) > _NAMED:
        shown += f", … and {len(names) - _NAMED} more"
    return f"{_SINGULARS.get(kind, kind)} {shown}" if len(names) == 1 else f"{len(names)} {plural_of(kind)} {shown}"


def quoted(name: str) -> str:
    """Return a name in backquotes; return the place of an unnamed element unchanged."""
    return name if name.startswith("#") else f"`{name}`"


def _quoted(names: Sequence[str]) -> Iterator[str]:
    """Yield names in backquotes; several unnamed elements on one body share the name of the body."""
    split = [name.partition(" ") if name.startswith("#") else (name, "", "") for name in names]
    for (place, _), run in groupby(split, key=lambda parts: (parts[2], parts[2] or parts[0])):
        several = [first for first, _, _ in run]
        yield f"{', '.join(several)} {place}" if place else quoted(several[0])


def plural_of(kind: str) -> str:
    """Return the plural of a kind of element; a `key` is a keyframe."""
    return plural(_SINGULARS.get(kind, kind))


def arrow(before: Value, after: Value, unit: str = "", *, share: bool = True) -> str:
    """`0.25 kg → 0.3 kg (+20 %)`."""
    unit = f" {unit}" if unit and not isinstance(before, str) and not isinstance(after, str) else ""
    ours = shown(before)
    theirs = shown(after)
    if ours == theirs:
        ours = shown(before, None)
        theirs = shown(after, None)
    change = (relative(before, after) if share else None) or 0.0
    grown = f" (×{change + 1:.3g})" if change >= 9 else f" ({'+' if change > 0 else '−'}{abs(100 * change):.3g} %)"
    grown = grown if abs(change) >= 5e-4 else ""
    return f"{ours}{unit if before is not None else ''} → {theirs}{unit if after is not None else ''}{grown}"


def view(view: View) -> str:
    share = view.differs * 100
    return "the same" if share == 0 else f"{max(share, 0.1):.1f} % of the pixels differ"


def relative(before: Value, after: Value) -> float | None:
    """Return the relative change, or None if it has no meaning or the numbers changed by different factors."""
    ours = _numbers(before)
    theirs = _numbers(after)
    if all(isinstance(each, int) for each in (*ours, *theirs)):
        return None
    if not ours or len(ours) != len(theirs) or not any(ours):
        return None
    ratios = [y / x for x, y in zip(ours, theirs, strict=True) if x]
    if any(y for x, y in zip(ours, theirs, strict=True) if not x) or max(ratios) - min(ratios) > 1e-3:
        return None
    return ratios[0] - 1 if ratios[0] > 0 else None


def shown(value: Value, digits: int | None = 6) -> str:
    """Return a value as text, with lists in brackets; without `digits`, numbers are exact."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "none"
    if isinstance(value, tuple):
        noise = 0.0 if digits is None else 1e-12 * max(map(abs, _numbers(value)), default=0.0)
        rounded = (0.0 if isinstance(each, float) and abs(each) < noise else each for each in value)
        return f"[{', '.join(shown(each, digits) for each in rounded)}]"
    if isinstance(value, float):
        return repr(value) if digits is None else f"{value:.{digits}g}"
    return str(value)


def _sentence(alike: Sequence[FieldChange], between: Between | None) -> str:
    change = alike[0]
    names = [each.name for each in alike]
    if change.what in ("added", "removed"):
        return f"{'+' if change.what == 'added' else '−'} {subject(change.kind, names)}"
    if change.what == "renamed":
        prefixes = _prefixes(change)
        if prefixes is not None and len(alike) > 1:
            return f"part `{prefixes[0]}` is called `{prefixes[1]}`: {len(alike)} names"
        return f"{change.kind} `{change.before}` is called `{change.after}`"
    known = about(change.field)
    of_unit = unit(change.field, change.form)
    if between is not None and not change.note:
        values = between(change.before, change.after, of_unit)
    else:
        values = change.note or arrow(change.before, change.after, of_unit, share=not is_place(change.field))
    if change.kind.partition("/")[0] in SETTINGS:
        return f"{change.kind} {change.field}: {values}"
    if change.kind == "key":
        entries = [each.entry for each in alike if each.entry]
        of = f" of {', '.join(quoted(each) for each in entries[:_NAMED])}" if entries else ""
        return f"keyframe {quoted(change.name)}: {known.words}{of}: {values}"
    words = known.words + (change.field[at:] if (at := change.field.find("[")) >= 0 else "")
    return f"{words} of {subject(change.kind, names)}: {values}"


def _prefixes(change: FieldChange) -> tuple[str, str] | None:
    """Return the outermost prefixes, if nothing else differs."""
    ours, separator, rest = str(change.before).partition("/")
    theirs, _, other = str(change.after).partition("/")
    return (f"{ours}/", f"{theirs}/") if separator and rest == other and ours != theirs else None


def _numbers(value: Value) -> list[float]:
    if isinstance(value, tuple):
        return [number for each in value for number in _numbers(each)]
    return [] if isinstance(value, (bool, str)) or value is None else [value]


def as_data(diff: Diff) -> dict[str, Any]:
    """Return everything, element by element; spans have file, line and column. Values are in MuJoCo's units."""
    contrast = diff.contrast
    return {
        "same": diff.same,
        "identical": contrast.identical,
        "a": _end(diff.a),
        "b": _end(diff.b),
        "files": list(diff.files),
        "counts": list(map(plain_data, contrast.counts)),
        "groups": _groups(diff.groups),
        "addresses": list(map(plain_data, contrast.moves)),
        "arrays": list(contrast.arrays),
        "follows": diff.follows,
        "views": list(map(plain_data, diff.views)),
    }


def _groups(groups: Iterable[CausedChanges]) -> list[dict[str, Any]]:
    pairs = ((each.cause and plain_data(each.cause), list(map(_change, each.changes))) for each in groups)
    return [{"cause": cause, "changes": changes} for cause, changes in pairs]


def _end(end: End) -> dict[str, Any]:
    cells = {"cell": end.cell} if end.cell is not None else {"cells": end.cells} if end.cells else {}
    outside = {"outside": list(end.outside)} if end.outside else {}
    return {"name": end.label, "kind": end.kind, "sha256": end.sha256, **outside, **cells}


def _change(change: FieldChange) -> dict[str, Any]:
    data: dict[str, Any] = {"what": change.what, "kind": change.kind, "name": change.name}
    if change.what == "renamed":
        data["before"] = change.before
    if change.what == "changed":
        data |= {
            "quantity": about(change.field).words,
            "field": change.field,
            "before": change.before,
            "after": change.after,
            "unit": unit(change.field, change.form) or None,
            "relative": relative(change.before, change.after),
        }
        data |= {name: text for name, text in (("note", change.note), ("entry", change.entry)) if text}
    return data


def render(diff: Diff) -> str:
    return as_lines(_lines(diff, markdown=False))


def verdict(diff: Diff) -> str:
    if diff.same and diff.contrast.identical:
        files = "and so are all files" if diff.same_bytes else "though their files are not"
        return f"the same: the compiled models are equal bit for bit, {files}"
    if diff.same:
        return "the same in the requested scope; the compiled models are not equal bit for bit"
    changes = sum(len(group.changes) for group in diff.groups)
    if not changes:
        contrast = diff.contrast
        kinds = {"counts": contrast.counts, "addresses": contrast.moves, "arrays of mjModel": contrast.arrays}
        return f"different: only {' and '.join(kind for kind, found in kinds.items() if found)}"
    causes = sum(group.cause is not None for group in diff.groups)
    return f"different: {counted(changes, 'change')}" + (f" at {counted(causes, 'place')}" if causes else "")


def place(cause: CauseLines) -> str:
    """Return `recipe.yaml:12`, with A's place if it differs by more than the revision."""
    spans = [None if span is None else f"{span.file}:{span.line}" for span in (cause.before, cause.after)]
    if spans[0] is None or spans[0] == spans[1] or (spans[1] and spans[0].endswith(f":{spans[1]}")):
        return str(spans[1])
    if spans[1] is None:
        return f"{spans[0]} (A)"
    return f"{spans[0]} → {spans[1]}"


def _remarks(diff: Diff) -> Iterator[str]:
    yield from (end.said_outside for end in (diff.a, diff.b) if end.said_outside)
    counts = [end.cells for end in (diff.a, diff.b) if end.cells]
    if counts:
        cells = counted(counts[-1], "cell")
        yield f"compared at its defaults; `--pick CELL` compares one of the {cells} of the matrix"


def _lines(diff: Diff, *, markdown: bool) -> Iterator[str]:
    contrast = diff.contrast
    yield from _head(diff, verdict(diff), markdown=markdown)
    if contrast.counts:
        yield from ("", *([] if markdown else ["the whole model"]))
        yield from (f"{'- ' if markdown else '  '}{count(each)}" for each in contrast.counts)
    yield from _changes(diff.groups, contrast.moves, contrast.arrays, markdown=markdown)
    if diff.views and markdown:
        yield from ("", "#### Pictures", "", "| view | before | after |", "|---|---|---|")
        yield from (
            f"| {code_span(each.name)}<br>{view(each)} | ![before](<{each.before}>) | ![after](<{each.after}>) |"
            for each in diff.views
        )
    elif diff.views:
        yield from ("", "pictures")
        yield from (f"  {each.name}: {view(each)}: {each.before}, {each.after}" for each in diff.views)
    if diff.follows:
        verb = "differs" if diff.follows == 1 else "differ"
        more = f"{counted(diff.follows, 'number')} that MuJoCo computes from these {verb} too: --computed lists them"
        yield from ("", f"<sub>{more}</sub>" if markdown else more)
    if diff.same_bytes != diff.same and diff.files and not markdown:
        yield from ("", f"files that differ: {', '.join(diff.files)}")


def _head(diff: Diff, said: str, *, markdown: bool) -> Iterator[str]:
    if not markdown:
        yield from (f"A {diff.a.named}", f"B {diff.b.named}", said, *_remarks(diff))
        return
    yield from (f"### {code_span(diff.a.named)} → {code_span(diff.b.named)}", "", f"**{said.capitalize()}.**")
    for remark in _remarks(diff):
        yield from ("", f"<sub>{remark[0].upper()}{remark[1:]}</sub>")


def _changes(
    groups: Iterable[CausedChanges], moves: Sequence[AddressMove], arrays: Sequence[str], *, markdown: bool
) -> Iterator[str]:
    for group in groups:
        yield from ("", *(_group_markdown(group) if markdown else _group(group)))
    if moves:
        lines = [*moved(moves)]
        listed = ["#### Addresses", "", *_list(lines)] if markdown else ["addresses", *(f"  {each}" for each in lines)]
        yield from ("", *listed)
    if arrays:
        of, names = ("Arrays of `mjModel`", map(code_span, arrays)) if markdown else ("arrays of mjModel", arrays)
        yield from ("", f"{of} that differ: {', '.join(names)}")


def _group(group: CausedChanges) -> Iterator[str]:
    lines = _differing(group.cause)
    if group.cause is None:
        yield "without a line of its own"
    else:
        yield place(group.cause) if lines else f"{place(group.cause)}: {group.cause.words}"
    yield from (f"  {line}" for line in lines)
    indent = "    " if group.cause is not None else "  "
    yield from (f"{indent}{each}" for each in sentences(group.changes))


def _differing(cause: CauseLines | None) -> list[str]:
    pairs = () if cause is None else (("-", cause.lines_before), ("+", cause.lines_after))
    return [f"{sign} {line}" for sign, lines in pairs for line in lines]


_LONG = 12
_LONGEST = 60_000
"""Characters. GitHub allows 65536 in a comment."""


def render_markdown(diff: Diff) -> str:
    """Return headings by line, the lines as a diff, the changes as a list; cut to the length of a comment."""
    return _cut(_lines(diff, markdown=True))


def _cut(lines: Iterable[str]) -> str:
    text = printable("\n".join(lines)).strip() + "\n"
    if len(text) <= _LONGEST:
        return text
    kept = text[:_LONGEST].rpartition("\n#### ")[0]
    kept += "\n\n</details>" * (kept.count("<details>") - kept.count("</details>"))
    return f"{kept}\n\n… and more: `mjcompose diff` prints all of it.\n"


def _group_markdown(group: CausedChanges) -> Iterator[str]:
    lines = _differing(group.cause)
    if group.cause is None:
        yield "#### Without a line of its own"
    else:
        yield f"#### {code_span(place(group.cause))}" + ("" if lines else f": {markdown_text(group.cause.words)}")
    if lines:
        fence = "`" * max(3, 1 + max(len(each) for each in re.findall("`*", " ".join(lines))))
        yield from (f"{fence}diff", *lines, fence)
    yield from ("", *_list(list(sentences(group.changes))))


def _list(lines: list[str]) -> list[str]:
    listed = [f"- {markdown_text(line)}" for line in lines]
    if len(lines) <= _LONG:
        return listed
    return [f"<details><summary>{len(lines)} changes</summary>", "", *listed, "", "</details>"]


_EFFECTS = {
    "major": "programs that use the interface break",
    "minor": "programs still run, and the model may move differently",
    "patch": "the model only looks different",
}


def render_breaking(breaking: Breaking, *, markdown: bool) -> str:
    """Return the changes by level: for a terminal, or as a comment on GitHub."""
    diff = breaking.diff
    names = [level.name for level in breaking.levels]
    says = f"{names[0]}: {_EFFECTS[names[0]]}" if names else "the same interface, motion and looks"
    lines = [*_head(diff, says, markdown=markdown)]
    for level in breaking.levels:
        lines += ["", f"### {level.name.capitalize()}" if markdown else level.name.upper()]
        lines += _changes(level.groups, level.moves, level.arrays, markdown=markdown)
    return _cut(lines).removesuffix("\n") if markdown else "\n".join(lines)


def breaking_as_data(breaking: Breaking) -> dict[str, Any]:
    """Return the data of the diff, with its `level` and the changes by level."""
    found = breaking.levels
    levels = {
        each.name: {"groups": _groups(each.groups), "addresses": list(map(plain_data, each.moves))} for each in found
    }
    return {**as_data(breaking.diff), "level": found[0].name if found else None, "levels": levels}

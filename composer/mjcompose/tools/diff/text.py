"""A diff in words: terminal, JSON, Markdown."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from itertools import groupby
from typing import Any, TypeAlias

from mjcompose.base.report import counted, printable
from mjcompose.mujoco.arrays import about, is_place, unit
from mjcompose.tools.diff.changes import SETTINGS, Cause, Change, Count, Diff, End, Group, Move, Value, View

_NAMED = 5
_NOISE = 1e-12
_PLURALS = {
    "body": "bodies", "mesh": "meshes", "equality": "equalities", "flex": "flexes", "key": "keyframes",
    "default class": "default classes",
}  # fmt: skip
_SINGULARS = {"key": "keyframe"}
Between: TypeAlias = Callable[[Value, Value, str], str]
_ORDER = ("renamed", "removed", "added", "changed")


def sentences(changes: Iterable[Change], between: Between | None = None) -> Iterator[str]:
    """Yield one line for each change, or for all equal changes of several elements.

    `between` puts a value and its new value into words, with their unit; the default is an arrow.
    """
    changes = sorted(changes, key=lambda each: (_ORDER.index(each.what), about(each.field).rank))
    found: dict[tuple[object, ...], list[Change]] = {}
    for change in changes:
        if change.what == "renamed":
            key: tuple[object, ...] = (change.what, _prefixes(change) or (change.kind, change.name))
        elif change.what == "changed":
            key = (change.kind, change.field, change.before, change.after, change.note, change.form,
                   change.name if change.kind == "key" else "")  # fmt: skip
        else:
            key = (change.what, change.kind)
        found.setdefault(key, []).append(change)
    for alike in found.values():
        yield _sentence(alike, between)


def count(size: Count) -> str:
    """`nq 9 → 16`, `bodies 12 → 13`."""
    word = size.name if size.name.startswith(("n", "total")) and size.name != "numeric" else plural(size.name)
    if not size.unit:
        return f"{word} {shown(size.before)} → {shown(size.after)}"
    return f"{word} {arrow(size.before, size.after, size.unit)}"


def moved(moves: Iterable[Move]) -> Iterator[str]:
    """Yield changed addresses: one line for a run of elements that all move by the same number of places."""
    for (vector, kind, by), run in groupby(moves, key=lambda each: (each.vector, each.kind, each.after - each.before)):
        several = list(run)
        first, last = several[0], several[-1]
        where = f"in {vector}"
        if len(several) == 1:
            yield f"address of {subject(kind, [first.name])} {where}: {first.before} → {first.after}"
        else:
            yield (
                f"addresses of {subject(kind, [each.name for each in several])} {where}: "
                f"{first.before}…{last.before} → {first.after}…{last.after} ({_signed(by)})"
            )


def subject(kind: str, names: Sequence[str]) -> str:
    """``geom `pad```, or ``3 geoms `a`, `b`, `c```.

    >>> subject("body", ["a", "b"])
    '2 bodies `a`, `b`'
    """
    shown = ", ".join(_quoted(names[:_NAMED]))
    if len(names) > _NAMED:
        shown += f", … and {len(names) - _NAMED} more"
    return f"{_SINGULARS.get(kind, kind)} {shown}" if len(names) == 1 else f"{len(names)} {plural(kind)} {shown}"


def quoted(name: str) -> str:
    """Return a name in backquotes; the place of an unnamed element as it is."""
    return name if name.startswith("#") else f"`{name}`"


def _quoted(names: Sequence[str]) -> Iterator[str]:
    """Yield names in backquotes; several unnamed things on one body share the name of the body."""
    for (place, _), run in groupby(map(_placed, names), key=lambda each: (each[1], each[1] or each[0])):
        several = [first for first, _ in run]
        yield f"{', '.join(several)} {place}" if place else quoted(several[0])


def _placed(name: str) -> tuple[str, str]:
    """Split `#2 of body ...` in two."""
    first, space, place = name.partition(" ")
    return (first, place) if name.startswith("#") and space else (name, "")


def plural(kind: str) -> str:
    return _PLURALS.get(kind, f"{kind}s")


def arrow(before: Value, after: Value, unit: str = "", *, share: bool = True) -> str:
    """`0.25 kg → 0.3 kg (+20 %)`."""
    unit = f" {unit}" if unit and not isinstance(before, str) and not isinstance(after, str) else ""
    ours, theirs = shown(before), shown(after)
    if ours == theirs:
        ours, theirs = shown(before, None), shown(after, None)
    change = relative(before, after) if share else None
    grown = "" if change is None or abs(change) < 5e-4 else f" ({_percent(change)})"
    return f"{ours}{unit if before is not None else ''} → {theirs}{unit if after is not None else ''}{grown}"


def view(view: View) -> str:
    """Return how much two pictures differ, in words."""
    share = view.differs * 100
    return "the same" if share == 0 else f"{max(share, 0.1):.1f} % of the pixels differ"


def relative(before: Value, after: Value) -> float | None:
    """Return the relative change; for several numbers only if all grew alike. Return None if that has no meaning."""
    ours, theirs = _numbers(before), _numbers(after)
    if all(isinstance(each, int) for each in (*ours, *theirs)):
        return None
    if not ours or len(ours) != len(theirs) or not any(ours):
        return None
    ratios = [y / x for x, y in zip(ours, theirs, strict=True) if x]
    if any(y for x, y in zip(ours, theirs, strict=True) if not x) or max(ratios) - min(ratios) > 1e-3:
        return None
    return ratios[0] - 1 if ratios[0] > 0 else None


def _percent(change: float) -> str:
    if change >= 9:
        return f"×{change + 1:.3g}"
    return f"{'+' if change > 0 else '−'}{abs(100 * change):.3g} %"


def _signed(number: int) -> str:
    return f"{number:+d}".replace("-", "−")


def shown(value: Value, digits: int | None = 6) -> str:
    """Return a value as text, lists in brackets; without `digits` every number to the bit."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "none"
    if isinstance(value, tuple):
        negligible = 0.0 if digits is None else _NOISE * max(map(abs, _numbers(value)), default=0.0)
        return f"[{', '.join(shown(_without_noise(each, negligible), digits) for each in value)}]"
    if isinstance(value, float):
        return repr(value) if digits is None else f"{value:.{digits}g}"
    return str(value)


def _without_noise(value: Value, negligible: float) -> Value:
    """Return zero for a number that is rounding error beside a larger one."""
    return 0.0 if isinstance(value, float) and abs(value) < negligible else value


def _sentence(alike: Sequence[Change], between: Between | None) -> str:
    change, names = alike[0], [each.name for each in alike]
    if change.what in ("added", "removed"):
        return f"{'+' if change.what == 'added' else '−'} {subject(change.kind, names)}"
    if change.what == "renamed":
        prefixes = _prefixes(change)
        if prefixes is not None and len(alike) > 1:
            return f"part `{prefixes[0]}` is called `{prefixes[1]}`: {len(alike)} names"
        return f"{change.kind} `{change.before}` is called `{change.after}`"
    known = about(change.field)
    said = unit(change.field, change.form)
    if between is not None and not change.note:
        values = between(change.before, change.after, said)
    else:
        values = change.note or arrow(change.before, change.after, said, share=not is_place(change.field))
    if change.kind.partition("/")[0] in SETTINGS:
        return f"{change.kind} {change.field}: {values}"
    if change.kind == "key":
        entries = [each.entry for each in alike if each.entry]
        of = f" of {', '.join(quoted(each) for each in entries[:_NAMED])}" if entries else ""
        return f"keyframe {quoted(change.name)}: {known.words}{of}: {values}"
    words = known.words + (change.field[at:] if (at := change.field.find("[")) >= 0 else "")
    return f"{words} of {subject(change.kind, names)}: {values}"


def _prefixes(change: Change) -> tuple[str, str] | None:
    """Return the outermost prefixes, if nothing else differs."""
    ours, separator, rest = str(change.before).partition("/")
    theirs, _, other = str(change.after).partition("/")
    return (f"{ours}/", f"{theirs}/") if separator and rest == other and ours != theirs else None


def _numbers(value: Value) -> list[float]:
    if isinstance(value, (bool, str)) or value is None:
        return []
    if isinstance(value, tuple):
        return [number for each in value for number in _numbers(each)]
    return [value]


def as_data(diff: Diff) -> dict[str, Any]:
    """Return everything, element by element; spans have file, line and column. Values are in MuJoCo's units."""
    contrast = diff.contrast
    return {
        "same": diff.same,
        "identical": contrast.identical,
        "a": _end(diff.a),
        "b": _end(diff.b),
        "files": list(diff.files),
        "counts": [asdict(each) for each in contrast.counts],
        "groups": [
            {
                "cause": None if group.cause is None else asdict(group.cause),
                "changes": [_change(each) for each in group.changes],
            }
            for group in diff.groups
        ],
        "addresses": [asdict(each) for each in contrast.moves],
        "arrays": list(contrast.arrays),
        "follows": diff.follows,
        "views": [asdict(each) for each in diff.views],
    }


def _end(end: End) -> dict[str, Any]:
    data: dict[str, Any] = {"name": end.label, "kind": end.kind, "sha256": end.sha256}
    if end.outside:
        data["outside"] = list(end.outside)
    if end.cell is not None:
        data["cell"] = end.cell
    elif end.cells:
        data["cells"] = end.cells
    return data


def _change(change: Change) -> dict[str, Any]:
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
        if change.note:
            data["note"] = change.note
        if change.entry:
            data["entry"] = change.entry
    return data


def render(diff: Diff) -> str:
    """Return the full report, line by line."""
    return "\n".join(_lines(diff))


def verdict(diff: Diff) -> str:
    """Return the result in one sentence."""
    if diff.same and diff.contrast.identical:
        files = "and so are all files" if diff.same_bytes else "though their files are not"
        return f"the same: the compiled models are equal bit for bit, {files}"
    if diff.same:
        return "the same in what was asked for; the compiled models are not equal bit for bit"
    changes = sum(len(group.changes) for group in diff.groups)
    if not changes:
        contrast = diff.contrast
        kinds = {"counts": contrast.counts, "addresses": contrast.moves, "arrays of mjModel": contrast.arrays}
        return f"different: only {' and '.join(kind for kind, found in kinds.items() if found)}"
    causes = sum(group.cause is not None for group in diff.groups)
    return f"different: {counted(changes, 'change')}" + (f" at {counted(causes, 'place')}" if causes else "")


def place(cause: Cause) -> str:
    """Return `recipe.yaml:12`, with A's place if it is another one, and not only in another revision."""
    spans = [None if span is None else f"{span.file}:{span.line}" for span in (cause.before, cause.after)]
    if spans[0] is None or spans[0] == spans[1] or (spans[1] and spans[0].endswith(f":{spans[1]}")):
        return str(spans[1])
    if spans[1] is None:
        return f"{spans[0]} (A)"
    return f"{spans[0]} → {spans[1]}"


def heading(cause: Cause) -> str:
    """Return the place, and in words what its lines do not show."""
    has_lines = cause.lines_before or cause.lines_after
    return place(cause) if has_lines else f"{place(cause)}: {cause.words}"


def following(diff: Diff) -> str | None:
    """Return how many changes are not listed one by one."""
    if not diff.follows:
        return None
    verb = "differs" if diff.follows == 1 else "differ"
    return f"{counted(diff.follows, 'number')} that MuJoCo computes from these {verb} too: --computed lists them"


def at_defaults(diff: Diff) -> str | None:
    """Return a remark that a matrix was compared at its defaults, or None if there is none or a cell was picked."""
    counts = [end.cells for end in (diff.a, diff.b) if end.cells]
    if not counts:
        return None
    cells = "1 cell" if counts[-1] == 1 else f"{counts[-1]} cells"
    return f"compared at its defaults: of the {cells} of the matrix, `--pick CELL` compares one"


def _lines(diff: Diff) -> Iterator[str]:
    yield f"A {diff.a.named}"
    yield f"B {diff.b.named}"
    yield verdict(diff)
    yield from (said for end in (diff.a, diff.b) if (said := end.said_outside))
    if (narrow := at_defaults(diff)) is not None:
        yield narrow
    contrast = diff.contrast
    if contrast.counts:
        yield ""
        yield "the whole model"
        yield from (f"  {count(each)}" for each in contrast.counts)
    for group in diff.groups:
        yield ""
        yield from _group(group)
    if contrast.moves:
        yield ""
        yield "addresses"
        yield from (f"  {each}" for each in moved(contrast.moves))
    if contrast.arrays:
        yield ""
        yield f"arrays of mjModel that differ: {', '.join(contrast.arrays)}"
    if diff.views:
        yield ""
        yield "pictures"
        yield from (f"  {each.name}: {view(each)}: {each.before}, {each.after}" for each in diff.views)
    if (more := following(diff)) is not None:
        yield ""
        yield more
    if diff.same_bytes != diff.same and diff.files:
        yield ""
        yield f"files that differ: {', '.join(diff.files)}"


def _group(group: Group) -> Iterator[str]:
    if group.cause is None:
        yield "without a line of its own"
    else:
        yield heading(group.cause)
        yield from (f"  - {line}" for line in group.cause.lines_before)
        yield from (f"  + {line}" for line in group.cause.lines_after)
    indent = "    " if group.cause is not None else "  "
    yield from (f"{indent}{each}" for each in sentences(group.changes))


_LONG = 12
_LONGEST = 60_000
"""Characters. GitHub allows 65536 in a comment."""


def render_markdown(diff: Diff) -> str:
    """Return headings by line, the lines as a diff, the changes as a list; cut to the length of a comment."""
    text = printable("\n".join(_lines_markdown(diff))).strip() + "\n"
    if len(text) <= _LONGEST:
        return text
    kept = text[:_LONGEST].rpartition("\n#### ")[0]
    kept += "\n\n</details>" * (kept.count("<details>") - kept.count("</details>"))
    return f"{kept}\n\n… and more: `mjcompose diff` prints all of it.\n"


def _lines_markdown(diff: Diff) -> Iterator[str]:
    yield f"### {_code(diff.a.named)} → {_code(diff.b.named)}"
    yield ""
    yield f"**{verdict(diff).capitalize()}.**"
    for said in (end.said_outside for end in (diff.a, diff.b)):
        if said:
            yield from ("", f"<sub>{said}</sub>")
    if (narrow := at_defaults(diff)) is not None:
        yield ""
        yield f"<sub>{narrow[0].upper()}{narrow[1:]}</sub>"
    contrast = diff.contrast
    if contrast.counts:
        yield ""
        yield from (f"- {count(each)}" for each in contrast.counts)
    for group in diff.groups:
        yield ""
        yield from _group_markdown(group)
    if contrast.moves:
        yield ""
        yield "#### Addresses"
        yield ""
        yield from _list([*moved(contrast.moves)])
    if contrast.arrays:
        yield ""
        yield f"Arrays of `mjModel` that differ: {', '.join(map(_code, contrast.arrays))}"
    if diff.views:
        yield ""
        yield "#### Pictures"
        yield ""
        yield "| view | before | after |"
        yield "|---|---|---|"
        yield from (
            f"| {_code(each.name)}<br>{view(each)} | ![before](<{each.before}>) | ![after](<{each.after}>) |"
            for each in diff.views
        )
    if (more := following(diff)) is not None:
        yield ""
        yield f"<sub>{more}</sub>"


def _group_markdown(group: Group) -> Iterator[str]:
    if group.cause is None:
        yield "#### Without a line of its own"
    else:
        words = "" if group.cause.lines_before or group.cause.lines_after else f": {_escaped(group.cause.words)}"
        yield f"#### {_code(place(group.cause))}{words}"
        lines = [f"- {line}" for line in group.cause.lines_before] + [f"+ {line}" for line in group.cause.lines_after]
        if lines:
            fence = "`" * max(3, 1 + max(len(each) for each in re.findall("`*", " ".join(lines))))
            yield f"{fence}diff"
            yield from lines
            yield fence
    yield ""
    yield from _list(list(sentences(group.changes)))


def _list(lines: list[str]) -> Iterator[str]:
    if len(lines) > _LONG:
        yield f"<details><summary>{len(lines)} changes</summary>"
        yield ""
    for line in lines:
        yield f"- {_escaped(line)}"
    if len(lines) > _LONG:
        yield ""
        yield "</details>"


def _escaped(line: str) -> str:
    """Escape what Markdown would interpret outside of backquotes."""
    pieces = line.split("`")
    pieces[::2] = [re.sub(r"([\\*_<>#|])", r"\\\1", piece) for piece in pieces[::2]]
    return "`".join(pieces)


def _code(text: str) -> str:
    fence = "`" * (1 + max(len(each) for each in re.findall("`*", text)))
    return f"{fence}{text}{fence}" if fence == "`" else f"{fence} {text} {fence}"

"""Describe a change in one sentence, as a roboticist would."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import TypeAlias

from composer.compiled.quantities import is_place, quantity, rank, unit
from composer.diff.change import SETTINGS, Change, Count, Move, Value, View

_NAMED = 5
_NOISE = 1e-12
_PLURALS = {
    "body": "bodies",
    "mesh": "meshes",
    "equality": "equalities",
    "flex": "flexes",
    "key": "keyframes",
    "default class": "default classes",
}
_SINGULARS = {"key": "keyframe"}
Between: TypeAlias = Callable[[Value, Value, str], str]
_ORDER = ("renamed", "removed", "added", "changed")


def sentences(changes: Iterable[Change], between: Between | None = None) -> Iterator[str]:
    """Yield one line for each change, or for all equal changes of several elements.

    `between` puts a value and its new value into words, with their unit; the default is an arrow.
    """
    changes = sorted(changes, key=lambda each: (_ORDER.index(each.what), rank(each.field)))
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
    for (vector, kind, by), run in groupby(
        moves, key=lambda each: (each.vector, each.kind, each.after - each.before)
    ):
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
    return (
        f"{_SINGULARS.get(kind, kind)} {shown}" if len(names) == 1 else f"{len(names)} {plural(kind)} {shown}"
    )


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
    known = quantity(change.field)
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

"""Describe the outcome of an import in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from composer.diff.change import Value
from composer.diff.words import sentences, shown, subject
from composer.importing.contrasting import Outcome
from composer.importing.entries import Changed


def changed(facts: tuple[Changed, ...]) -> Iterator[str]:
    """Yield one line for each changed attribute: ``mesh `elbow`: scale 1 1 1 → 1.1 1.1 1.1``."""
    alike: dict[tuple[object, ...], list[Changed]] = {}
    for each in facts:
        key = (each.kind, each.attribute, each.before, each.after, each.unit, each.count)
        alike.setdefault(key, []).append(each)
    for several in alike.values():
        each = several[0]
        unit = f" {each.unit}" if each.unit else ""
        before, after = ("none" if value is None else f"{value}{unit}" for value in (each.before, each.after))
        of = subject(each.kind, [one.name for one in several])
        alone = f" ({each.count} elements)" if each.count > 1 else ""
        yield f"{of}: {each.attribute} {before} → {after}{alone}"


def left(outcome: Outcome, merged: str) -> Iterator[str]:
    """Yield one line for each remaining difference between the recipe's model and the merged one.

    Differences that follow from others are only counted.
    """

    def between(wanted: Value, there: Value, unit: str) -> str:
        digits = None if shown(there) == shown(wanted) else 6
        ours, theirs = (
            f"{shown(value, digits)}{f' {unit}' if unit and value is not None else ''}"
            for value in (there, wanted)
        )
        return f"{ours}, in {merged} it is {theirs}"

    follows = [each for each in outcome.changes if each.follows]
    others = [each for each in outcome.changes if not each.follows]
    if not others:
        others, follows = follows, []
    presence = sorted(
        (each for each in others if each.what != "changed"), key=lambda each: (each.what, each.kind)
    )
    for (what, kind), several in groupby(presence, key=lambda each: (each.what, each.kind)):
        names = [each.name for each in several]
        verb = "is" if len(names) == 1 else "are"
        yield f"{subject(kind, names)} {verb} {'missing' if what == 'removed' else f'not in {merged}'}"
    yield from sentences((each for each in others if each.what == "changed"), between)
    if follows:
        verb = "differs" if len(follows) == 1 else "differ"
        yield f"{amount(len(follows), 'number')} that MuJoCo computes from these {verb} too"


def amount(number: int, word: str, several: str = "") -> str:
    """`1 part`, `2 parts`."""
    return f"{number} {word if number == 1 else several or f'{word}s'}"

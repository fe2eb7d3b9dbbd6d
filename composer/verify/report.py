"""The wording of differences between a part and its source."""

from __future__ import annotations

from collections.abc import Sequence

from composer.compiled.affected_arrays import DERIVED
from composer.compiled.difference import EXTRA, MISSING, Difference
from composer.diagnostics.diagnostic import Note
from composer.verify.parts import Compared

_SHOWN = 8
"""How many differences of a part are listed one by one."""


def causes(differences: Sequence[Difference]) -> list[Difference]:
    """Return the differences that do not follow from others; all of them if each follows from another."""
    return [each for each in differences if each.array not in DERIVED] or list(differences)


def changed(compared: Compared) -> str:
    """Return one sentence about a part that differs from its source."""
    found = causes(compared.differences)
    places = len(found)
    arrays = list(dict.fromkeys(_what(each) for each in found))
    shown = ", ".join(arrays[:4]) + (", …" if len(arrays) > 4 else "")
    return (
        f"`{compared.member.called}` is not what `{compared.member.source.path.name}` is alone: "
        f"{places} difference{'s' if places > 1 else ''} ({shown})"
    )


def notes(differences: Sequence[Difference]) -> list[Note]:
    """Return the first differences as notes, with the expected and actual values."""
    found = causes(differences)
    listed = [Note(str(each)) for each in found[:_SHOWN]]
    if len(found) > _SHOWN:
        listed.append(Note(f"and {len(found) - _SHOWN} more"))
    return listed


def _what(difference: Difference) -> str:
    if difference.field in (MISSING, EXTRA):
        return f"{difference.field} {difference.kind}"
    return f"`{difference.array}`"

"""What is reported of a part that is not what its source is alone."""

from __future__ import annotations

from collections.abc import Sequence

from composer.compiled.affected_arrays import DERIVED
from composer.compiled.difference import EXTRA, MISSING, Difference
from composer.diagnostics.diagnostic import Note
from composer.verify.parts import Compared

_SHOWN = 8
"""How many differences of a part are reported one by one."""


def causes(differences: Sequence[Difference]) -> list[Difference]:
    """The differences without those that follow from others, as long as there are any."""
    return [each for each in differences if each.array not in DERIVED] or list(differences)


def changed(compared: Compared) -> str:
    """One sentence about a part that is not what it is alone."""
    found = causes(compared.differences)
    places = len(found)
    arrays = list(dict.fromkeys(_what(each) for each in found))
    shown = ", ".join(arrays[:4]) + (", …" if len(arrays) > 4 else "")
    return (
        f"`{compared.member.called}` is not what `{compared.member.source.path.name}` is alone: "
        f"{places} difference{'s' if places > 1 else ''} ({shown})"
    )


def notes(differences: Sequence[Difference]) -> list[Note]:
    """The first differences, expected and actual."""
    found = causes(differences)
    listed = [Note(str(each)) for each in found[:_SHOWN]]
    if len(found) > _SHOWN:
        listed.append(Note(f"and {len(found) - _SHOWN} more"))
    return listed


def _what(difference: Difference) -> str:
    if difference.field in (MISSING, EXTRA):
        return f"{difference.field} {difference.kind}"
    return f"`{difference.array}`"

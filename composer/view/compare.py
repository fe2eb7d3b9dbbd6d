"""Two models on one page: additions, removals and changes in colour, and the text of the comparison."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.context import Context
from composer.diff.change import Change, Diff
from composer.diff.side import Side
from composer.diff.text import render
from composer.view.description import described
from composer.view.names import Names
from composer.view.page import alone

if TYPE_CHECKING:
    from composer.engine import Session

_ABSENT = -1
_PLACES = ("body_pos", "body_quat")


def write_comparison(a: Side, b: Side, found: Diff, out: Path, context: Context, session: Session) -> bool:
    """Write the page of two models that `session` keeps; return False after an error, which is reported."""
    names = Names(context.folder)
    changes = difference(names.diff(found))
    before = described(a, session, names=names, difference=changes)
    after = None if before is None else described(b, session, before.used, names=names, difference=changes)
    if before is None or after is None:
        for side in (a, b):
            side.operand.report(context.sink)
        return False
    try:
        with staged_file(context.folder / out, "--html", inputs=(*a.inputs, *b.inputs)) as stage:
            stage.write_text(alone(before, after), encoding="utf-8")
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return False
    return True


def difference(found: Diff) -> dict[str, Any]:
    """Return the comparison as data for the page: its text, and for each model the elements that differ."""
    changes = [each for each in found.contrast.changes if not each.follows]
    return {
        "label": f"{found.a.named} → {found.b.named}",
        "text": render(found),
        "before": {what: _elements(changes, what, 0) for what in ("removed", "changed", "moved")},
        "after": {what: _elements(changes, what, 1) for what in ("added", "changed", "moved")},
    }


def _elements(changes: list[Change], what: str, side: int) -> list[str]:
    """Return the elements of A or B with this kind of change, as `KIND NUMBER`."""
    found = (
        f"{each.kind} {each.index[side]}"
        for each in changes
        if _what(each) == what and each.index[side] != _ABSENT
    )
    return list(dict.fromkeys(found))


def _what(change: Change) -> str:
    return "moved" if change.kind == "body" and change.field in _PLACES else change.what

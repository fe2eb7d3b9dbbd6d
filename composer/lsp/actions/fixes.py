"""Code action: apply the fix of a diagnostic, such as a correct spelling, missing quotes or a unit."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.decode import position
from composer.fixing.edit import edit_of, place_of
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action, Change


def offer(offered: Offer) -> Iterator[Action]:
    """Yield the fix of each diagnostic in the recipe."""
    for diagnostic in offered.diagnostics:
        change = change_of(diagnostic, offered.analysis.text, offered.analysis.file)
        if change is not None:
            title = (diagnostic.help or f"write `{change.text}`").partition("\n")[0]
            yield Action(title, (change,), diagnostic, is_preferred=True)


def change_of(diagnostic: Diagnostic, text: str, file: str) -> Change | None:
    """Return the fix of a diagnostic as a change of this file, or None if it has no fix for it."""
    place = place_of(diagnostic)
    edit = edit_of(diagnostic, text) if place is not None and place.file == file else None
    if edit is None:
        return None
    (line, column), (end_line, end_column) = position(text, edit.start), position(text, edit.end)
    return Change(Span(file, line, column, end_line, end_column), edit.text)

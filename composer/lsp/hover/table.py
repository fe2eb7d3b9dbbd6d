"""All kinds of hover, one row for each. The first one that returns something is used."""

from __future__ import annotations

from collections.abc import Callable

from composer.lsp.answers import Hover
from composer.lsp.hover import element, expression, key, model, selector, setting
from composer.lsp.question import Question

Show = Callable[[Question], Hover | None]
SHOWS: tuple[Show, ...] = (
    expression.show,
    element.show,
    model.show,
    setting.show,
    selector.show,
    key.show,
)


def hover(question: Question) -> Hover | None:
    """Return information about what is at the cursor, or None."""
    if question.cursor.role == "text":
        return None
    return next((found for show in SHOWS if (found := show(question)) is not None), None)

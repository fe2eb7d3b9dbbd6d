"""The exact change that the help of a diagnostic describes, where there is only one."""

from __future__ import annotations

from dataclasses import dataclass

from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Fix:
    """What to write in place of a stretch of text.

    `replaces` is the name that stands there, quotes aside: the new one gets quotes where it needs them. Without it
    `replacement` is text of the file as it is. `span` is None for the place of the diagnostic; an empty one is a place
    to insert at.
    """

    replacement: str
    replaces: str | None = None
    span: Span | None = None

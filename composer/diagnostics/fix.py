"""The exact change that the help of a diagnostic describes, if there is only one."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Fix:
    """A replacement for a stretch of text.

    If `replaces` is set, it is the name to replace, without quotes; the new name gets quotes if it needs them.
    Otherwise `replacement` is verbatim text. `span` is None for the place of the diagnostic; an empty span is a
    place to insert at.
    """

    replacement: str
    replaces: str | None = None
    span: Span | None = None

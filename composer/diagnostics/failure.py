"""The exception at the boundary of the Python interface."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.text import render


class MjcomposeError(Exception):
    """Raised to Python callers when the input has errors; carries every diagnostic of the run.

    `str()` is the text rendering without source lines. Can be pickled.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        return "\n".join(render(each) for each in self.diagnostics)

"""The exception of the Python interface."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.text import render
from composer.limits import Advice


class MjcomposeError(Exception):
    """Raised to Python callers if the input has errors; carries every diagnostic of the run.

    `str()` renders them without source lines. Can be pickled.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(
            replace(each, help=each.help.in_python) if isinstance(each.help, Advice) else each
            for each in diagnostics
        )
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        return "\n".join(render(each) for each in self.diagnostics)

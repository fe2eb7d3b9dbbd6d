"""What came of one check."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Outcome:
    """A check that ran: what the outermost recipe calls it (`left/reach`), its kind and place, and what it told."""

    name: str
    kind: str
    span: Span
    told: tuple[Diagnostic, ...]

    @property
    def holds(self) -> bool:
        return not self.told


Hear = Callable[[Outcome], None]
"""Who is told of each check that ran."""

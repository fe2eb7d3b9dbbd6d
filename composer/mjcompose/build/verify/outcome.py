"""The outcome of one check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Severity, Span


@dataclass(frozen=True, slots=True)
class Outcome:
    """A check that ran: its name in the outermost recipe (`left/reach`), kind, place, diagnostics and values."""

    name: str
    kind: str
    span: Span
    diagnostics: tuple[Diagnostic, ...]
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        return not any(each.severity is Severity.ERROR for each in self.diagnostics)

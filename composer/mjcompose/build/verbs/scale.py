"""Verb `scale`: multiply numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Path
from mjcompose.build.compose.keys import report_only_zeros, zero_attributes
from mjcompose.build.verbs.values import SCALE, Entry, change_all


def carry_out(entry: Entry, value: Mapping[str, Any], at: Path) -> None:
    """Multiply the numbers of every selected element. Warn about a factor that changes nothing."""
    zeros = zero_attributes(entry.editing, entry.found, value)
    change_all(entry, SCALE, value, at=at)
    for key in zeros:
        written = f'"{key}"' if "[" in key else key
        help = f"write the value itself, `set: {{{written}: …}}`, or what is added to it, by `offset`"
        report_only_zeros(entry.editing, entry.found, key, at=(*at, key), help=help)

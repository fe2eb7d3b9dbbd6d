"""Verb `scale`: multiply numbers."""

from __future__ import annotations

from mjcompose.base.diagnostic import Path
from mjcompose.compose.verbs.values import SCALE, Entry, change_all, report_only_zeros, zero_attributes
from mjcompose.language.verbs.scale import Scale


def carry_out(verb: Scale, entry: Entry, at: Path) -> None:
    zeros = zero_attributes(entry.editing, entry.found, verb.written)
    change_all(entry, SCALE, verb.written, at=at)
    for key in zeros:
        name = f'"{key}"' if "[" in key else key
        help = f"write the value itself: `set: {{{name}: …}}`"
        report_only_zeros(entry.editing, entry.found, key, at=(*at, key), help=help)

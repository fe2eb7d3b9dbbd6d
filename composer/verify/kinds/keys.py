"""Find the keyframes that a check names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from composer.diagnostics.fault import Fault
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.verify.kinds.scope import Scope


def keys_named(scope: Scope, globs: Sequence[str]) -> list[str] | Fault:
    """Return the names of the keyframes that the globs match, as in the recipe; all of them without globs."""
    known = [] if scope.keys is None else scope.names("key")
    if not globs:
        return known
    found: list[str] = []
    for at, glob in enumerate(globs):
        fitting = scope.fitting(glob, known)
        if not fitting:
            notes = (exists_note("keyframe", known, glob),)
            place = ("keys", at) if len(globs) > 1 else ("keys",)
            help = did_you_mean(glob, known)
            return Fault("unknown-name", f"`{glob}` names no keyframe", place, notes=notes, help=help)
        found += [name for name in known if name in fitting and name not in found]
    return found


def at_keys(scope: Scope, names: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """Yield an mjData at each keyframe. The caller still calls `mj_forward`."""
    for name in names:
        data = scope.at_key(name)
        if not isinstance(data, Fault):
            yield name, data


def unmet(scope: Scope, kinds: Sequence[str], globs: Sequence[str], *at: str | int) -> Fault | None:
    """Return a finding for the first glob that matches nothing of these kinds."""
    known = [name for kind in kinds for name in scope.names(kind)]
    for index, glob in enumerate(globs):
        if not scope.fitting(glob, known):
            notes = (exists_note("name", sorted(known), glob),)
            place = (*at, index) if len(globs) > 1 else at
            message, help = f"`{glob}` names no {' and no '.join(kinds)}", did_you_mean(glob, known)
            return Fault("unknown-name", message, place, notes=notes, help=help)
    return None

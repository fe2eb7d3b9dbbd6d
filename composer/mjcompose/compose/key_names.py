"""The names that the entries of a key set: entries go by names and by globs."""

from __future__ import annotations

from collections.abc import Collection

from mjcompose.tree.pattern import fitter, is_pattern


def entries_by_name(written: Collection[str], names: Collection[str], separator: str) -> dict[str, list[str]]:
    """Return each name that entries set, with these entries: the entry with that name, or else all globs that fit.

    Raises `BadPattern`.

    >>> entries_by_name(["*_hip", "FL_hip", "knee"], ["FL_hip", "FR_hip", "FR_knee"], "/")
    {'FL_hip': ['FL_hip'], 'FR_hip': ['*_hip']}
    """
    fitters = {entry: fitter(entry, lambda: names, separator) for entry in written if is_glob_of(entry, names)}
    found: dict[str, list[str]] = {}
    for name in names:
        if name in written:
            found[name] = [name]
        elif fitting := [glob for glob, fits in fitters.items() if fits(name)]:
            found[name] = fitting
    return found


def is_glob_of(entry: str, names: Collection[str]) -> bool:
    """Return whether an entry is a glob or a regular expression for names, and no name itself."""
    return entry not in names and is_pattern(entry)

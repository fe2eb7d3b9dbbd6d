"""Words that messages share: values and their kinds, unknown keys, and texts that XML cannot hold."""

from __future__ import annotations

from collections.abc import Iterable

from mjcompose.base.diagnostic import Diagnostic, Fault, Fix, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.tree.grammar import number_text

# Two keys exclude each other.
EXCLUSIVE = "wrong-type"


def fault_at(
    diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None, fix: Fix | None = None
) -> Fault:
    """Return a diagnostic as a fault at a path. `help` and `fix` replace the diagnostic's own."""
    names = tuple(sorted(diagnostic.subjects))
    fix = fix if help else diagnostic.fix
    help = help or diagnostic.help
    return Fault(
        diagnostic.code, diagnostic.message, at, key=key, notes=diagnostic.notes, help=help, names=names, fix=fix
    )


def unknown_key(message: str, name: str, known: Iterable[str], at: Path, *, noun: str = "key") -> Fault:
    """Return the fault of an unknown key. `known` are the allowed keys, which messages call a `noun`."""
    known = list(known)
    help, fix = advised(name, known)
    note = exists_note(noun, known, name)
    return Fault("unknown-key", message, at, key=True, notes=(note,), help=help, fix=fix)


def shown(value: object) -> str:
    """Return a value as YAML on one line.

    >>> shown([0, "90deg", 1.5])
    '[0, 90deg, 1.5]'
    """
    if isinstance(value, list | tuple):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, int | float) else str(value)


def kind_of(value: object) -> str:
    """Return the kind of a value, with the value itself if it is short: `text `abc``, `a list`."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None:
        return "nothing"
    kind = "text" if isinstance(value, str) else "a boolean" if isinstance(value, bool) else "a number"
    text = shown(value)
    if isinstance(value, float) and text.removeprefix("-").isdigit():
        text += ".0"  # the expected value may be a whole number, which this is not
    return f"{kind} `{text}`" if len(text) <= 40 and "\n" not in text else kind


# Characters that no XML file can contain, not even escaped.
_UNPRINTABLE = frozenset(map(chr, (*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF, *range(0xD800, 0xE000))))


def is_unprintable(text: str) -> bool:
    """Return whether a text has a character that XML cannot contain."""
    return not _UNPRINTABLE.isdisjoint(text)


def unprintable(subject: str, at: Path, *, key: bool = False, name: bool = True) -> Fault:
    """Return the fault of a text with such a character."""
    return Fault("bad-name" if name else "wrong-type", f"{subject} has a character that XML cannot hold", at, key=key)

"""The row of a kind of model reference: its facts, and the functions that parse and resolve a reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.sources.kind import Kind

if TYPE_CHECKING:
    from composer.sources.fetching import Lookup
    from composer.sources.reference import Reference
    from composer.sources.source import Source


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceKind(Kind):
    """A kind of model reference as a row of `composer.sources.kinds.KINDS`. Every field is required.

    `parse` takes the text of a reference apart, without I/O; `resolve` finds its file, and fetches it if necessary.
    Both raise SourceError for a faulty reference. `host` returns the server of a reference, with its port, or None;
    `is_of_this_machine` returns whether a reference without a server names something that only this machine has.
    Neither does I/O; they decide whether a fetched recipe may contain the reference.
    """

    parse: Callable[[str], Reference]
    resolve: Callable[[Reference, Lookup], Source]
    host: Callable[[Reference], str | None]
    is_of_this_machine: Callable[[Reference], bool]


def no_host(reference: Reference) -> str | None:
    """Return None, for kinds without a server."""
    return None


def always(reference: Reference) -> bool:
    """Return True, for kinds whose references always name something on this machine."""
    return True


def never(reference: Reference) -> bool:
    """Return False, for kinds whose references never name something that only this machine has."""
    return False

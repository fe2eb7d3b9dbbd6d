"""The row of a kind of model reference: its facts, and the functions that read and follow a reference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from composer.sources.kind import Kind

if TYPE_CHECKING:
    from composer.sources.fetching import Lookup
    from composer.sources.reference import Reference
    from composer.sources.source import Source


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceKind(Kind):
    """A kind of model reference as a row of `composer.sources.kinds.KINDS`. Every field is required.

    `parse` takes the text of a reference apart, without I/O; `resolve` finds the file that it stands for, and fetches
    it where that is needed. Both raise SourceError for what is wrong with the reference. `host` gives the server that a
    reference is fetched from, with its port, or None; `is_of_this_machine` says whether one without a server names what
    only this machine has. Neither does I/O; what they say decides whether a fetched recipe may write the reference.
    """

    parse: Callable[[str], Reference]
    resolve: Callable[[Reference, Lookup], Source]
    host: Callable[[Reference], str | None]
    is_of_this_machine: Callable[[Reference], bool]


def no_host(reference: Reference) -> str | None:
    """For kinds that ask no server by themselves."""
    return None


def always(reference: Reference) -> bool:
    """For kinds of which every reference names what this machine has."""
    return True


def never(reference: Reference) -> bool:
    """For kinds of which no reference names what only this machine has."""
    return False

"""The row of a kind of model reference: its facts, and the functions that read and follow a reference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from composer.sources.fetching import Lookup
from composer.sources.kind import Kind
from composer.sources.reference import Reference
from composer.sources.source import Source


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceKind(Kind):
    """A kind of model reference as a row of `composer.sources.kinds.KINDS`. Every field is required.

    `parse` takes the text of a reference apart, without I/O; `resolve` finds the file that it stands for, and fetches
    it where that is needed. Both raise SourceError for what is wrong with the reference.
    """

    parse: Callable[[str], Reference]
    resolve: Callable[[Reference, Lookup], Source]

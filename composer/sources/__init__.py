"""Where models come from: a model reference in, a local file with its origin and licences out."""

from __future__ import annotations

from composer.sources.error import SourceError
from composer.sources.reference import Kind, Reference, parse
from composer.sources.resolve import resolve
from composer.sources.source import Source

__all__ = ["Kind", "Reference", "Source", "SourceError", "parse", "resolve"]

"""Resolve model references to local files with their origin and licences.

Submodules are imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    from composer.sources.error import SourceError
    from composer.sources.kinds import parse
    from composer.sources.reference import Reference
    from composer.sources.source import Source

__all__ = ["Reference", "Source", "SourceError", "parse"]

_HOME = {"Reference": "reference", "Source": "source", "SourceError": "error", "parse": "kinds"}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"composer.sources.{_HOME[name]}"), name)

"""Verb `offset`: add to numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Path
from mjcompose.build.verbs.values import OFFSET, Entry, change_all


def carry_out(entry: Entry, value: Mapping[str, Any], at: Path) -> None:
    """Add the values to the present ones on every selected element."""
    change_all(entry, OFFSET, value, at=at)

"""Verb `set`: give attributes new values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Path
from mjcompose.build.verbs.values import SET, Entry, change_all


def carry_out(entry: Entry, value: Mapping[str, Any], at: Path) -> None:
    """Write the values on every selected element."""
    change_all(entry, SET, value, at=at)

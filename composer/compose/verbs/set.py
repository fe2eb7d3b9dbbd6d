"""Verb `set`: give attributes new values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.compose.verbs.change import change_all
from composer.compose.verbs.entry import Entry
from composer.compose.verbs.operation import SET
from composer.recipe.fault import Path


def carry_out(entry: Entry, value: Mapping[str, Any], at: Path) -> None:
    """Write the values on every selected element."""
    change_all(entry, SET, value, at=at)

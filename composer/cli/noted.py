"""Record the files that a command has read, for `--watch`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from composer.context import Context

_READ = "composer.read"


def note_files(files: Iterable[str | Path]) -> None:
    """Record files of the current command."""
    if (context := click.get_current_context(silent=True)) is not None:
        context.meta.setdefault(_READ, set()).update(map(Path, files))


def note_reported(context: Context) -> None:
    """Record for `--watch` the files that may fix a fault."""
    current = click.get_current_context(silent=True)
    if current is not None and current.params.get("watch"):
        from composer.view.watching import hopes

        note_files(hopes(context))


def noted_files() -> set[Path]:
    return set(click.get_current_context().meta.get(_READ, ()))

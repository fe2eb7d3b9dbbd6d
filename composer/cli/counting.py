"""Progress of a long run: a bar on a terminal, a line every ten seconds elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import click

from composer.cli.reporting import is_quiet, on_terminal

Item = TypeVar("Item")
_EVERY = 10.0
_WIDTH = 20


def counting(items: Iterable[Item], total: int, name: Callable[[Item], str]) -> Iterator[Item]:
    """Yield the items; show a bar, their count, the rate and the name of the last one on standard error."""
    if is_quiet():
        yield from items
        return
    start = said = time.monotonic()
    terminal = on_terminal()
    for done, item in enumerate(items, 1):
        if terminal:
            click.echo("\r\x1b[K", err=True, nl=False)
        yield item
        now = time.monotonic()
        if terminal or now - said >= _EVERY:
            said = now
            line = f"{done}/{total} {done / max(now - start, 1e-9):.1f}/s {name(item)}"
            click.echo(f"{_bar(done, total)} {line}" if terminal else line, err=True, nl=not terminal)
    if terminal:
        click.echo("\r\x1b[K", err=True, nl=False)


def _bar(done: int, total: int) -> str:
    """Return a progress bar as text. No I/O.

    >>> _bar(1, 4)
    '[#####               ]'
    """
    return f"[{'#' * (_WIDTH * done // total):{_WIDTH}}]"

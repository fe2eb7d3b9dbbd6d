"""How far a long run of many things is: a line that stays on a terminal, one every ten seconds elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import click

from composer.cli.reporting import on_terminal

Item = TypeVar("Item")
_EVERY = 10.0


def counting(items: Iterable[Item], total: int, name: Callable[[Item], str]) -> Iterator[Item]:
    """The items as they come, with their count, the rate and the name of the last one on standard error.

    Where the run is interrupted, what is whole is said too.
    """
    start = said = time.monotonic()
    terminal = on_terminal()
    done = 0
    try:
        for item in items:
            yield item
            done += 1
            now = time.monotonic()
            if terminal or now - said >= _EVERY:
                said = now
                line = f"{done}/{total} {done / max(now - start, 1e-9):.1f}/s {name(item)}"
                click.echo(f"\r\x1b[K{line}" if terminal else line, err=True, nl=not terminal)
    except (KeyboardInterrupt, GeneratorExit):
        if done < total and sys.stderr is not None:
            click.echo(
                f"\n{done} of {total} are done and whole; the same command again builds them all", err=True
            )
        raise
    if terminal:
        click.echo("\r\x1b[K", err=True, nl=False)

"""The options that limit what a command may fetch, and its progress messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from composer.cli.reporting import progress

if TYPE_CHECKING:
    from composer.sources.fetching import Fetching

_LOCKED, _OFFLINE = "composer.locked", "composer.offline"


def fetching_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--locked`, `--offline`, and `--frozen` for both. They are not arguments of the command: see `fetching`."""
    for flag, said, *asked in (
        ("--frozen", "The same as --locked --offline.", _LOCKED, _OFFLINE),
        ("--offline", "Fetch nothing. Use the locked or last fetched sources in the store.", _OFFLINE),
        ("--locked", "Fail if the lock file is missing or outdated.", _LOCKED),
    ):
        command = click.option(flag, is_flag=True, expose_value=False, help=said, callback=_noting(asked))(
            command
        )
    return command


def _noting(asked: list[str]) -> Callable[[click.Context, click.Parameter, bool], None]:
    def note(ctx: click.Context, parameter: click.Parameter, given: bool) -> None:
        if given:
            ctx.meta.update(dict.fromkeys(asked, True))

    return note


def fetching() -> Fetching:
    """Return how the current command may fetch; progress goes to standard error on a terminal."""
    from composer.sources.fetching import Fetching

    known = click.get_current_context().meta
    return Fetching(locked=_LOCKED in known, offline=_OFFLINE in known, progress=_of_this_command())


def _of_this_command() -> Callable[[str], None]:
    """Return a progress function for this command that other threads can call, which lack click's context."""
    context = click.get_current_context()

    def report(message: str) -> None:
        with context.scope(cleanup=False):
            progress(message)

    return report

"""`mjcompose update`: lock the current state of sources."""

from __future__ import annotations

from pathlib import Path

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.lock import write_lock
from mjcompose.cli.options import RECIPE, Choices, LimitOptions, ReportOptions
from mjcompose.cli.run import Answer, Run, argument, command, group


@dataclass(frozen=True, slots=True)
class Options:
    """The options of `update`."""

    recipe: Path = RECIPE
    names: tuple[str, ...] = argument(metavar="[NAME]...", nargs=-1)
    choices: Choices = group(Choices)
    limits: LimitOptions = group(LimitOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options, fetches=True)
def update(options: Options, run: Run) -> Answer:
    """Lock the current state of the sources of RECIPE: the newest commits of branches, and archives as served now.

    NAME is the prefix of a part, `base`, or a source as named in the lock. Without NAME, all sources are updated.
    """
    return write_lock(options.recipe, options.names, choices=options.choices, run=run)

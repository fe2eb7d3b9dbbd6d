"""`mjcompose version`: the same as `--version`."""

from __future__ import annotations

from mjcompose.base.dataclass import dataclass
from mjcompose.base.version import __version__
from mjcompose.cli.run import Answer, Run, command


@dataclass(frozen=True, slots=True)
class Options:
    """`version` has no options."""


@command(Options)
def version(options: Options, run: Run) -> Answer:
    """Print the version. `mjcompose doctor` prints the versions of all dependencies."""
    return Answer(f"mjcompose, version {__version__}")

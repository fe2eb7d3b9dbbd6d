"""`--cluster`: make the cells on other machines."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import DiagnosticError
from mjcompose.base.processes import cores
from mjcompose.cli.reporting import is_quiet, say

if TYPE_CHECKING:
    from mjcompose.base.diagnostic import Diagnostic
    from mjcompose.build.bundle.bundle import Location
    from mjcompose.build.cache.cell_run import CellResult, Finish
    from mjcompose.sources.context import Context
    from mjcompose.tools.cluster.client import Crew


@contextmanager
def crew_of(
    cluster: str | None, jobs: int | None, out: Location | None = None, away: Finish | None = None
) -> Iterator[Crew | None]:
    """Yield the workers that `--cluster` names, which write below `out`, or None without the option.

    `away` writes on a machine with other folders.
    """
    if cluster is None:
        yield None
        return
    from mjcompose.tools.cluster.client import Crew

    def tell(message: str) -> None:
        if not is_quiet():
            say(message, err=True)

    with Crew(cluster, jobs or cores(), out, tell=tell, away=away) as crew:
        yield crew


class FullError(DiagnosticError):
    """No more models can be written, so making others is useless."""


def found_no_room(result: CellResult) -> bool:
    """Return whether there was no room for a model, according to its diagnostics."""
    return any(each.code == "output-full" for each in result.diagnostics)


def check_room(result: CellResult) -> None:
    """Raise FullError if there was no room for a model, which has been reported."""
    if found_no_room(result):
        raise FullError("output-full", "there is no room for more models")


@contextmanager
def stopped(context: Context) -> Iterator[list[Diagnostic]]:
    """End the block if the workers are lost or a disk is full; the reason is reported, and is in the yielded list."""
    found: list[Diagnostic] = []
    try:
        yield found
    except FullError as error:
        found.append(error.diagnostic)
    except DiagnosticError as error:
        context.sink.add(error.diagnostic)
        found.append(error.diagnostic)

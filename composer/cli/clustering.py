"""`--cluster`: who makes the cells where this machine does not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from composer.cli.reporting import is_quiet, say
from composer.diagnostics.error import DiagnosticError
from composer.processes.pool import cores

if TYPE_CHECKING:
    from composer.bundle.place import Place
    from composer.cache.making import Finish, MadeCell
    from composer.cluster.crew import Crew
    from composer.context import Context
    from composer.diagnostics.diagnostic import Diagnostic


@contextmanager
def crew_of(
    cluster: str | None, jobs: int | None, out: Place | None = None, away: Finish | None = None
) -> Iterator[Crew | None]:
    """The workers that `--cluster` names, which write below `out`; None without it.

    `away` does that on a machine that has other folders.
    """
    if cluster is None:
        yield None
        return
    from composer.cluster.crew import Crew

    def tell(message: str) -> None:
        if not is_quiet():
            say(message, err=True)

    with Crew(cluster, jobs or cores(), out, tell, away) as crew:
        yield crew


class FullError(DiagnosticError):
    """No model can be written any more: it is of no use to make others."""


def found_no_room(made: MadeCell) -> bool:
    """Whether there was no room for a model, which says so itself."""
    return any(each.code == "output-full" for each in made.found)


def check_room(made: MadeCell) -> None:
    """Raise FullError if there was no room for a model; it has been reported."""
    if found_no_room(made):
        raise FullError("output-full", "there is no room for more models")


@contextmanager
def stopped(context: Context) -> Iterator[list[Diagnostic]]:
    """A block that ends where nobody can do the work, or a disk is full; why is reported, and is in the list."""
    found: list[Diagnostic] = []
    try:
        yield found
    except FullError as error:
        found.append(error.diagnostic)
    except DiagnosticError as error:
        context.sink.add(error.diagnostic)
        found.append(error.diagnostic)

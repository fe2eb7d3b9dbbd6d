"""The cells of a command: their selection, their workers, and their count."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, ClassVar, TypeVar

import click
from click.core import ParameterSource

from mjcompose.base import report as text
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import CellName, Diagnostic, DiagnosticError, listed
from mjcompose.base.files import STDIN
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import Location
from mjcompose.cli import completion, options
from mjcompose.cli.options import NO_CACHE, STRICT, Choices, FetchOptions, LimitOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import USAGE, exit_code, is_quiet, on_terminal, say
from mjcompose.cli.run import Group, Run, flag, group, option
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.language.expand import Cell
    from mjcompose.pipeline.cache.cell_run import CellResult, Finish
    from mjcompose.text.node import Node
    from mjcompose.tools.cluster.client import Crew

Item = TypeVar("Item")


class CellOptions(Group):
    heading: ClassVar[str] = "Model"
    pick: str | None = option(
        "--pick",
        metavar="CELL",
        shell_complete=completion.cells,
        help="Select this cell of the matrix, this sample, or AXIS=VALUE[,...].",
    )
    sample: int | None = option(
        "--sample",
        type=click.IntRange(min=0),
        metavar="NUMBER",
        shell_complete=completion.samples,
        help="Select this sample of the recipe's draws. Sample 0, the default, has no draws.",
    )

    def check(self, model: str | Path, *, is_recipe: bool) -> None:
        """Raise UsageError if a cell is chosen of something that is not a recipe."""
        if self.pick is not None and not is_recipe:
            raise click.UsageError(f"{model} is not a recipe and has no cells: remove --pick")

    def chosen(self, recipe: Path, given: dict[str, Node], run: Run, verb: str) -> Cell | None:
        """Return the cell of `--pick`, or None without the option; if the cell does not exist, end the command."""
        if self.pick is None:
            return None
        from mjcompose.pipeline.cache.cells import cells_of, check_axes_are_free, select_cell

        sink = run.context.sink
        every = cells_of(recipe, run.context, given)
        run.check(run.code_of_failure(recipe))
        cell = select_cell(every, self.pick, self.sample, sink=sink, recipe=str(recipe))
        if cell is not None:
            check_axes_are_free([cell], given, sink, instead=f"{verb} without `--pick`")
        run.check()
        return cell

    def values(self, recipe: Path, given: dict[str, Node], run: Run, verb: str) -> tuple[dict[str, Node], int]:
        cell = self.chosen(recipe, given, run=run, verb=verb)
        return (given, self.sample or 0) if cell is None else ({**given, **cell.given}, cell.sample)


class CellsOptions(Group):
    """The choice of several cells and samples; without a choice, a command is about one model."""

    heading: ClassVar[str] = "Model"
    every: bool = flag("--all", help="Select every cell of the recipe's matrix, and every sample.")
    picks: tuple[str, ...] = option(
        "--pick",
        multiple=True,
        metavar="CELL",
        shell_complete=completion.cells,
        help="Select this cell of the matrix or this sample. AXIS=VALUE[,AXIS=VALUE...] selects all cells with these"
        " values.",
    )
    only_samples: tuple[int, ...] = option(
        "--sample",
        multiple=True,
        type=click.IntRange(min=0),
        metavar="NUMBER",
        shell_complete=completion.samples,
        help="Select only this sample, in all cells or in the cells of --pick. Sample 0 is the model without draws.",
    )

    @property
    def one(self) -> bool:
        return not self.every and not self.picks and not self.only_samples

    def chosen(
        self, recipe: Path, given: dict[str, Node], context: Context, verb: str, *, worlds: bool = False
    ) -> tuple[list[Cell], int]:
        """Return the selected cells (none if the recipe is one model), and the exit code (0 without errors)."""
        from mjcompose.pipeline.cache.cells import cells_of, check_axes_are_free, of_samples, select_cells

        sink = context.sink
        every = cells_of(recipe, context, given, worlds=worlds)
        if sink.has_errors:
            return [], exit_code(context.folder, [recipe])
        if not every and (self.picks or self.only_samples):
            sink.error(
                "missing-key",
                f"`{recipe}` has neither `matrix` nor `randomize`: it is one model",
                help=f"{verb} it without `--pick` and `--sample`",
            )
        chosen = every
        if self.picks and every:
            chosen = select_cells(every, self.picks, sink, recipe=str(recipe))
        if self.only_samples:
            chosen = of_samples(chosen, self.only_samples, sink)
        check_axes_are_free(chosen, given, sink, instead=f"{verb} without `--all` and `--pick`")
        return chosen, USAGE if sink.has_errors else 0


class Shard(Struct):
    """The shard with this `number`, from 1, of `count` shards."""

    number: int
    count: int

    def of(self, items: Sequence[Item]) -> list[Item]:
        """Return every `count`-th item, because neighbors often take equally long."""
        return list(items[self.number - 1 :: self.count])

    def file(self, name: str) -> str:
        """Return the name of a file that each shard has separately."""
        path = PurePosixPath(name)
        return f"{path.stem}-{self.number}-of-{self.count}{path.suffix}"


def _shard(ctx: click.Context, option: click.Parameter, text: str | None) -> Shard | None:
    if text is None:
        return None
    first, slash, last = text.partition("/")
    if slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last):
        return Shard(int(first), int(last))
    message = f"`{text}` is not I/N with I from 1 to N: write for instance `1/8`, and `8/8` for the last."
    raise click.BadParameter(message)


JOBS = option(
    "--jobs",
    "-j",
    type=click.IntRange(min=1),
    metavar="NUMBER",
    envvar="MJCOMPOSE_JOBS",
    help="The number of processes. Default: MJCOMPOSE_JOBS, or one for each core if there are enough cells.",
)


class WorkerOptions(Group):
    heading: ClassVar[str] = "Workers"
    jobs: int | None = JOBS
    cluster: str | None = option(
        "--cluster",
        metavar="ADDRESS|FILE|local",
        help="Use the workers of a Dask cluster: tls://HOST:PORT, its scheduler file, or `local` to start one on this"
        " machine. Needs the extra `cluster`.",
    )
    shard: Shard | None = option(
        "--shard",
        callback=_shard,
        metavar="I/N",
        help="Process only the I-th of N parts of the cells, from 1/N to N/N, to divide them among the jobs of a"
        " cluster or CI system. All parts can be written to one folder.",
    )

    @contextmanager
    def started(self, out: Location | None = None, away: Finish | None = None) -> Iterator[Crew | None]:
        """Yield the workers of `--cluster`, which write below `out`, or elsewhere with `away`, or None."""
        if self.cluster is None:
            yield None
            return
        from mjcompose.base.processes import cores
        from mjcompose.tools.cluster.client import Crew

        def tell(message: str) -> None:
            if not is_quiet():
                say(message, err=True)

        with Crew(self.cluster, self.jobs or cores(), out, tell=tell, away=away) as crew:
            yield crew


class ModelOptions(Group):
    """The groups of a command about one model of a recipe, which its class of options inherits."""

    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    fetching: FetchOptions = group(FetchOptions)
    limits: LimitOptions = group(LimitOptions)
    reporting: ReportOptions = group(ReportOptions)


class BuildingOptions(Group):
    """The options of `build` and `check`, which make the models of a recipe."""

    choices: Choices = group(Choices)
    cells: CellsOptions = group(CellsOptions)
    workers: WorkerOptions = group(WorkerOptions)
    limits: TimeOptions = group(TimeOptions)
    no_cache: bool = NO_CACHE
    fetching: FetchOptions = group(FetchOptions)
    strict: bool = STRICT
    verbose: bool = options.VERBOSE
    reporting: ReportOptions = group(ReportOptions)
    watch: bool = options.WATCH


def check_several(one: bool, *, jobs: int | None, shard: Shard | None = None, cluster: str | None = None) -> None:
    """Raise a usage error if options for several models are given for one, which cannot be split."""
    for name, given in (("--shard", shard), ("--jobs", jobs), ("--cluster", cluster)):
        if one and given is not None and _is_written(name):
            raise click.UsageError(f"{name} needs --all, --pick or --sample: this is one model.")
    if cluster is not None and cluster != "local" and _is_written("--jobs"):
        raise click.UsageError("--jobs needs --cluster local: another cluster has its own workers.")


def check_readers(recipe: Path, cluster: str | None) -> None:
    """Raise a usage error if other machines would have to read standard input."""
    if cluster is not None and recipe.name == STDIN:
        raise click.UsageError("--cluster needs a file: its workers cannot read standard input.")


def _is_written(option: str) -> bool:
    return click.get_current_context().get_parameter_source(option[2:]) is ParameterSource.COMMANDLINE


class FullError(DiagnosticError):
    """No more models can be written, so making more is useless."""


def found_no_room(result: CellResult) -> bool:
    """Return whether there was no room for a model, according to its diagnostics."""
    return any(each.code == "output-full" for each in result.diagnostics)


@contextmanager
def stopped(context: Context) -> Iterator[list[Diagnostic]]:
    """End the block if the workers are lost or a disk is full. The reason is reported and in the yielded list."""
    found: list[Diagnostic] = []
    try:
        yield found
    except FullError as error:
        found.append(error.diagnostic)
    except DiagnosticError as error:
        context.sink.add(error.diagnostic)
        found.append(error.diagnostic)


_EVERY = 10.0
_WIDTH = 20


def counting(items: Iterable[Item], total: int, name: Callable[[Item], str]) -> Iterator[Item]:
    """Yield the items; show a bar, their count, the rate and the name of the last one on standard error."""
    if is_quiet():
        yield from items
        return
    start = shown = time.monotonic()
    terminal = on_terminal()
    for done, item in enumerate(items, 1):
        if terminal:
            click.echo("\r\x1b[K", err=True, nl=False)
        yield item
        now = time.monotonic()
        if terminal or now - shown >= _EVERY:
            shown = now
            line = f"{done}/{total} {done / max(now - start, 1e-9):.1f}/s {text.printable(text.one_line(name(item)))}"
            bar = f"[{'#' * (_WIDTH * done // total):{_WIDTH}}]"
            click.echo(f"{bar} {line}" if terminal else line, err=True, nl=not terminal)
    if terminal:
        click.echo("\r\x1b[K", err=True, nl=False)


class Tally(Struct, frozen=False):
    """Counts the cells of a run: `total` is their number, and `whole` is the number of cells without errors."""

    recipe: Path
    total: int
    whole: int = 0
    failed: list[CellName] = field(default_factory=list)

    def take(self, cell: CellName, found: Iterable[Diagnostic], sink: Sink, *, failed: bool) -> None:
        for diagnostic in found:
            sink.add_of_cell(cell, diagnostic)
        if failed:
            self.failed.append(cell)
        else:
            self.whole += 1

    def say(self, form: str, *, err: bool = False) -> None:
        """Print the tally: always in JSON, else only if a cell failed."""
        words = f"{len(self.failed)} of {self.total} cells failed: {listed(self.failed)}"
        if form == "json":
            failed = [asdict(each) for each in self.failed]
            words = text.json_text({"recipe": str(self.recipe), "cells": self.total, "failed": failed})
        elif form == "github":
            words = text.command("error", words, {"title": str(self.recipe)})
        else:
            words = text.printable(words)
        if self.failed or form == "json":
            click.echo(words, err=err or form == "text")

"""The options that select cells of a recipe's matrix and samples, and the selected cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from composer.cli import completing
from composer.cli.reporting import USAGE, exit_code
from composer.cli.shard import Shard

if TYPE_CHECKING:
    from pathlib import Path

    from composer.context import Context
    from composer.document import Node
    from composer.expand.matrix import Cell


def cells_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--all`, `--pick` and `--sample`; the command gets them as `every`, `picks` and `only_samples`."""
    for option in reversed((
        click.option("--all", "every", is_flag=True,
                     help="Select every cell of the recipe's matrix, and every sample."),
        click.option("--pick", "picks", multiple=True, metavar="CELL", shell_complete=completing.cells,
                     help="Select this cell of the matrix or this sample, or with AXIS=VALUE[,AXIS=VALUE...] all cells"
                          " that have these values."),
        click.option("--sample", "only_samples", multiple=True, type=click.IntRange(min=0), metavar="NUMBER",
                     shell_complete=completing.samples,
                     help="Select only this sample, of all cells or of those of --pick. 0 is the model without draws."),
    )):  # fmt: skip
        command = option(command)
    return command


def jobs_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--jobs`, `--cluster` and `--shard`; the command gets them as `jobs`, `cluster` and `shard`."""
    sharded = click.option("--shard", callback=_shard, metavar="I/N",
                           help="Process only the I-th of N parts of the cells, from 1/N to N/N, to divide them among"
                           " the jobs of a cluster or CI system. All parts can be written to one folder."
                           )(command)  # fmt: skip
    sharded = click.option("--cluster", metavar="ADDRESS|FILE|local", help="Use the workers of a Dask cluster:"
                           " tls://HOST:PORT, its scheduler file, or `local` to start one on this machine. Needs the"
                           " extra `cluster`.")(sharded)  # fmt: skip
    return jobs_option(sharded)


def jobs_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--jobs`; the command gets it as `jobs`."""
    return click.option("--jobs", "-j", type=click.IntRange(min=1), metavar="NUMBER", envvar="MJCOMPOSE_JOBS",
                        help="The number of processes. Default: MJCOMPOSE_JOBS, or one for each core if there are"
                        " enough cells.")(command)  # fmt: skip


def _shard(ctx: click.Context, option: click.Parameter, text: str | None) -> Shard | None:
    if text is None:
        return None
    first, slash, last = text.partition("/")
    if slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last):
        return Shard(int(first), int(last))
    message = f"`{text}` is not I/N with I from 1 to N: write for instance `1/8`, and `8/8` for the last."
    raise click.BadParameter(message)


def check_several(
    one: bool, *, jobs: int | None, shard: Shard | None = None, cluster: str | None = None
) -> None:
    """Raise a usage error if options for several models are given for one, which cannot be split."""
    for option, given in (("--shard", shard), ("--jobs", jobs), ("--cluster", cluster)):
        if one and given is not None and _is_written(option):
            raise click.UsageError(f"{option} is for --all, --pick and --sample: here is one model.")
    if cluster is not None and cluster != "local" and _is_written("--jobs"):
        raise click.UsageError("--jobs is for --cluster local: another cluster has the workers that it has.")


def _is_written(option: str) -> bool:
    return click.get_current_context().get_parameter_source(option[2:]) is ParameterSource.COMMANDLINE


def pick_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--pick` for a command about one model; the command gets `pick`."""
    return click.option("--pick", metavar="CELL", shell_complete=completing.cells,
                        help="Select this cell of the matrix, this sample, or AXIS=VALUE[,...].")(command)  # fmt: skip


def cell_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--pick` and `--sample` for a command about one model; the command gets `pick` and `sample`."""
    numbered = click.option("--sample", type=click.IntRange(min=0), metavar="NUMBER",
                     shell_complete=completing.samples,
                            help="Select this sample of the recipe's draws. 0, the default, has no draws.")  # fmt: skip
    return pick_option(numbered(command))


def chosen_cells(
    recipe: Path,
    picks: Sequence[str],
    samples: Sequence[int],
    given: dict[str, Node],
    context: Context,
    verb: str,
) -> tuple[list[Cell], int]:
    """Return the selected cells, none if the recipe is one model, and the exit code, 0 without errors.

    Errors go to the context's sink.
    """
    from composer.cache.cells import cells_of, check_axes_are_free, of_samples, picked

    every = cells_of(recipe, context, given)
    if context.sink.has_errors:
        return [], exit_code(context.folder, [recipe])
    if not every and (picks or samples):
        context.sink.error("missing-key", f"`{recipe}` has neither `matrix` nor `randomize`: it is one model",
                           help=f"{verb} it without `--pick` and `--sample`")  # fmt: skip
    chosen = picked(every, picks, context.sink, recipe=str(recipe)) if picks and every else every
    if samples:
        chosen = of_samples(chosen, samples, context.sink)
    check_axes_are_free(chosen, given, context.sink, instead=f"{verb} without `--all` and `--pick`")
    return chosen, USAGE if context.sink.has_errors else 0


def chosen_cell(
    recipe: Path, pick: str, sample: int | None, given: dict[str, Node], context: Context, verb: str
) -> tuple[Cell | None, int]:
    """Return the one selected cell, or None if there is none, and the exit code, 0 without errors.

    Errors go to the context's sink.
    """
    from composer.cache.cells import cells_of, check_axes_are_free, picked_one

    every = cells_of(recipe, context, given)
    if context.sink.has_errors:
        return None, exit_code(context.folder, [recipe])
    cell = picked_one(every, pick, sample, sink=context.sink, recipe=str(recipe))
    if cell is not None:
        check_axes_are_free([cell], given, context.sink, instead=f"{verb} without `--pick`")
    return (None, USAGE) if context.sink.has_errors else (cell, 0)

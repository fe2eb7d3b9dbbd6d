"""Options that several commands have."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from mjcompose.base.dataclass import dataclass
from mjcompose.base.limits import NAMES, allow, read
from mjcompose.cli import completing
from mjcompose.cli.process import LEAST, bound
from mjcompose.cli.reporting import USAGE, exit_code, progress
from mjcompose.cli.run import PATH, Run, Stop, argument, flag, group, option
from mjcompose.targets.names import MUJOCO
from mjcompose.targets.names import NAMES as TARGETS_NAMES

if TYPE_CHECKING:
    from mjcompose.build.cache.cache import Cache
    from mjcompose.language.expand import Cell
    from mjcompose.sources.context import Context
    from mjcompose.sources.fetching import Fetching
    from mjcompose.text.node import Node


class Amount(click.FloatRange):
    """A range of floats without `nan`, which comparisons never find out of range, and without `inf`."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


def formats(*names: str) -> Any:
    """Declare `--format` with these values."""
    return option("--format", type=click.Choice(names), default="text", show_default=True,
                  help="How the output is printed.")  # fmt: skip


def output(help: str) -> Any:
    """Declare `--output`; the field is called `out`, and is None without the option."""
    return option("-o", "--output", metavar="OUT", help=help)


JSON = flag("--json", help="The same as --format json.")
QUIET = flag("-q", "--quiet", help="Print only errors and warnings.")
VERBOSE = flag("-v", "--verbose", help="Also print how long each stage took, and which files were read.")
STRICT = flag("--strict", help="Treat warnings as errors, except those that the recipe allows.")
NO_CACHE = flag("--no-cache", help="Do not read models from the build cache or store them in it.")
RECIPE = argument(type=PATH)
JOBS = option("--jobs", "-j", type=click.IntRange(min=1), metavar="NUMBER", envvar="MJCOMPOSE_JOBS",
              help="The number of processes. Default: MJCOMPOSE_JOBS, or one for each core if there are enough"
              " cells.")  # fmt: skip


@dataclass(frozen=True, slots=True)
class ReportOptions:
    """How the output is printed; `Run.form` has the format, and `reporting.is_quiet` the last."""

    form: str = formats("text", "json", "github")
    json: bool = JSON
    quiet: bool = QUIET


@dataclass(frozen=True, slots=True)
class FetchOptions:
    """How models are fetched; `Run.context` has it."""

    locked: bool = flag("--locked", help="Fail if the lock file is missing or outdated.")
    offline: bool = flag(
        "--offline", help="Fetch nothing. Use the locked or last fetched sources in the store."
    )
    frozen: bool = flag("--frozen", help="The same as --locked --offline.")


def caching_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--no-cache` and `--why`; the command gets them as `no_cache` and `why`."""
    command = click.option(
        "--why", is_flag=True, help="Print why a model was built, or why it was taken from the cache."
    )(command)
    return no_cache_option(command)


def no_cache_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--no-cache`; the command gets it as `no_cache`."""
    return click.option(
        "--no-cache", is_flag=True, help="Do not read models from the build cache or store them in it."
    )(command)


@contextlib.contextmanager
def caching(context: Context, no_cache: bool) -> Iterator[Cache | None]:
    """Yield the user's build cache inside the block, or None if it is disabled or unusable."""
    cache = None if no_cache else _cache(context)
    try:
        yield cache
    finally:
        if cache is not None:
            cache.close()


def _cache(context: Context) -> Cache | None:
    from mjcompose.build.cache.cache import open_cache
    from mjcompose.sources.reference import SourceError
    from mjcompose.sources.store import Store

    try:
        return open_cache(Store.of(context.environment), context.sink)
    except SourceError as error:
        context.sink.warning(error.code, error.message, help=error.help)
        return None


@dataclass(frozen=True, slots=True)
class Choices:
    """The values of `--set`, `--set-file` and `--variant`."""

    sets: tuple[str, ...] = option("--set", multiple=True, metavar="NAME=VALUE", help="Set the value of a parameter.",
                                   shell_complete=completing.parameters)  # fmt: skip
    set_files: tuple[Path, ...] = option(
        "--set-file", multiple=True, type=PATH, metavar="FILE",
        help="Read the values of parameters and variants from this YAML file.",
    )  # fmt: skip
    variants: tuple[str, ...] = option("--variant", multiple=True, metavar="AXIS=VALUE", help="Select the value of a"
                                       " variant.", shell_complete=completing.variants)  # fmt: skip
    _read: dict[Path, bytes] = field(default_factory=dict, compare=False, repr=False)

    def given(self, run: Run) -> dict[str, Node]:
        """Return the values by name, or end the command if one is wrong."""
        given = self.values(run.context)
        run.check()
        return given

    def values(self, context: Context) -> dict[str, Node]:
        """Return the values by name, with options overriding files; errors go to the context's sink."""
        found: dict[str, Node] = {}
        if not (self.sets or self.set_files or self.variants):
            return found  # without importing anything
        from mjcompose.base.diagnostic import Span
        from mjcompose.text.load import load
        from mjcompose.text.node import Mapping, Scalar

        for file in self.set_files:
            shown = context.shown(file)
            try:
                text = self._text(file, context)
            except OSError as error:
                reason = (error.strerror or str(error)).lower()
                context.sink.error("file-unreadable", f"`{shown}` cannot be read: {reason}")
                continue
            node = load(text, shown, context.sink)
            if isinstance(node, Mapping):
                found.update({name: value for name, (_, value) in node.entries.items()})
            elif node is not None:
                context.sink.error(
                    "wrong-type", "a file of values is a mapping from names to values", node.span
                )
        for name_of_option, written in [("--set", each) for each in self.sets] + [
            ("--variant", each) for each in self.variants
        ]:
            name, equals, text_of_value = written.partition("=")
            if not equals or not name:
                context.sink.error("wrong-type", f"`{name_of_option} {written}` is not NAME=VALUE",
                                   help=f"write for instance `{name_of_option} {name or 'reach'}=0.5`")  # fmt: skip
                continue
            span = Span(f"{name_of_option} {name}", 1, 1)
            if name_of_option == "--variant" or not text_of_value:
                found[name] = Scalar(text_of_value, span, text_of_value, plain=False)
            elif (value := load(text_of_value, span.file, context.sink)) is not None:
                found[name] = value
        return found

    def _text(self, file: Path, context: Context) -> bytes:
        """Return the bytes of a file, which is read once: it may be a pipe. Raises OSError."""
        if file not in self._read:
            from mjcompose.base.files import read_argument
            from mjcompose.base.limits import in_force

            self._read[file] = read_argument(context.folder / file, in_force().recipe_size)
        return self._read[file]

    def named(self, context: Context) -> dict[str, str]:
        """Return the values as text, by their names for the user, for comparison in the build cache.

        Nothing is validated.
        """
        from mjcompose.build.cache.cache_key import content_of, name_of

        found: dict[str, str] = {}
        for file in self.set_files:
            content = "unreadable"
            with contextlib.suppress(OSError):
                content = content_of(self._text(file, context))
            found[name_of(file)] = content
        if len(self.set_files) > 1:  # a value of a later file counts
            found["the order of `--set-file`"] = ", ".join(map(str, self.set_files))
        for what, written in [
            *(("", each) for each in self.sets),
            *(("variant ", each) for each in self.variants),
        ]:
            name, equals, value = written.partition("=")
            found[f"{what}`{name}`"] = value if equals else "nothing"
        return found


def choice_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--set`, `--set-file` and `--variant`; the command gets them as `choices`."""

    @functools.wraps(command)
    def choosing(
        *args: Any, sets: tuple[str, ...], set_files: tuple[Path, ...], variants: tuple[str, ...], **rest: Any
    ) -> Any:
        return command(*args, choices=Choices(sets, set_files, variants), **rest)

    for each in reversed((
        click.option("--set", "sets", multiple=True, metavar="NAME=VALUE", help="Set the value of a parameter.",
                     shell_complete=completing.parameters),
        click.option("--set-file", "set_files", multiple=True, type=click.Path(path_type=Path), metavar="FILE",
                     help="Read the values of parameters and variants from this YAML file."),
        click.option("--variant", "variants", multiple=True, metavar="AXIS=VALUE",
                     help="Select the value of a variant.",
                     shell_complete=completing.variants),
    )):  # fmt: skip
        choosing = each(choosing)
    return choosing


_LOCKED, _OFFLINE = "mjcompose.locked", "mjcompose.offline"


def fetching_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--locked`, `--offline`, and `--frozen` for both. They are not arguments of the command: see `fetching`."""
    for name, said, *asked in (
        ("--frozen", "The same as --locked --offline.", _LOCKED, _OFFLINE),
        ("--offline", "Fetch nothing. Use the locked or last fetched sources in the store.", _OFFLINE),
        ("--locked", "Fail if the lock file is missing or outdated.", _LOCKED),
    ):
        command = click.option(name, is_flag=True, expose_value=False, help=said, callback=_noting(asked))(
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
    from mjcompose.sources.fetching import Fetching

    known = click.get_current_context().meta
    return Fetching(locked=_LOCKED in known, offline=_OFFLINE in known, progress=_of_this_command())


def _of_this_command() -> Callable[[str], None]:
    """Return a progress function for this command that other threads can call, which lack click's context."""
    context = click.get_current_context()

    def report(message: str) -> None:
        with context.scope(cleanup=False):
            progress(message)

    return report


_EXAMPLES = {"bytes": "2G", "seconds": "600", "": "50000"}


def limit_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--limit NAME=VALUE`, which is no argument of the command: see `mjcompose.base.limits.in_force`."""
    return click.option("--limit", multiple=True, metavar="NAME=VALUE", expose_value=False, callback=_limits,
                        shell_complete=completing.limits,
                        help="Change a limit, for example expansion=50000.")(command)  # fmt: skip


def timeout_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--timeout`, which is short for `--limit time=`, and `--limit` itself."""
    return limit_option(
        click.option("--timeout", type=Amount(min=0, min_open=True), default=None, expose_value=False,
                     callback=_time, metavar="SECONDS",
                     help="The most time that MuJoCo may take for a model; the same as --limit time=SECONDS."
                          "  [default: 300]")(
            command)
    )  # fmt: skip


def _limits(ctx: click.Context, parameter: click.Parameter, given: tuple[str, ...]) -> None:
    for each in given:
        name, _, text = each.partition("=")
        if name not in NAMES:
            from mjcompose.base.suggest import closest

            near = closest(name, NAMES)
            meant = f" Did you mean `{near[0]}`?" if near else f" There are: {', '.join(NAMES)}."
            raise click.BadParameter(f"the limit `{name}` does not exist.{meant}", ctx, parameter)
        value = read(name, text)
        if value is None:
            example = _EXAMPLES[NAMES[name].metadata["unit"]]
            raise click.BadParameter(f"`{each}` gives no value: write `{name}={example}`.", ctx, parameter)
        if name == "memory" and value < LEAST:
            raise click.BadParameter(
                f"`{each}` is not enough: a build needs at least {LEAST >> 20}M.", ctx, parameter
            )
        ctx.with_resource(allow(**{NAMES[name].name: value}))
        if name == "memory":
            bound(int(value))


def _time(ctx: click.Context, parameter: click.Parameter, given: float | None) -> None:
    if given is not None:
        ctx.with_resource(allow(time=given))


@dataclass(frozen=True, slots=True)
class LimitOptions:
    """Limits of a run, which are in force as soon as they are read: see `mjcompose.base.limits.in_force`."""

    limit: None = option("--limit", multiple=True, metavar="NAME=VALUE", callback=_limits,
                         shell_complete=completing.limits,
                         help="Change a limit, for example expansion=50000.")  # fmt: skip


@dataclass(frozen=True, slots=True)
class TimeOptions:
    """The limits of a command that runs MuJoCo: `--timeout` is short for `--limit time=`."""

    limits: LimitOptions = group(LimitOptions)
    timeout: None = option("--timeout", type=Amount(min=0, min_open=True), callback=_time, metavar="SECONDS",
                           help="The most time that MuJoCo may take for a model; the same as --limit time=SECONDS."
                                "  [default: 300]")  # fmt: skip


def output_option(help: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the option; the command gets it as `out`, None if it is not given."""
    return click.option("-o", "--output", "out", metavar="OUT", help=help)


Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Shard:
    """The shard with this `number`, from 1, of `count` shards."""

    number: int
    count: int

    def of(self, items: Sequence[Item]) -> list[Item]:
        """Return every `count`-th item, because neighbours often take equally long.

        >>> Shard(1, 3).of("abcdefg"), Shard(3, 3).of("abcdefg"), Shard(3, 3).of("a")
        (['a', 'd', 'g'], ['c', 'f'], [])
        """
        return list(items[self.number - 1 :: self.count])

    def file(self, name: str) -> str:
        """Return the name of a file that each shard has separately.

        >>> Shard(1, 3).file("samples.csv")
        'samples-1-of-3.csv'
        """
        path = PurePosixPath(name)
        return f"{path.stem}-{self.number}-of-{self.count}{path.suffix}"


def cells_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--all`, `--pick` and `--sample`; the command gets them as `every`, `picks` and `only_samples`."""
    for each in reversed((
        click.option("--all", "every", is_flag=True,
                     help="Select every cell of the recipe's matrix, and every sample."),
        click.option("--pick", "picks", multiple=True, metavar="CELL", shell_complete=completing.cells,
                     help="Select this cell of the matrix or this sample, or with AXIS=VALUE[,AXIS=VALUE...] all cells"
                          " that have these values."),
        click.option("--sample", "only_samples", multiple=True, type=click.IntRange(min=0), metavar="NUMBER",
                     shell_complete=completing.samples,
                     help="Select only this sample, of all cells or of those of --pick. 0 is the model without draws."),
    )):  # fmt: skip
        command = each(command)
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
    for name, given in (("--shard", shard), ("--jobs", jobs), ("--cluster", cluster)):
        if one and given is not None and _is_written(name):
            raise click.UsageError(f"{name} is for --all, --pick and --sample: here is one model.")
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


@dataclass(frozen=True, slots=True)
class CellOptions:
    """The choice of one cell or sample."""

    pick: str | None = option("--pick", metavar="CELL", shell_complete=completing.cells,
                              help="Select this cell of the matrix, this sample, or AXIS=VALUE[,...].")  # fmt: skip
    sample: int | None = option("--sample", type=click.IntRange(min=0), metavar="NUMBER",
                                shell_complete=completing.samples,
                                help="Select this sample of the recipe's draws. 0, the default, has no"
                                " draws.")  # fmt: skip

    def check(self, model: str | Path, *, is_recipe: bool) -> None:
        """Raise UsageError if a cell of something else than a recipe is chosen."""
        if self.pick is not None and not is_recipe:
            raise click.UsageError(f"{model} is not a recipe and has no cells: leave --pick out")

    def chosen(self, recipe: Path, given: dict[str, Node], run: Run, verb: str) -> Cell | None:
        """Return the cell of `--pick`, or None without that; if there is no such cell, end the command."""
        if self.pick is None:
            return None
        cell, code = chosen_cell(recipe, self.pick, self.sample, given=given, context=run.context, verb=verb)
        if cell is None:
            raise Stop(code)
        return cell

    def values(
        self, recipe: Path, given: dict[str, Node], run: Run, verb: str
    ) -> tuple[dict[str, Node], int]:
        """Return the values with those of the chosen cell, and the number of the sample."""
        cell = self.chosen(recipe, given, run=run, verb=verb)
        return (given, self.sample or 0) if cell is None else ({**given, **cell.given}, cell.sample)


@dataclass(frozen=True, slots=True)
class CellsOptions:
    """The choice of several cells and samples; without any, a command is about one model."""

    every: bool = flag("--all", help="Select every cell of the recipe's matrix, and every sample.")
    picks: tuple[str, ...] = option("--pick", multiple=True, metavar="CELL", shell_complete=completing.cells,
                                    help="Select this cell of the matrix or this sample, or with AXIS=VALUE"
                                    "[,AXIS=VALUE...] all cells that have these values.")  # fmt: skip
    only_samples: tuple[int, ...] = option("--sample", multiple=True, type=click.IntRange(min=0), metavar="NUMBER",
                                           shell_complete=completing.samples, help="Select only this sample, of all"
                                           " cells or of those of --pick. 0 is the model without draws.")  # fmt: skip

    @property
    def one(self) -> bool:
        return not self.every and not self.picks and not self.only_samples

    def chosen(
        self, recipe: Path, given: dict[str, Node], context: Context, verb: str, *, worlds: bool = False
    ) -> tuple[list[Cell], int]:
        """Return the selected cells, none if the recipe is one model, and the exit code, 0 without errors.

        Errors go to the context's sink.
        """
        return chosen_cells(
            recipe, self.picks, self.only_samples, given=given, context=context, verb=verb, worlds=worlds
        )


def chosen_cells(
    recipe: Path,
    picks: Sequence[str],
    samples: Sequence[int],
    given: dict[str, Node],
    context: Context,
    verb: str,
    worlds: bool = False,
) -> tuple[list[Cell], int]:
    """Return the selected cells, none if the recipe is one model, and the exit code, 0 without errors.

    Errors go to the context's sink.
    """
    from mjcompose.build.cache.cells import cells_of, check_axes_are_free, of_samples, select_cells

    every = cells_of(recipe, context, given, worlds=worlds)
    if context.sink.has_errors:
        return [], exit_code(context.folder, [recipe])
    if not every and (picks or samples):
        context.sink.error("missing-key", f"`{recipe}` has neither `matrix` nor `randomize`: it is one model",
                           help=f"{verb} it without `--pick` and `--sample`")  # fmt: skip
    chosen = select_cells(every, picks, context.sink, recipe=str(recipe)) if picks and every else every
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
    from mjcompose.build.cache.cells import cells_of, check_axes_are_free, select_cell

    every = cells_of(recipe, context, given)
    if context.sink.has_errors:
        return None, exit_code(context.folder, [recipe])
    cell = select_cell(every, pick, sample, sink=context.sink, recipe=str(recipe))
    if cell is not None:
        check_axes_are_free([cell], given, context.sink, instead=f"{verb} without `--pick`")
    return (None, USAGE) if context.sink.has_errors else (cell, 0)


class _Target(click.Choice):  # type: ignore[type-arg]  # before click 8.2 it is not generic
    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value in self.choices:
            return str(value)
        from mjcompose.base.extensions import is_registered
        from mjcompose.base.suggest import closest

        if is_registered("targets", value):
            return str(value)

        near = closest(value, self.choices)
        hint = f" Did you mean `{near[0]}`?" if near else ""
        message = f"the target `{value}` does not exist.{hint} Targets: {', '.join(self.choices)}."
        raise click.BadParameter(message, ctx, param)


target_option = click.option(
    "--target",
    type=_Target(TARGETS_NAMES),
    callback=lambda context, option, value: None if value == MUJOCO else value,
    help="The program to write the model for. What it does not support is reported. Default: mujoco.",
)

_MORE = {"isaac": ("usd",)}
"""Other kinds of output that a target reads: Isaac Sim opens USD without its importer."""


def check_target(target: str | None, kind: str, *, is_verified: bool) -> None:
    """Refuse an output form that a target does not support. Raises OutputError."""
    from mjcompose.build.bundle.bundle import OutputError

    if target is None:
        return
    if kind not in ("folder", "archive", *_MORE.get(target, ())):
        help = f"write a folder, `--target {target} -o build/{target}/`, or an archive"
        raise OutputError(
            "output-kind", f"a model for `{target}` is several files, and the output is one", help
        )
    if not is_verified:
        help = "leave `--no-verify` out"
        raise OutputError("output-kind", "`--target` is made of the compiled model", help)

"""Options that several commands have."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import click

from mjcompose.base.diagnostic import Span
from mjcompose.base.files import read_argument
from mjcompose.base.limits import NAMES, allow, in_force, read
from mjcompose.base.suggest import closest
from mjcompose.cli import completion
from mjcompose.cli.entry import LEAST, bound
from mjcompose.cli.run import PATH, RECIPE_PATH, Group, Run, argument, flag, group, option
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.pipeline.cache.cache import Cache
    from mjcompose.text.node import Node


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return the question to add to a message of Click about an unknown name, or `otherwise`, after a space."""
    near = closest(name, known)
    return f" Did you mean `{near[0]}`?" if near else otherwise


class Amount(click.FloatRange):
    """A range of floats without `inf`, and without `nan`, which comparisons never find out of range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


def formats(*names: str) -> Any:
    help = "The format of the output."
    return option("--output-format", type=click.Choice(names), default="text", show_default=True, help=help)


def output(help: str) -> Any:
    """Declare `--output`; the field is called `out`, and is None without the option."""
    return option("-o", "--output", metavar="OUT", help=help)


QUIET = flag("-q", "--quiet", help="Print only errors and warnings.")
VERBOSE = flag("-v", "--verbose", help="Also print how long each stage took, and which files were read.")
STRICT = flag("--strict", help="Treat warnings as errors, except those that the recipe allows.")
NO_CACHE = flag("--no-cache", help="Do not read models from the build cache or store them in it.")
WATCH = flag("--watch", help="Run again whenever a file that was read changes. Stop with Ctrl-C.")
RECIPE = argument(type=PATH)
RECIPE_OR_STDIN = argument(type=RECIPE_PATH)


FORMATS = ("text", "json", "github", "junit", "sarif", "markdown")


class ReportOptions(Group):
    """The format and amount of output: `Run.form`, and `reporting.is_quiet`."""

    heading: ClassVar[str] = "Output"
    form: str = formats(*FORMATS)
    quiet: bool = QUIET


class FetchOptions(Group):
    """The rules for fetching; `Run.context` has them."""

    heading: ClassVar[str] = "Sources"
    locked: bool = flag("--locked", help="Fail if the lock file is missing or outdated.")
    offline: bool = flag("--offline", help="Fetch nothing. Use the locked or last fetched sources in the store.")
    frozen: bool = flag("--frozen", help="The same as --locked --offline.")


@contextlib.contextmanager
def caching(context: Context, no_cache: bool) -> Iterator[Cache | None]:
    """Yield the user's build cache inside the block, or None if it is disabled or unusable."""
    cache = None
    if not no_cache:
        from mjcompose.pipeline.cache.cache import open_cache
        from mjcompose.sources.reference import SourceError
        from mjcompose.sources.store import Store

        try:
            cache = open_cache(Store.of(context.environment), context.sink)
        except SourceError as error:
            context.sink.warning(error.code, error.message, help=error.help)
    try:
        yield cache
    finally:
        if cache is not None:
            cache.close()


class ParameterFile(NamedTuple):
    """A file of `--set-file`, and the parameter whose value it has; None if it has names of its own."""

    name: str | None
    file: Path


class Choices(Group):
    """The values of `--set` and `--set-file`: parameters and variants."""

    heading: ClassVar[str] = "Model"
    sets: tuple[str, ...] = option(
        "--set",
        multiple=True,
        metavar="NAME=VALUE",
        help="Set the value of a parameter or variant.",
        shell_complete=completion.parameters,
    )
    set_files: tuple[Path, ...] = option(
        "--set-file",
        multiple=True,
        type=PATH,
        metavar="FILE",
        help="Read the values of parameters and variants from this YAML or JSON file. A CSV file is the table of the"
        " parameter with its name. NAME=FILE is the value of one parameter.",
    )
    _read: dict[Path, bytes] = field(default_factory=dict, compare=False, repr=False)

    def given(self, run: Run) -> dict[str, Node]:
        """Return the values by name, or end the command if one is wrong."""
        given = self.values(run.context)
        run.check()
        return given

    def values(self, context: Context) -> dict[str, Node]:
        """Return the values by name, with options overriding files. Report errors to the context."""
        found: dict[str, Node] = {}
        if not (self.sets or self.set_files):
            return found  # without importing anything
        from mjcompose.text.load import load
        from mjcompose.text.node import Scalar

        for named in self._files(context):
            found.update(self._values_of(named, context))
        for written in self.sets:
            name, equals, text_of_value = written.partition("=")
            if not equals or not name:
                context.sink.error(
                    "wrong-type",
                    f"`--set {written}` is not NAME=VALUE",
                    help=f"write for instance `--set {name or 'reach'}=0.5`",
                )
                continue
            span = Span(f"--set {name}", 1, 1)
            if not text_of_value:
                found[name] = Scalar(text_of_value, span, text_of_value, plain=False)
            elif (value := load(text_of_value, span.file, context.sink)) is not None:
                found[name] = value
        return found

    def _files(self, context: Context) -> Iterator[ParameterFile]:
        """Yield the files. `NAME=FILE` is a name and a file, unless there is a file with that whole name."""
        for file in self.set_files:
            name, equals, rest = str(file).partition("=")
            if equals and name.isidentifier() and not os.path.exists(context.folder / file):
                yield ParameterFile(name, Path(rest))
            else:
                yield ParameterFile(None, file)

    def files(self, context: Context) -> list[Path]:
        return [named.file for named in self._files(context)]

    def _values_of(self, named: ParameterFile, context: Context) -> dict[str, Node]:
        """Return the values of a file by name. Report errors to the context."""
        from mjcompose.text.load import load
        from mjcompose.text.node import Mapping
        from mjcompose.text.table import SUFFIX, load_table

        shown = context.shown(named.file)
        try:
            text = self._text(named.file, context)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            context.sink.error("file-unreadable", f"`{shown}` cannot be read: {reason}")
            return {}
        is_table = named.file.suffix.lower() == SUFFIX
        node = (load_table if is_table else load)(text, shown, context.sink)
        if node is None:
            return {}
        if named.name is not None or is_table:
            return {named.name or named.file.stem: node}
        if not isinstance(node, Mapping):
            context.sink.error("wrong-type", "a file of values must be a mapping from names to values", node.span)
            return {}
        return {name: value for name, (_, value) in node.entries.items()}

    def _text(self, file: Path, context: Context) -> bytes:
        if file not in self._read:
            self._read[file] = read_argument(context.folder / file, in_force().recipe_size)
        return self._read[file]

    def named(self, context: Context) -> dict[str, str]:
        """Return the values as unvalidated text, by their names for the user; the build cache compares them."""
        from mjcompose.pipeline.cache.cache_key import content_of, name_of

        found: dict[str, str] = {}
        for file, named in zip(self.set_files, self._files(context), strict=True):
            found[name_of(file)] = "unreadable"
            with contextlib.suppress(OSError):
                found[name_of(file)] = content_of(self._text(named.file, context))
        if len(self.set_files) > 1:  # a value of a later file counts
            found["the order of `--set-file`"] = ", ".join(map(str, self.set_files))
        for written in self.sets:
            name, equals, value = written.partition("=")
            found[f"`{name}`"] = value if equals else "nothing"
        return found


_EXAMPLES = {"bytes": "2G", "seconds": "600", "": "50000"}


def _limits(ctx: click.Context, parameter: click.Parameter, given: tuple[str, ...]) -> None:
    for each in given:
        name, _, text = each.partition("=")
        if name not in NAMES:
            hint = did_you_mean(name, NAMES, f" There are: {', '.join(NAMES)}.")
            raise click.BadParameter(f"the limit `{name}` does not exist.{hint}", ctx, parameter)
        value = read(name, text)
        if value is None:
            example = _EXAMPLES[NAMES[name].metadata["unit"]]
            raise click.BadParameter(f"`{each}` gives no value: write `{name}={example}`.", ctx, parameter)
        if name == "memory" and value < LEAST:
            raise click.BadParameter(f"`{each}` is not enough: a build needs at least {LEAST >> 20}M.", ctx, parameter)
        ctx.with_resource(allow(**{NAMES[name].name: value}))
        if name == "memory":
            bound(int(value))


class LimitOptions(Group):
    """The limits of a run, in force as soon as they are read: see `mjcompose.base.limits.in_force`."""

    heading: ClassVar[str] = "Limits"
    limit: None = option(
        "--limit",
        multiple=True,
        metavar="NAME=VALUE",
        callback=_limits,
        shell_complete=completion.limits,
        help="Change a limit, for example expansion=50000.",
    )


class TimeOptions(Group):
    """The limits of a command that runs MuJoCo: `--timeout` is short for `--limit time=`."""

    heading: ClassVar[str] = "Limits"
    limits: LimitOptions = group(LimitOptions)
    timeout: None = option(
        "--timeout",
        type=Amount(min=0, min_open=True),
        metavar="SECONDS",
        callback=lambda ctx, _, time: time and ctx.with_resource(allow(time=time)),
        help="The most time that MuJoCo may take for a model; the same as --limit time=SECONDS.  [default: 300]",
    )


class RecipeOptions(Group):
    """The groups of a command about a recipe. A class of options inherits them; its own options come first."""

    choices: Choices = group(Choices)
    fetching: FetchOptions = group(FetchOptions)
    limits: LimitOptions = group(LimitOptions)
    reporting: ReportOptions = group(ReportOptions)

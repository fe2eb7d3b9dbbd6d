"""The pipeline of all commands: options are one frozen object, and one place reports and exits.

A command is a class of options and a function of them and a `Run`; docs/contributing/extending.md shows one.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext, redirect_stdout
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.files import Mark, keep_stdin
from mjcompose.base.report import Suite, json_text, printable
from mjcompose.cli import reporting
from mjcompose.cli.reporting import DOCUMENTS, FINDINGS, FORM, USAGE, clear_progress, exit_code, is_quiet, report, say
from mjcompose.sources.blobs import let_go
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session

Options = TypeVar("Options")
Value = TypeVar("Value")
PATH = click.Path(path_type=Path)


class _RecipePath(click.Path):
    """A path; `-` is standard input, which is read at once."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return super().convert(keep_stdin() if value == "-" else value, param, ctx)


RECIPE_PATH = _RecipePath(path_type=Path)
_PATIENCE = 0.5


class _Declared(Struct):
    """The default of a field of options: a parameter for Click, or a class of options as a group of them."""

    of: Callable[..., click.Parameter] | type
    flags: tuple[str, ...] = ()
    attributes: Mapping[str, Any] | None = None


def argument(**attributes: Any) -> Any:
    """Declare a field as an argument of the command line. The attributes are those of `click.Argument`."""
    return _Declared(click.Argument, (), attributes)


def option(*flags: str, **attributes: Any) -> Any:
    """Declare a field as an option with these flags. The attributes are those of `click.Option`."""
    return _Declared(click.Option, flags, attributes)


def flag(*flags: str, help: str) -> Any:
    """Declare a field as an option without a value, which is true if it is given."""
    return _Declared(click.Option, flags, {"is_flag": True, "help": help})


def group(options: type) -> Any:
    """Declare a field as a group of options: an object of this class, with the group's `heading`."""
    return _Declared(options)


class Group(Struct):
    """The base of all classes of options."""


def command(
    options: type[Options], *, help: str, within: click.Group | None = None
) -> Callable[[Callable[[Options, Run], Answer | int | None]], click.Command]:
    """Return a decorator that makes a function a command with this help text.

    The function gets its options and a `Run`, and returns the `Answer` to print after the report, or the exit
    code, or None: the exit code is then 1 if there are errors. It may raise `Stop`.
    """

    def decorate(function: Callable[[Options, Run], Answer | int | None]) -> click.Command:
        def callback(**given: Any) -> None:
            context = click.get_current_context()
            chosen = _object(options, given)

            def once() -> int:
                return _ended(function, chosen, Run(context))

            if not given.get("watch"):
                sys.exit(once())
            recipes = [*_listed(given.get("recipe")), *_listed(given.get("recipes"))]
            named = [path for recipe in recipes for path in (recipe, recipe.with_suffix(".lock"))]
            sys.exit(_again_and_again(once, named))

        name = function.__name__.rstrip("_")
        make = click.command if within is None else within.command
        return make(name, cls=_Command, help=inspect.cleandoc(help), params=list(_parameters(options)))(callback)

    return decorate


class _Command(click.Command):
    """A command whose help lists its own options first, and then each group below the `heading` of its class."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        sections: dict[str, list[tuple[str, str]]] = {"Options": []}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx) if isinstance(parameter, click.Option) else None
            if record is not None:
                sections.setdefault(getattr(parameter, "heading", "Options"), []).append(record)
        width = max(len(flags) for records in sections.values() for flags, _ in records)
        for heading, records in sections.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl([(f"{flags:{min(width, 30)}}", help) for flags, help in records])


def _parameters(options: type, heading: str = "Options") -> Iterator[click.Parameter]:
    for name, declared in _declarations(options):
        if isinstance(declared.of, type) and not issubclass(declared.of, click.Parameter):
            yield from _parameters(declared.of, getattr(declared.of, "heading", heading))
        else:
            parameter = declared.of([*declared.flags, name], **declared.attributes or {})
            parameter.heading = heading  # type: ignore[attr-defined]
            yield parameter


def _object(options: type[Options], given: Mapping[str, Any]) -> Options:
    return options(
        **{
            name: given[name] if declared.attributes is not None else _object(declared.of, given)  # type: ignore[arg-type]
            for name, declared in _declarations(options)
        }
    )


def _declarations(options: Any) -> Iterator[tuple[str, _Declared]]:
    """Yield the fields of a class, its own before those that it inherits, with their declarations."""
    fields = options.__dataclass_fields__
    for name in sorted(fields, key=lambda name: name not in options.__annotations__):
        if isinstance(fields[name].default, _Declared):
            yield name, fields[name].default


class Stop(Exception):
    """Ends the command: the diagnostics are reported, and the process exits with this code."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


class Answer(Struct):
    """The output of a command after its report: `data` with `--output-format json`, otherwise `text`.

    Each of them may be a function, which is called only if its result is printed. `markdown` replaces the text in that
    format. `--quiet` omits the text of an outcome, such as the path of a written file. `reports` is False if
    diagnostics are not shown on success. Without a `code`, the process exits with 1 if there are errors. `aside` is an
    outcome for standard error. Unless `is_ascii`, JSON contains letters outside ASCII.
    """

    text: str | Callable[[], str]
    data: object = None
    code: int | None = None
    is_outcome: bool = False
    reports: bool = True
    is_ascii: bool = True
    aside: str | None = None
    markdown: Callable[[], str] | None = None

    def show(self, form: str) -> None:
        if form == "json" and self.data is not None:
            data = self.data() if callable(self.data) else self.data
            click.echo(json_text(data, indent=None if self.is_outcome else 2, ensure_ascii=self.is_ascii))
            return
        source = self.markdown if form == "markdown" and self.markdown is not None else self.text
        text = source() if callable(source) else source
        if self.is_outcome:
            say(text, form=form)
        else:
            click.echo(printable(text, colors=True), color=reporting.use_color(out=True))


class Run:
    """One run of a command: its context with the diagnostics, the format of its output, and its end.

    A command whose standard output is a model sets `to_stderr`. `texts` are new contents of files that messages show,
    by their names. `suites` are the results for JUnit. After `is_reported`, the end of the command prints no
    diagnostics. The formats in `DOCUMENTS` are printed once, at the end, and other output goes to standard error.
    """

    def __init__(self, command: click.Context) -> None:
        given = command.params
        self.form = str(given.get("form", "text"))
        command.meta[FORM] = self.form
        self.is_strict = bool(given.get("strict"))
        self.junit: str | None = given.get("junit")
        has_output = "-" in (given.get("out"), self.junit, *_listed(given.get("recipes")))
        self.is_document = self.form in DOCUMENTS
        self.sets_apart = self.is_document and not has_output
        self.kept: list[Diagnostic] = []
        self.suites: list[Suite] = []
        self.texts: Mapping[str, bytes] = {}
        self.to_stderr = False
        self._given = given
        self._meta = command.meta
        self._progress = reporting.progress_of_command()  # contexts are also opened in threads, which lack Click's own
        self.is_reported = False
        self.context = self.new_context()

    def new_context(self) -> Context:
        """Return a context with a `Sink` of its own and the options of this run."""
        if "offline" not in self._given:
            return Context(strict=self.is_strict)
        from mjcompose.sources.fetching import Fetching

        locked, offline, both = (bool(self._given.get(each)) for each in ("locked", "offline", "frozen"))
        how = Fetching(locked=locked or both, offline=offline or both, progress=self._progress)
        return Context(fetching=how, strict=self.is_strict)

    def report(self, context: Context | None = None) -> None:
        """Print all diagnostics now, of another context if one is given."""
        self.is_reported |= context is None
        if self.is_document:
            self.kept += (context or self.context).sink.sorted()
        else:
            report(context or self.context, self.form, err=self.to_stderr, texts=self.texts)

    def check(self, code: int = USAGE) -> None:
        """End the command with this code if there are errors."""
        if self.context.sink.has_errors:
            raise Stop(code)

    @contextmanager
    def stopping(self, code: int) -> Iterator[None]:
        """End the command with this code if a DiagnosticError ends the block."""
        with self.context.sink:
            yield
            return
        raise Stop(code)

    def need(self, value: Value | None, *named: Path) -> Value:
        """Return the value, or end the command if there is none, with the code for the files that were named."""
        if value is None:
            raise Stop(self.code_of_failure(*named))
        return value

    def code_of_failure(self, *named: Path) -> int:
        """Return the exit code of a failed command: a usage error if one of its files does not exist."""
        return exit_code(self.context.folder, named)

    def end(self, answer: Answer | int | None) -> int:
        """Report the remaining diagnostics, print the answer, and return the exit code."""
        context = self.context
        if not self.is_reported and (not isinstance(answer, Answer) or answer.reports):
            self.report()
        clear_progress()
        code = answer
        if isinstance(answer, Answer):
            answer.show(self.form)
            if answer.aside is not None:
                say(answer.aside, err=True)
            code = answer.code
        if not isinstance(code, int):
            code = FINDINGS if context.sink.has_errors else 0
        if self.junit is not None:
            writing = Context()
            reporting.write_junit(self.suites, self.junit, writing)
            self.report(writing)
            code = max(code, FINDINGS if writing.sink.has_errors else 0)
        return code

    def print_document(self) -> None:
        """Print all diagnostics that were reported, in a format that is one document."""
        read = reporting.source_reader(self.context.folder, self.texts)
        shown = reporting.rendered(self.kept, self.form, read, suites=self.suites)
        click.echo(shown, nl=False, err=self.to_stderr or not self.sets_apart)

    @contextmanager
    def session(self, *, remembers: bool) -> Iterator[Session]:
        """Yield a session for MuJoCo. With `--watch`, all runs share one session, which remembers assets."""
        from mjcompose.mujoco.engine import Session

        kept = self._meta.get(_SESSIONS)
        if kept is None:
            with Session(remembers=remembers) as session:
                yield session
            return
        opened, sessions = kept
        if not sessions:
            sessions.append(opened.enter_context(Session(remembers=True)))
        yield sessions[0]


_SESSIONS = "mjcompose.sessions"


def _ended(function: Callable[[Options, Run], Answer | int | None], options: Options, run: Run) -> int:
    with redirect_stdout(sys.stderr) if run.sets_apart else nullcontext():
        try:
            answer = function(options, run)
        except Stop as stop:
            answer = stop.code
            run.junit = None
        code = run.end(answer)
    if run.is_document:
        run.print_document()
    return code


def _listed(value: Any) -> Iterable[Path]:
    return () if value is None else value if isinstance(value, tuple) else (value,)


def _again_and_again(once: Callable[[], int], named: list[Path]) -> int:
    """Run the command again whenever a file that it read changes, until the user interrupts it."""
    from mjcompose.tools.view.builder import marks

    before: dict[Path, Mark] = {}
    with ExitStack() as opened:
        click.get_current_context().meta[_SESSIONS] = opened, []
        try:
            while True:
                started = marks([*before, *named])
                reporting.note_files(named)
                code = once()
                let_go()
                if code == USAGE and not before:  # there is nothing to watch
                    return code
                files = [Path.cwd() / path for path in reporting.noted_files()]
                before = {path: started.get(path, mark) for path, mark in marks(files).items()}
                if not is_quiet():
                    clear_progress()
                    click.echo(f"watching {len(before)} files; Ctrl-C ends it", err=True)
                _wait(before)
        except KeyboardInterrupt:
            clear_progress()
    return 0


def _wait(before: dict[Path, Mark]) -> None:
    """Wait until a file has changed, in a separate thread because a watch swallows the signal that ends a command."""
    from concurrent.futures import ThreadPoolExecutor

    from mjcompose.tools.view.builder import FileWatch

    stop = Event()
    done = Event()
    # Register the stop of the thread before it starts: an interrupt in between would wait for it forever.
    with ThreadPoolExecutor(1) as executor, ExitStack() as at_the_end:
        at_the_end.callback(stop.set)
        executor.submit(FileWatch(stop).wait, before).add_done_callback(lambda _: done.set())
        while not done.wait(_PATIENCE):
            pass

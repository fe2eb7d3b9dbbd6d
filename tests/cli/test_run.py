"""A command of its own: its options are one object, and the runner reports, prints and exits."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mjcompose.base.dataclass import dataclass
from mjcompose.cli.options import RECIPE, STRICT, ReportOptions
from mjcompose.cli.run import Answer, Run, Stop, command, flag, group


@dataclass(frozen=True, slots=True)
class Options:
    recipe: Path = RECIPE
    wrong: bool = flag("--wrong", help="Report an error.")
    none: bool = flag("--none", help="Have no result.")
    stop: bool = flag("--stop", help="Stop with 2.")
    printed: bool = flag("--printed", help="The result is an outcome.")
    strict: bool = STRICT
    reporting: ReportOptions = group(ReportOptions)


@command(Options, help="Look at RECIPE.")
def look(options: Options, run: Run) -> Answer:
    """Look at RECIPE."""
    if options.wrong:
        run.context.sink.error("wrong-type", "this is wrong")
    if options.stop:
        raise Stop(2)
    name = run.need(None if options.none else options.recipe.name, options.recipe)
    words = f"{name}, strictly" if run.context.strict else name
    return Answer(words, lambda: {"name": name}, is_outcome=options.printed)


@dataclass(frozen=True, slots=True)
class Fetches:
    offline: bool = flag("--offline", help="Fetch nothing.")


@command(Fetches, help="Open a context in a thread.")
def fetch(options: Fetches, run: Run) -> Answer:
    """Open a context in a thread, as the page of `view` does when a file is saved."""
    with ThreadPoolExecutor() as threads:
        context = threads.submit(run.new_context).result()
    return Answer(str(context.fetching.offline), dict)


def test_a_thread_opens_a_context() -> None:
    done = CliRunner().invoke(fetch, ["--offline"])
    assert (done.exit_code, done.stdout) == (0, "True\n"), done.exception


def _look(*words: str) -> Result:
    return CliRunner().invoke(look, words)


@pytest.mark.parametrize(
    ("words", "code", "out"),
    [
        (["a.yaml"], 0, "a.yaml\n"),
        (["a.yaml", "--strict"], 0, "a.yaml, strictly\n"),
        (["a.yaml", "--output-format", "json"], 0, '{\n  "name": "a.yaml"\n}\n'),
        (["a.yaml", "--output-format", "json", "--printed", "-q"], 0, '{"name": "a.yaml"}\n'),
        (["a.yaml", "--quiet"], 0, "a.yaml\n"),
        (["a.yaml", "--quiet", "--printed"], 0, ""),
        (["a.yaml", "--none"], 2, ""),
        ([__file__, "--none"], 1, ""),
        (["a.yaml", "--stop"], 2, ""),
    ],
)
def test_the_result_and_the_code(words: list[str], code: int, out: str) -> None:
    done = _look(*words)
    assert (done.exit_code, done.stdout) == (code, out)


def test_an_error_is_reported_once_and_fails() -> None:
    done = _look("a.yaml", "--wrong")
    assert done.exit_code == 1 and done.stdout.endswith("a.yaml\n")
    assert done.stderr.count("error[wrong-type]: this is wrong") == 1
    done = _look("a.yaml", "--wrong", "--stop", "--output-format", "json")
    assert done.exit_code == 2 and json.loads(done.stdout)["code"] == "wrong-type"


def test_the_help_is_the_docstring_and_the_fields() -> None:
    told = _look("--help").stdout
    assert "Usage: look [OPTIONS] RECIPE" in told and "Look at RECIPE." in told
    assert told.index("--wrong") < told.index("--strict") < told.index("Output:") < told.index("--quiet")

"""`--junit FILE`: the results of `check` for the test table of a CI system."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.cli.reporting import source_reader
from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.junit import Case, Suite, report

if TYPE_CHECKING:
    from composer.context import Context
    from composer.diagnostics.cell_name import CellName
    from composer.verify.outcome import Outcome

MODEL = "model"


def junit_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option; the command gets the file as `junit`."""
    return click.option("--junit", metavar="FILE", help="Write the result of each check as JUnit XML ('-' is"
                        " standard output).")(command)  # fmt: skip


def suite_of(
    recipe: Path,
    outcomes: Sequence[Outcome],
    found: Iterable[Diagnostic],
    context: Context,
    cell: CellName | None = None,
) -> Suite:
    """Return the results of a recipe, or of one cell: the first case is the model itself, followed by its checks."""
    of_checks = {each for outcome in outcomes for each in outcome.diagnostics}
    others = [each for each in found if each.severity is Severity.ERROR and each not in of_checks]
    shown = context.shown(recipe)
    cases = [Case(MODEL, MODEL, others, file=shown)]
    cases += [
        Case(each.name, each.kind, each.diagnostics, file=each.span.file, line=each.span.line)
        for each in outcomes
    ]
    return Suite(shown if cell is None else f"{shown}: {cell.name}", cases, cell)


def write_junit(suites: Sequence[Suite], out: str, context: Context) -> None:
    """Write the file completely; an error goes to the context's sink."""
    text = report(suites, source_reader(context.folder))
    if out == "-":
        click.echo(text, nl=False)
        return
    try:
        with staged_file(context.folder / out, "--junit") as stage:
            stage.write_text(text, encoding="utf-8")
    except OutputError as error:
        context.sink.add(error.diagnostic)

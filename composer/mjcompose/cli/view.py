"""`mjcompose view`: a model in the browser, live or as a file."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.cli import completing
from mjcompose.cli.options import (
    Choices,
    cell_options,
    choice_options,
    fetching,
    fetching_options,
    timeout_option,
)
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, report, reporting_options, say, words_of

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.text.node import Node
    from mjcompose.tools.diff.sides import Operand
    from mjcompose.tools.view.builder import Shown, Workshop
    from mjcompose.tools.view.live import Service


@click.command()
@click.argument("target")
@click.option("--html", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE",
              help="Write a page that needs no server and no network, and exit.")  # fmt: skip
@click.option(
    "--physics",
    is_flag=True,
    help="With --html: include MuJoCo (3.5 MB) in the page, so that it can run the simulation.",
)
@click.option("--key", metavar="KEY", help="The keyframe at the start. Default: the first one.",
              shell_complete=completing.keys)  # fmt: skip
@click.option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="The address to listen on. With"
              " another one, people who know the token can view the model too.")  # fmt: skip
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    metavar="PORT",
    help="The port to listen on. Default: a free one.",
)
@click.option("--no-open", is_flag=True, help="Do not open a browser.")
@click.option("--editor", metavar="ADDRESS", help="The link that opens a line in your editor, with {file},"
              " {line} and {column}. Default: the environment variable MJCOMPOSE_EDITOR, or"
              " vscode://file{file}:{line}:{column}.")  # fmt: skip
@choice_options
@cell_options
@timeout_option
@fetching_options
@reporting_options
def command(
    target: str,
    html: Path | None,
    physics: bool,
    key: str | None,
    host: str,
    port: int,
    no_open: bool,
    editor: str | None,
    choices: Choices,
    pick: str | None,
    sample: int | None,
    form: str,
) -> None:
    """Show TARGET in the browser: a recipe, an MJCF or URDF file, or a bundle.

    All files of the model are watched. When you save one, the page updates; errors appear above the last valid model.
    """
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.tools.diff.sides import as_recipe, read_operand

    if physics and html is None:
        raise click.UsageError("--physics is for a page with --html: a live one runs physics on the server.")
    context = Context(fetching=fetching())
    given = choices.values(context)
    with ExitStack() as opened:
        operand = None if context.sink.has_errors else read_operand(target, context, opened)
        if operand is None:
            report(context, form)
            sys.exit(USAGE)
        session = opened.enter_context(Session(remembers=html is None))
        if html is None:
            from mjcompose.tools.view.builder import EDITOR, Workshop
            from mjcompose.tools.view.live import Service
            from mjcompose.tools.view.page import Asked

            workshop = Workshop(
                target, Asked(given, pick, sample), session, open=_opener(), words=words_of, key=key,
                editor=editor or os.environ.get("MJCOMPOSE_EDITOR") or EDITOR,
            )  # fmt: skip
            sys.exit(_live(workshop, Service(host, port, not no_open), context, form=form))
        if physics:
            operand = as_recipe(operand, opened)
        words = _page(
            operand, html, key, given=given, pick=pick, sample=sample, session=session, physics=physics
        )
        operand.report(context.sink)
    report(context, form)
    if words is not None:
        say(words, form=form)
    sys.exit(FINDINGS if words is None or context.sink.has_errors else 0)


def _opener() -> Callable[[], Context]:
    """Return a function that makes the context of each build, so that files are read again."""
    from mjcompose.sources.context import Context

    how = fetching()
    return lambda: Context(fetching=how)


def _live(workshop: Workshop, service: Service, context: Context, form: str) -> int:
    """Serve until interrupted; return the exit code."""
    from threading import Event

    from mjcompose.tools.view.live import serve, started

    server = started(workshop, service, context)
    if server is None:
        report(context, form)
        return FINDINGS
    stop = Event()

    def announce(shown: Shown) -> None:
        if shown.fault is not None:
            click.echo(shown.fault, err=True)
        else:
            say(f"{shown.title}: shown, built in {shown.seconds:.2f} s", form=form)

    try:
        serve(server, service.opens, click.echo, stop=stop, said=announce)
    except KeyboardInterrupt:
        stop.set()
    return 0


def _page(
    operand: Operand,
    out: Path,
    key: str | None,
    given: dict[str, Node],
    pick: str | None,
    sample: int | None,
    session: Session,
    physics: bool,
) -> str | None:
    """Write the page; return the report, or None if there is none."""
    from mjcompose.tools.diff.sides import load
    from mjcompose.tools.view.page import write_page
    from mjcompose.tools.view.render import check_given

    if not check_given(operand, given):
        return None
    progress(f"building {operand.label}")
    side = load(operand, "view", session, given=given, pick=pick, sample=sample, whole=physics)
    if side is None or operand.context.sink.has_errors:
        return None
    size = write_page(side, out, key, context=operand.context, session=session)
    return None if size is None else f"wrote {out}, {size / 1e6:.1f} MB: open it in a browser"

"""`mjcompose view`: a model in the browser, live or as a file."""

from __future__ import annotations

import os
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli import completion
from mjcompose.cli.cells import CellOptions
from mjcompose.cli.options import Choices, FetchOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, say, words_of
from mjcompose.cli.run import Answer, Run, Stop, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session
    from mjcompose.text.node import Node
    from mjcompose.tools.diff.sides import Operand
    from mjcompose.tools.view.builder import Shown, Workshop
    from mjcompose.tools.view.live import Service


@dataclass(frozen=True, slots=True)
class Options:
    target: str = argument()
    html: Path | None = option("--html", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE",
                               help="Write a page that needs no server and no network, and exit.")  # fmt: skip
    physics: bool = flag("--physics", help="With --html: include MuJoCo (3.5 MB) in the page, to run the simulation.")
    key: str | None = option("--key", metavar="KEY", help="The keyframe at the start. Default: the first one.",
                             shell_complete=completion.keys)  # fmt: skip
    host: str = option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="The address to listen"
                       " on. With another one, people who know the token can view the model too.")  # fmt: skip
    port: int = option("--port", type=click.IntRange(0, 65535), default=0, metavar="PORT",
                       help="The port to listen on. Default: a free one.")  # fmt: skip
    read_only: bool = flag(
        "--read-only", help="Do not let the page change the recipe. With another --host it never can."
    )
    no_open: bool = flag("--no-open", help="Do not open a browser.")
    editor: str | None = option("--editor", metavar="ADDRESS", help="The link that opens a line in your editor, with"
                                " {file}, {line} and {column}. Default: the environment variable MJCOMPOSE_EDITOR, or"
                                " vscode://file{file}:{line}:{column}.")  # fmt: skip
    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    limits: TimeOptions = group(TimeOptions)
    fetching: FetchOptions = group(FetchOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def view(options: Options, run: Run) -> Answer | int:
    """Show TARGET in the browser: a recipe, an MJCF or URDF file, or a bundle.

    All files of the model are watched. When you save one, the page updates; errors appear above the last valid model.
    """
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.diff.sides import as_recipe, read_operand

    html = options.html
    if options.physics and html is None:
        raise click.UsageError("--physics is for a page with --html: a live one runs physics on the server.")
    given = options.choices.given(run)
    with ExitStack() as opened:
        operand = read_operand(options.target, run.context, opened)
        if operand is None:
            raise Stop(USAGE)
        session = opened.enter_context(Session(remembers=html is None))
        if html is None:
            from mjcompose.tools.view.builder import EDITOR, Workshop
            from mjcompose.tools.view.live import Service
            from mjcompose.tools.view.page import Asked

            workshop = Workshop(
                options.target, Asked(given, options.cell.pick, options.cell.sample), session, open=run.new_context,
                words=words_of, key=options.key,
                editor=options.editor or os.environ.get("MJCOMPOSE_EDITOR") or EDITOR,
            )  # fmt: skip
            return _live(
                workshop, Service(options.host, options.port, not options.no_open, writes=not options.read_only), run
            )
        if options.physics:
            operand = as_recipe(operand, opened)
        words = _page(operand, html, options, given=given, session=session)
        operand.report(run.context.sink)
    if words is None:
        raise Stop(FINDINGS)
    return Answer(words, is_outcome=True)


def _live(workshop: Workshop, service: Service, run: Run) -> int:
    from threading import Event

    from mjcompose.tools.view.live import serve, started

    server = started(workshop, service, run.context)
    if server is None:
        return FINDINGS
    stop = Event()

    def announce(shown: Shown) -> None:
        if shown.fault is not None:
            click.echo(shown.fault, err=True)
        else:
            say(f"{shown.title}: shown, built in {shown.seconds:.2f} s", form=run.form)

    try:
        serve(server, service.opens, click.echo, stop=stop, said=announce)
    except KeyboardInterrupt:
        stop.set()
    return 0


def _page(operand: Operand, out: Path, options: Options, given: dict[str, Node], session: Session) -> str | None:
    from mjcompose.tools.diff.sides import load
    from mjcompose.tools.view.page import write_page
    from mjcompose.tools.view.render import check_given

    if not check_given(operand, given):
        return None
    progress(f"building {operand.label}")
    cell = options.cell
    side = load(operand, "view", session, given=given, pick=cell.pick, sample=cell.sample, whole=options.physics)
    if side is None or operand.context.sink.has_errors:
        return None
    size = write_page(side, out, options.key, context=operand.context, session=session)
    return None if size is None else f"wrote {out}, {size / 1e6:.1f} MB: open it in a browser"

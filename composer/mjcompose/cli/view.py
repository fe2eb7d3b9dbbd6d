"""`view` and `render`: a model in the browser, live or as a file, and as a picture or a film."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base import report
from mjcompose.base.dataclass import Struct
from mjcompose.base.naming import file_name
from mjcompose.base.report import printable
from mjcompose.base.words import counted
from mjcompose.bundle.staging import check_own_place
from mjcompose.cli import completion
from mjcompose.cli.cells import JOBS, CellOptions, CellsOptions, check_several
from mjcompose.cli.options import Amount, Choices, FetchOptions, ReportOptions, TimeOptions, output
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, say, source_reader, words_of
from mjcompose.cli.run import Answer, Group, Run, Stop, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session
    from mjcompose.sides.operand import Operand
    from mjcompose.sources.context import Context
    from mjcompose.text.node import Node
    from mjcompose.tools.view.builder import PageFault, Shown, Workshop
    from mjcompose.tools.view.live import Service
    from mjcompose.tools.view.render import RenderRequest


class ViewOptions(Group):
    target: str = argument()
    html: Path | None = option(
        "--html",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="Write a page that needs no server and no network, and exit.",
    )
    physics: bool = flag("--physics", help="With --html: include MuJoCo (3.5 MB) in the page, to run the simulation.")
    key: str | None = option(
        "--key",
        metavar="KEY",
        help="The keyframe at the start. Default: the first one.",
        shell_complete=completion.keys,
    )
    host: str = option(
        "--host",
        default="127.0.0.1",
        show_default=True,
        metavar="ADDRESS",
        help="The address to listen on. With another one, people who know the token can view the model too.",
    )
    port: int = option(
        "--port",
        type=click.IntRange(0, 65535),
        default=0,
        metavar="PORT",
        help="The port to listen on. Default: a free one.",
    )
    read_only: bool = flag(
        "--read-only", help="Do not let the page change the recipe. With another --host it never can."
    )
    no_open: bool = flag("--no-open", help="Do not open a browser.")
    editor: str | None = option(
        "--editor",
        metavar="ADDRESS",
        help="The link that opens a line in your editor, with"
        " {file}, {line} and {column}. Default: the environment variable MJCOMPOSE_EDITOR, or"
        " vscode://file{file}:{line}:{column}.",
    )
    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    limits: TimeOptions = group(TimeOptions)
    fetching: FetchOptions = group(FetchOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    ViewOptions,
    help="""Show TARGET in the browser: a recipe, an MJCF or URDF file, or a bundle.

    All files of the model are watched. When you save one, the page updates; errors appear above the last valid model.
    """,
)
def view(options: ViewOptions, run: Run) -> Answer | int:
    from mjcompose.mujoco.engine import Session
    from mjcompose.sides.operand import as_recipe, read_operand

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
            from mjcompose.tools.view.page import ViewChoice

            workshop = Workshop(
                options.target,
                ViewChoice(given, options.cell.pick, options.cell.sample),
                session,
                open=run.new_context,
                words=words_of,
                key=options.key,
                editor=options.editor or os.environ.get("MJCOMPOSE_EDITOR") or EDITOR,
                faults=faults_of,
            )
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


def faults_of(context: Context) -> Iterator[PageFault]:
    """Yield each diagnostic for the page, with its place, and the text of the file after its fix."""
    from mjcompose.tools.fix import applied, edit_of, place_of
    from mjcompose.tools.view.builder import PageFault

    read = source_reader(context.folder)
    for each in context.sink.sorted():
        shown = report.render(each, read)
        at = each.span
        if at is None:
            yield PageFault(shown)
            continue
        source = read(at.file) or ""
        place = place_of(each)
        edit = edit_of(each, source) if place is not None and place.file == at.file else None
        yield PageFault(
            shown,
            place=str(at),
            file=at.file,
            path=Path(os.path.abspath(context.folder / at.file)),
            line=at.line,
            column=at.column,
            source=source,
            fixed=None if edit is None else applied(source, [edit]),
            words="" if edit is None else f"write {edit.text.strip()}",
        )


def _live(workshop: Workshop, service: Service, run: Run) -> int:
    from threading import Event

    from mjcompose.tools.view.live import serve, started

    server = started(workshop, service, run.context)
    if server is None:
        return FINDINGS
    stop = Event()

    def announce(shown: Shown) -> None:
        if shown.fault is not None:
            click.echo(printable(shown.fault), err=True)
        else:
            say(f"{shown.title}: shown, built in {shown.seconds:.2f} s", form=run.form)

    try:
        serve(server, service.opens, click.echo, stop=stop, said=announce)
    except KeyboardInterrupt:
        stop.set()
    return 0


def _page(operand: Operand, out: Path, options: ViewOptions, given: dict[str, Node], session: Session) -> str | None:
    from mjcompose.sides.side import load
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


_LONGEST_FILM = 60.0


def _reading(reader: str, problem: str) -> Callable[[click.Context, click.Parameter, str | None], Any]:
    """Return a callback that reads an option with a function of `render`; `problem` follows a text that it refuses."""

    def read(context: click.Context, option: click.Parameter, text: str | None) -> Any:
        from mjcompose.tools.view import render

        found = None if text is None else getattr(render, reader)(text)
        if text is not None and found is None:
            looks = ", ".join(f"{kind}/NAME" for kind in render.LOOKS)
            words = problem.format(most=render.MOST_PIXELS, looks=looks, colors=", ".join(render.COLORS))
            raise click.BadParameter(f"`{text}` {words}")
        return found

    return read


def _labels(context: click.Context, option: click.Parameter, text: str | None) -> tuple[str, ...]:
    from mjcompose.tools.view.render import LABELS

    kinds = () if text is None else tuple(each.strip() for each in text.split(","))
    wrong = next((each for each in kinds if each not in LABELS), None)
    if wrong:
        raise click.BadParameter(f"`{wrong}` is not a kind with labels: write {', '.join(LABELS)}.")
    return kinds


_size = _reading("size_of", "is not WIDTHxHEIGHT in pixels, from 16 to {most}: write for instance `640x480`.")
_look = _reading("look_of", "is not an element: write {looks}.")
_color = _reading("color_of", "is not a color: write `#RRGGBB`, or {colors}.")


class RenderOptions(Group):
    target: str = argument()
    out: str | None = output("FILE.png, FILE.gif or FILE.mp4. Default: build/NAME.png.")
    key: str | None = option(
        "--key", metavar="KEY", help="The keyframe to show. Default: the first one.", shell_complete=completion.keys
    )
    camera: str | None = option(
        "--camera",
        metavar="CAMERA",
        shell_complete=completion.cameras,
        help="A camera of the model. Default: a camera that shows the whole model.",
    )
    size: tuple[int, int] | None = option(
        "--size",
        callback=_size,
        metavar="WIDTHxHEIGHT",
        help="The size in pixels. Default: 1920x1440, 960x720 for a film, 640x480 for each picture of a contact sheet.",
    )
    look: tuple[str, str] | None = option(
        "--look",
        callback=_look,
        metavar="KIND/NAME",
        help="Fill the picture with a body and its parts, a geom, a site or a joint: body/arm/base.",
    )
    explode: bool = flag("--explode", help="Move the parts apart, with lines to their places.")
    labels: tuple[str, ...] = option(
        "--labels",
        callback=_labels,
        metavar="KINDS",
        help="Show names of sites, joints, bodies or geoms: --labels site,joint.",
    )
    background: tuple[int, int, int, int] | None = option(
        "--background",
        callback=_color,
        metavar="COLOR",
        help="#RRGGBB, white, black, grey or transparent. Default: the model's sky, or grey if it has none.",
    )
    turntable: bool = flag("--turntable", help="Make a film in which the camera goes around the model once.")
    play: float | None = option(
        "--play",
        type=Amount(min=0, min_open=True, max=_LONGEST_FILM),
        metavar="SECONDS",
        help="Make a film of this many seconds of simulation.",
    )
    choices: Choices = group(Choices)
    cells: CellsOptions = group(CellsOptions)
    jobs: int | None = JOBS
    limits: TimeOptions = group(TimeOptions)
    fetching: FetchOptions = group(FetchOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    RenderOptions,
    help="""Render a picture of TARGET: a recipe, an MJCF or URDF file, or a bundle.

    With --all, --pick or --sample, make a contact sheet of these cells of the matrix and samples, each with its name
    below it.
    """,
)
def render(options: RenderOptions, run: Run) -> Answer:
    from mjcompose.mujoco.engine import Session
    from mjcompose.sides.operand import read_operand
    from mjcompose.tools.view.render import FILM, TILE, RenderRequest

    given = options.choices.values(run.context)
    several = not options.cells.one
    moves = options.turntable or options.play is not None
    _check_usage_of_render(options, several=several, moves=moves)
    run.check()
    wish = RenderRequest(
        options.size or (TILE if several else FILM if moves else RenderRequest().size),
        options.key,
        options.camera,
        background=options.background,
        turntable=options.turntable,
        play=options.play,
        look=options.look,
        explode=options.explode,
        labels=options.labels,
    )
    with ExitStack() as opened:
        operand = read_operand(options.target, run.context, opened)
        if operand is None:
            raise Stop(USAGE)
        name = file_name(Path(options.target).stem)
        out = Path(options.out or f"build/{name}.{'gif' if moves else 'png'}")
        if options.out is None:
            with run.stopping(FINDINGS):
                check_own_place(run.context.folder / out)
        session = opened.enter_context(Session(rendering=True))
        rendering = _Rendering(operand, out, wish, given=given, session=session)
        words = rendering.sheet(options) if several else rendering.one()
        operand.report(run.context.sink)
    if words is None:
        raise Stop(FINDINGS)
    return Answer(words, is_outcome=True)


def _check_usage_of_render(options: RenderOptions, *, several: bool, moves: bool) -> None:
    check_several(not several, jobs=options.jobs)
    if several and moves:
        raise click.UsageError("A contact sheet does not move: remove --turntable and --play.")
    if options.turntable and options.camera is not None:
        raise click.UsageError("--turntable goes around the whole model: remove --camera.")
    if options.look is not None and options.camera is not None:
        raise click.UsageError("--look and --camera both choose the view: remove one of them.")
    if options.explode and options.play is not None:
        raise click.UsageError("--explode is for a model at rest: remove --play.")


class _Rendering(Struct):
    operand: Operand
    out: Path
    wish: RenderRequest
    given: dict[str, Node]
    session: Session

    def one(self) -> str | None:
        """Write one picture or film."""
        from mjcompose.sides.side import load
        from mjcompose.tools.view.render import check_given, format_of, render

        operand = self.operand
        out = self.out
        wish = self.wish
        session = self.session
        kept = "render"
        context = operand.context
        with context.sink:
            format_of(out, wish)  # before a model is built in vain
        if context.sink.has_errors or not check_given(operand, self.given):
            return None
        progress(f"drawing {operand.label}")
        side = load(operand, kept, session, given=self.given)
        if side is None or context.sink.has_errors:
            return None
        is_drawn = render(kept, out, wish, context=context, session=session, read=side.inputs)
        return f"wrote {out}" if is_drawn else None

    def sheet(self, options: RenderOptions) -> str | None:
        """Write a contact sheet."""
        from mjcompose.sides.operand import OperandKind
        from mjcompose.tools.view.render import Format, format_of, render_sheet

        operand = self.operand
        out = self.out
        context = self.operand.context
        with context.sink:
            assert format_of(out, self.wish) is Format.PNG, out
        if context.sink.has_errors:
            return None
        if operand.kind is not OperandKind.RECIPE:
            context.sink.error(
                "unknown-name",
                f"`{operand.label}` is not a recipe and has neither cells nor samples",
                help="remove `--all`, `--pick` and `--sample`",
            )
            return None
        cells, code = options.cells.chosen(operand.path, self.given, context=context, verb="render")
        if code:
            return None
        if not cells:
            return self.one()
        drawn = render_sheet(
            operand,
            cells,
            out,
            wish=self.wish,
            session=self.session,
            given=self.given,
            tell=lambda name: progress(f"drawing {name}"),
            jobs=options.jobs,
        )
        return f"wrote {out}: {counted(drawn, 'picture')}" if drawn else None

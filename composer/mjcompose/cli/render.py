"""`mjcompose render`: a picture, a film or a contact sheet of a model."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.cli import completing
from mjcompose.cli.options import (
    Amount,
    Choices,
    cells_options,
    check_several,
    choice_options,
    chosen_cells,
    fetching,
    fetching_options,
    jobs_option,
    output_option,
    timeout_option,
)
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, report, reporting_options, say

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session
    from mjcompose.text.node import Node
    from mjcompose.tools.diff.sides import Operand
    from mjcompose.tools.view.render import Wish

_LONGEST_FILM = 60.0


def _size(context: click.Context, option: click.Parameter, text: str | None) -> tuple[int, int] | None:
    from mjcompose.tools.view.render import MOST_PIXELS, size_of

    found = None if text is None else size_of(text)
    if text is not None and found is None:
        message = (
            f"`{text}` is not WIDTHxHEIGHT in pixels, from 16 to {MOST_PIXELS}: write for instance `640x480`."
        )
        raise click.BadParameter(message)
    return found


def _color(
    context: click.Context, option: click.Parameter, text: str | None
) -> tuple[int, int, int, int] | None:
    from mjcompose.tools.view.render import COLORS, color_of

    found = None if text is None else color_of(text)
    if text is not None and found is None:
        raise click.BadParameter(f"`{text}` is not a color: write `#RRGGBB`, or {', '.join(COLORS)}.")
    return found


@click.command()
@click.argument("target")
@output_option("FILE.png, FILE.gif or FILE.mp4. Default: build/NAME.png.")
@click.option(
    "--key",
    metavar="KEY",
    help="The keyframe to show. Default: the first one.",
    shell_complete=completing.keys,
)
@click.option("--camera", metavar="CAMERA", help="A camera of the model. Default: a camera that shows the whole model.",
              shell_complete=completing.cameras)  # fmt: skip
@click.option("--size", callback=_size, metavar="WIDTHxHEIGHT", help="The size in pixels. Default: 960x720, or"
              " 320x240 for each picture of a contact sheet.")  # fmt: skip
@click.option("--background", callback=_color, metavar="COLOR", help="#RRGGBB, white, black, grey or transparent."
              " Default: the model's sky, or grey if it has none.")  # fmt: skip
@click.option("--turntable", is_flag=True, help="Make a film in which the camera goes around the model once.")
@click.option("--play", type=Amount(min=0, min_open=True, max=_LONGEST_FILM), metavar="SECONDS",
              help="Make a film of this many seconds of simulation.")  # fmt: skip
@choice_options
@cells_options
@jobs_option
@timeout_option
@fetching_options
@reporting_options
def command(
    target: str,
    out: str | None,
    key: str | None,
    camera: str | None,
    size: tuple[int, int] | None,
    background: tuple[int, int, int, int] | None,
    turntable: bool,
    play: float | None,
    choices: Choices,
    every: bool,
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    jobs: int | None,
    form: str,
) -> None:
    """Render a picture of TARGET: a recipe, an MJCF or URDF file, or a bundle.

    With --all, --pick or --sample, make a contact sheet of these cells of the matrix and samples, each with its name
    below it.
    """
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.tools.diff.sides import read_operand
    from mjcompose.tools.view.render import TILE, Wish

    context = Context(fetching=fetching())
    given = choices.values(context)
    several = every or bool(picks) or bool(only_samples)
    check_several(not several, jobs=jobs)
    if several and (turntable or play is not None):
        raise click.UsageError("A contact sheet does not move: leave --turntable and --play out.")
    if turntable and camera is not None:
        raise click.UsageError("--turntable goes around the whole model: leave --camera out.")
    wish = Wish(
        size or (TILE if several else Wish().size),
        key,
        camera,
        background=background,
        turntable=turntable,
        play=play,
    )
    with ExitStack() as opened:
        operand = None if context.sink.has_errors else read_operand(target, context, opened)
        if operand is None:
            report(context, form)
            sys.exit(USAGE)
        moves = turntable or play is not None
        place = Path(out or f"build/{Path(target).stem or 'model'}.{'gif' if moves else 'png'}")
        session = opened.enter_context(Session(rendering=True))
        one = partial(_sheet, jobs=jobs) if several else _one
        words = one(operand, place, wish, given, picks, only_samples, session)
        operand.report(context.sink)
    report(context, form)
    if words is not None:
        say(words, form=form)
    sys.exit(FINDINGS if words is None or context.sink.has_errors else 0)


def _one(
    operand: Operand,
    out: Path,
    wish: Wish,
    given: dict[str, Node],
    _picks: tuple[str, ...],
    _samples: tuple[int, ...],
    session: Session,
) -> str | None:
    """Write one picture or film; return the report, or None if there is none."""
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.tools.diff.sides import load
    from mjcompose.tools.view.render import check_given, format_of, render

    context, kept = operand.context, "render"
    try:
        format_of(out, wish)  # before a model is built in vain
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    if not check_given(operand, given):
        return None
    progress(f"drawing {operand.label}")
    side = load(operand, kept, session, given=given)
    if side is None or context.sink.has_errors:
        return None
    return (
        f"wrote {out}"
        if render(kept, out, wish, context=context, session=session, read=side.inputs)
        else None
    )


def _sheet(
    operand: Operand,
    out: Path,
    wish: Wish,
    given: dict[str, Node],
    picks: tuple[str, ...],
    samples: tuple[int, ...],
    session: Session,
    jobs: int | None,
) -> str | None:
    """Write a contact sheet; return the report, or None if there is none."""
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.tools.diff.sides import Kind
    from mjcompose.tools.view.render import Format, format_of, render_sheet

    context = operand.context
    try:
        if format_of(out, wish) is not Format.PNG:
            raise AssertionError(out)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    if operand.kind is not Kind.RECIPE:
        context.sink.error("unknown-name", f"`{operand.label}` is not a recipe and has neither cells nor samples",
                           help="leave `--all`, `--pick` and `--sample` out")  # fmt: skip
        return None
    cells, code = chosen_cells(operand.path, picks, samples, given=given, context=context, verb="render")
    if code:
        return None
    if not cells:
        return _one(operand, out, wish, given=given, _picks=picks, _samples=samples, session=session)
    drawn = render_sheet(
        operand, cells, out, wish=wish, session=session, given=given, tell=_progress, jobs=jobs
    )
    pictures = f"{drawn} picture{'s' * (drawn != 1)}"
    return f"wrote {out}: {pictures}" if drawn else None


def _progress(name: str) -> None:
    progress(f"drawing {name}")

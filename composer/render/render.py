"""Write a picture or a film to a file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer import engine
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.context import Context
from composer.diagnostics.unknown import unknown_name
from composer.pictures.draw import draw
from composer.render.wish import Wish, format_of

if TYPE_CHECKING:
    from composer.engine import Session

HELP = "without a display set `MUJOCO_GL=egl` or `MUJOCO_GL=osmesa`, and install EGL or OSMesa"


class _NotDrawn(Exception):
    """There is nothing to write, which was reported; an older picture stays."""


def render(
    kept: str,
    out: Path,
    wish: Wish,
    context: Context,
    session: Session,
    read: Iterable[Path] = (),
    option: str = "-o",
) -> bool:
    """Write a picture or a film of a model that `session` keeps; return False after an error, which is reported.

    It does not take the place of the files that were `read` for the model.
    """
    try:
        suffix = format_of(out, wish)
        with staged_file(context.folder / out, option, inputs=read) as stage:
            made = stage.with_name(stage.name + suffix)
            try:
                if not drawn(kept, {**wish.as_data(), "out": str(made)}, context, session=session):
                    raise _NotDrawn
                made.replace(stage)
            finally:
                made.unlink(missing_ok=True)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return False
    except _NotDrawn:
        return False
    return True


def drawn(kept: str, asked: dict[str, Any], context: Context, session: Session) -> bool:
    """Draw a kept model in the child; return False after an error, which is reported."""
    answer = engine.call(session, draw, [kept], argument=asked)
    if not answer.ok:
        context.sink.error("no-rendering", f"no picture could be made: {answer.error or answer.crash}")
        return False
    said: dict[str, Any] = answer.value
    no_opengl = session.no_opengl or said.get("no OpenGL")
    if no_opengl is not None:
        context.sink.error("no-rendering", f"no picture can be made without OpenGL: {no_opengl}", help=HELP)
        return False
    if "no encoder" in said:
        context.sink.error(
            "no-video", f"no MP4 can be written without PyAV: {said['no encoder']}",
            help='install it with `pip install "mjcompose[video]"`, or write a `.gif`',
        )  # fmt: skip
        return False
    if "stopped" in said:
        help = "`--play` with fewer seconds ends before that; a smaller `timestep` in `<option>` often helps"
        context.sink.error("unstable", f"the film ends early: {said['stopped']}", help=help)
        return False
    if "unknown" in said:
        kind = said["unknown"]
        word = {"key": "keyframe"}.get(kind, kind)
        written = f"--{kind} {{}}"
        context.sink.add(unknown_name(word, asked[kind], said["known"], written=written))
        return False
    return True

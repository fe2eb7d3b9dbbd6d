"""Render pictures of A and B from the same places into a folder."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from composer import engine
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.context import Context
from composer.diff.change import View
from composer.pictures.pairs import pictures
from composer.scratch import scratch

if TYPE_CHECKING:
    from composer.engine import Session

_HELP = "without a display set `MUJOCO_GL=egl` or `MUJOCO_GL=osmesa`, and install EGL or OSMesa"


def render_views(folder: Path, kept: tuple[str, str], context: Context, session: Session) -> tuple[View, ...]:
    """Write the pictures of two models that `session` keeps; if there are none, the sink says why."""
    with scratch("pictures") as made:
        answer = engine.call(session, pictures, kept, argument=str(made))
        if not answer.ok:
            said = answer.error or answer.crash
            context.sink.error("no-rendering", f"no pictures could be made: {said}")
            return ()
        if (said := session.no_opengl or answer.value.get("no OpenGL")) is not None:
            context.sink.error("no-rendering", f"no pictures can be made without OpenGL: {said}", help=_HELP)
            return ()
        views: list[View] = []
        used: set[str] = set()
        try:
            for number, each in enumerate(answer.value["views"]):
                stem = _stem(each["name"], used)
                places = [folder / f"{stem}-{side}.png" for side in ("before", "after")]
                for place, side in zip(places, "ab", strict=True):
                    with staged_file(context.folder / place, "--renders") as stage:
                        stage.write_bytes(Path(made, f"{number}-{side}.png").read_bytes())
                views.append(View(each["name"], str(places[0]), str(places[1]), differs=each["differs"]))
        except OutputError as error:
            context.sink.add(error.diagnostic)
            return ()
        return tuple(views)


def _stem(name: str, used: set[str]) -> str:
    """Return the stem of a view's files; two views never share one."""
    stem = first = re.sub(r"[^\w.-]+", "_", name).lstrip(".") or "camera"
    number = 1
    while stem.lower() in used:
        number += 1
        stem = f"{first}_{number}"
    used.add(stem.lower())
    return stem

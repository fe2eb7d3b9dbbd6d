"""Draw a picture or a film of one model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from composer.compiled.kinds import names
from composer.compiled.stepping import advance
from composer.pictures.gif import gif
from composer.pictures.png import png
from composer.pictures.stage import Look, NoOpenGL, Stage
from composer.pictures.video import NoEncoder, encoder, write_mp4

_TURN_SECONDS = 4.0
_RATES = {".gif": 20, ".mp4": 30}


class _StoppedError(Exception):
    """The simulation cannot go on, for the reason that it says."""


def draw(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write a file and return an empty answer, or why it could not be written; runs under `composer.engine.call`.

    ``asked`` has the fields of `composer.render.wish.Wish` and ``out``, whose suffix is `.png`, `.gif` or `.mp4`.
    With ``tile``, a NumPy array of the picture with that text below goes to ``out`` instead.
    """
    for kind in ("key", "camera"):
        if asked[kind] is not None and asked[kind] not in names(model, kind):
            return {"unknown": kind, "known": [name for name in names(model, kind) if name]}
    out = Path(asked["out"])
    background = None if asked["background"] is None else tuple(asked["background"])
    tile = asked.get("tile")
    width, height = asked["size"]
    look = Look(width, height, background, is_tile=tile is not None)
    key = asked["key"] if asked["key"] is not None else (0 if model.nkey else None)
    try:
        if out.suffix == ".mp4":
            encoder()
        stage = Stage(mujoco, model, key, look=look)
    except NoEncoder as error:
        return {"no encoder": str(error)}
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    view = asked["camera"] if asked["camera"] is not None else stage.whole()
    try:
        if tile is not None:
            np.save(out, _labelled(stage, stage.picture(view), tile))
        elif out.suffix == ".png":
            out.write_bytes(png(stage.picture(view)))
        else:
            rate = _RATES[out.suffix]
            frames = list(_frames(stage, view, rate, turntable=asked["turntable"], play=asked["play"]))
            _WRITERS[out.suffix](out, frames, rate)
    except _StoppedError as error:
        return {"stopped": str(error)}
    finally:
        stage.close()
    return {}


def _frames(stage: Stage, view: Any, rate: int, turntable: bool, play: float | None) -> Iterator[Any]:
    """Yield the pictures of a film: physics for `play` seconds, a turn around the model, or both at once.

    Raises _StoppedError if the simulation cannot go on.
    """
    seconds = _TURN_SECONDS if play is None else play
    count = max(2, round(seconds * rate))
    started = stage.data.time
    for number in range(count):
        if play is not None:
            stopped = advance(stage.mujoco, stage.model, stage.data, end=number / rate, begun=started)
            if stopped is not None:
                raise _StoppedError(stopped)
        yield stage.picture(view)
        if turntable:
            view.azimuth += 360 / count


def _labelled(stage: Stage, picture: Any, words: str) -> Any:
    """Return a picture with a line of text below it."""
    strip = stage.text(words, picture.shape[1], _STRIP, ink=_INK, paper=_PAPER)
    return np.concatenate([picture[:, :, :3], strip])


_STRIP = 20
_INK, _PAPER = (0.92, 0.93, 0.95), (0.13, 0.15, 0.19)


def _write_gif(out: Path, frames: list[Any], rate: int) -> None:
    out.write_bytes(gif(frames, 1 / rate))


_WRITERS: dict[str, Callable[[Path, list[Any], int], None]] = {".gif": _write_gif, ".mp4": write_mp4}

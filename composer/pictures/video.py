"""Write pictures as an MP4 with PyAV, which is an extra."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

_QUALITY = "20"


class NoEncoder(Exception):
    """PyAV cannot be imported."""


def encoder() -> Any:
    """Return PyAV. Raises `NoEncoder`."""
    try:
        return import_module("av")
    except ImportError as error:
        raise NoEncoder(str(error)) from error


def write_mp4(path: Path, frames: Sequence[NDArray[Any]], rate: int) -> None:
    """Write RGB arrays `(height, width, 3)` of one size; an odd row or column, which H.264 does not allow, is cut."""
    av = encoder()
    height, width, _ = frames[0].shape
    height, width = height - height % 2, width - width % 2
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as film:
        track = film.add_stream("libx264", rate=Fraction(rate), options={"crf": _QUALITY})
        track.width, track.height, track.pix_fmt = width, height, "yuv420p"
        for frame in frames:
            picture = av.VideoFrame.from_ndarray(frame[:height, :width].copy(), format="rgb24")
            film.mux(track.encode(picture))
        film.mux(track.encode())

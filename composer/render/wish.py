"""The settings of a requested picture."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

from composer.bundle.output_error import OutputError
from composer.dataclass import dataclass
from composer.diagnostics.suggest import did_you_mean

Colour = tuple[int, int, int, int]
TRANSPARENT: Colour = (0, 0, 0, 0)
COLOURS: dict[str, Colour] = {
    "white": (255, 255, 255, 1),
    "black": (0, 0, 0, 1),
    "grey": (235, 235, 235, 1),
    "transparent": TRANSPARENT,
}
MOST_PIXELS = 8192


class Format(StrEnum):
    """The file formats of pictures and films, by suffix."""

    PNG = ".png"
    GIF = ".gif"
    MP4 = ".mp4"


@dataclass(frozen=True, slots=True)
class Wish:
    """The settings of a picture or film.

    `size` is width and height in pixels, `background` RGB of 255 and an opacity of 0 or 1; None is the model's own.
    `key` and `camera` are names; None is the first keyframe, and a camera that shows the whole model. `play` are
    the seconds of physics in a film; None is no physics.
    """

    size: tuple[int, int] = (960, 720)
    key: str | None = None
    camera: str | None = None
    background: Colour | None = None
    turntable: bool = False
    play: float | None = None

    def as_data(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self.__slots__}


def format_of(out: Path, wish: Wish) -> Format:
    """Return the format for a file's name. Raises `OutputError` if it is unknown or does not fit the wish."""
    suffix = out.suffix.lower()
    known = [each.value for each in Format]
    if suffix not in known:
        near = did_you_mean(suffix, known, "-o " + str(out.with_suffix("")) + "{}") if suffix else None
        help = near or f"write for instance `-o {out.with_suffix('.png')}`"
        raise OutputError("output-kind", f"`{out}` is not a .png, .gif or .mp4 file", help)
    moves = wish.turntable or wish.play is not None
    if suffix == Format.PNG and moves:
        help = f"write `-o {out.with_suffix('.gif')}`"
        raise OutputError("output-kind", f"`{out}` is one picture, and a film was asked for", help)
    if suffix != Format.PNG and not moves:
        help = f"add `--turntable` or `--play SECONDS`, or write `-o {out.with_suffix('.png')}`"
        raise OutputError("output-kind", f"`{out}` is a film, and nothing moves in it", help)
    if suffix != Format.PNG and wish.background == TRANSPARENT:
        raise OutputError("output-kind", "a film has no transparent background", "leave `--background` out")
    return Format(suffix)


def colour_of(text: str) -> Colour | None:
    """Return a colour by its name or as `#RRGGBB`; None for anything else.

    >>> colour_of("#ff8000")
    (255, 128, 0, 1)
    """
    if text in COLOURS:
        return COLOURS[text]
    digits = text.removeprefix("#")
    if len(digits) != 6 or digits == text:
        return None
    try:
        red, green, blue = bytes.fromhex(digits)
    except ValueError:
        return None
    return red, green, blue, 1


def size_of(text: str) -> tuple[int, int] | None:
    """Parse `WIDTHxHEIGHT` in pixels, from 16 to 8192; return None for anything else.

    >>> size_of("640x480")
    (640, 480)
    """
    width, _, height = text.lower().partition("x")
    if not (width.isascii() and width.isdigit() and height.isascii() and height.isdigit()):
        return None
    found = int(width), int(height)
    return found if all(16 <= each <= MOST_PIXELS for each in found) else None

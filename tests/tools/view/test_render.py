"""What a picture shall show, and the files that can hold it."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.bundle.bundle import OutputError
from mjcompose.tools.view.render import TRANSPARENT, Format, RenderRequest, color_of, format_of, size_of


@pytest.mark.parametrize(
    ("name", "wish", "expected"),
    [
        ("a.png", RenderRequest(), Format.PNG),
        ("a.PNG", RenderRequest(), Format.PNG),
        ("a.gif", RenderRequest(turntable=True), Format.GIF),
        ("a.mp4", RenderRequest(play=2.0), Format.MP4),
    ],
)
def test_the_suffix_says_the_form(name: str, wish: RenderRequest, expected: Format) -> None:
    assert format_of(Path(name), wish) is expected


@pytest.mark.parametrize(
    ("name", "wish", "message", "help"),
    [
        ("a.jpg", RenderRequest(), "not a .png, .gif or .mp4", "-o a"),
        ("a", RenderRequest(), "not a .png, .gif or .mp4", "`-o a.png`"),
        ("a.png", RenderRequest(turntable=True), "one picture", "`-o a.gif`"),
        ("a.gif", RenderRequest(), "nothing moves", "--turntable"),
        ("a.gif", RenderRequest(play=1.0, background=TRANSPARENT), "transparent", "--background"),
    ],
)
def test_what_cannot_be_held_is_an_error(name: str, wish: RenderRequest, message: str, help: str) -> None:
    with pytest.raises(OutputError) as raised:
        format_of(Path(name), wish)
    assert message in raised.value.diagnostic.message
    assert help in str(raised.value.diagnostic.help)


@pytest.mark.parametrize("text", ["640", "640x", "0x480", "640x99999", "-64x480", "64x48x2", "١٦x٤٨"])
def test_a_size_is_two_numbers_of_pixels(text: str) -> None:
    assert size_of(text) is None


@pytest.mark.parametrize(
    ("text", "expected"),
    [("#FF8000", (255, 128, 0, 1)), ("white", (255, 255, 255, 1)), ("#fff", None), ("ff8000", None), ("#gg0000", None)],
)
def test_a_color_is_a_name_or_six_digits(text: str, expected: object) -> None:
    assert color_of(text) == expected

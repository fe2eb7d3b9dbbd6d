"""Numbers of a class that are angles for some joints and lengths for others."""

from __future__ import annotations

from pathlib import Path

import pytest
from cases import Case

from composer.context import Context
from composer.stages import Request, build

ERRORS = Path(__file__).parents[1] / "errors"
LEGS = Case(ERRORS / "angles" / "class_angle_of_slide.txt").texts["legs.xml"]
BY_DEFAULT = "default: {main: {joint: {range: VALUE}}}"
BY_EDIT = "edit: [{select: {default: main}, set: {joint: {range: VALUE}}}]"


def codes(folder: Path, written: str, source: str = LEGS) -> list[str]:
    (folder / "legs.xml").write_text(source)
    (folder / "recipe.yaml").write_text(f"recipe: 1\nangle: degree\nbase: ./legs.xml\n{written}\n")
    context = Context(environment={}, folder=folder)
    build(Request(folder / "recipe.yaml", verified=False), context)
    return [each.code for each in context.sink.errors]


@pytest.mark.parametrize("written", [BY_DEFAULT, BY_EDIT])
def test_a_length_that_would_be_turned_like_an_angle_is_an_error(tmp_path: Path, written: str) -> None:
    source = LEGS.replace("<worldbody>", '<default><joint damping="1"/></default><worldbody>')
    assert codes(tmp_path, written.replace("VALUE", "[0, 90]"), source) == ["bare-angle"]


@pytest.mark.parametrize(
    ("value", "source"),
    [
        ("[0, 1]", LEGS.replace('angle="radian"', 'angle="degree"')),  # the same number for both
        ("[0, 90deg]", LEGS),  # said of all of them
        ("[0, 90]", LEGS.replace('type="slide"', 'type="slide" range="0 1"')),  # not from the class
        ("[0, 90]", LEGS.replace('type="slide"', "")),
    ],
)
def test_what_means_one_thing_for_all_that_take_it_is_right(tmp_path: Path, value: str, source: str) -> None:
    assert codes(tmp_path, BY_DEFAULT.replace("VALUE", value), source) == []

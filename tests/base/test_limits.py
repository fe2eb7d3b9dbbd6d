from __future__ import annotations

import re
from pathlib import Path

import pytest
from mjcompose.base.limits import NAMES, Limits, advice, allow, in_force, read, written

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "limits.md"


def test_limits_hold_inside_the_block_alone() -> None:
    before = in_force()
    with allow(copies=7) as limits:
        assert limits.copies == in_force().copies == 7
        with allow(parts=8):
            assert (in_force().copies, in_force().parts) == (7, 8)
    assert in_force() == before == Limits()


@pytest.mark.parametrize("wrong", [{"copies": 0}, {"time": float("nan")}, {"memory": -1}])
def test_a_limit_is_greater_than_zero(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="greater than zero"), allow(**wrong):
        pass


@pytest.mark.parametrize("text", ["", "0", "-1", "nan", "inf", "1.5", "many", "1e999"])
def test_no_value_of_a_count(text: str) -> None:
    assert read("copies", text) is None


@pytest.mark.parametrize("name", NAMES)
def test_what_is_advised_can_be_read_and_suffices(name: str) -> None:
    needed = 3 * dict(Limits().items())[name] + 1
    text = advice(name, needed).rpartition("=")[2].rstrip("`")
    assert (read(name, text) or 0) >= needed


def test_the_page_has_every_limit_with_its_default_and_what_it_bounds() -> None:
    rows = re.findall(r"^\| `([a-z-]+)` \| (\S+)( s)? \| (.+) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert [(name, default, bounds) for name, default, _, bounds in rows] == [
        (name, written(name, value), NAMES[name].metadata["bounds"]) for name, value in Limits().items()
    ]

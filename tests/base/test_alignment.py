from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from difflib import SequenceMatcher
from functools import partial

import pytest
from growth.counting import calls_of
from hypothesis import given, strategies as st
from mjcompose.base import alignment
from mjcompose.base.alignment import Alignment, unified_diff

LINES = st.lists(st.integers(0, 12).map(lambda number: f"line {number}\n"), max_size=60)


def rebuilt(before: Sequence[str], after: Sequence[str]) -> list[str]:
    """Return the second sequence, made of the first by the steps of the alignment."""
    made: list[str] = []
    end = 0
    for kind, low, high, start, stop in Alignment(before, after).get_opcodes():
        assert low == end
        end = high
        if kind == "equal":
            assert before[low:high] == after[start:stop]
        made += before[low:high] if kind == "equal" else after[start:stop]
    assert end == len(before)
    return made


@given(LINES, LINES)
def test_the_steps_lead_from_one_to_the_other(before: list[str], after: list[str]) -> None:
    with pytest.MonkeyPatch.context() as patch:
        for small in (0, 20, 10_000):
            patch.setattr(alignment, "_SMALL", small)
            assert rebuilt(before, after) == after


@given(LINES, LINES)
def test_a_short_diff_is_that_of_difflib(before: list[str], after: list[str]) -> None:
    expected = list(difflib.unified_diff(before, after, "a", "b"))
    assert list(unified_diff(before, after, "a", "b")) == expected


class Line(str):
    """A text whose look-ups in a table can be counted."""

    __slots__ = ()

    def __hash__(self) -> int:
        return str.__hash__(self)


def entries(count: int, word: str) -> list[str]:
    lines = (line for number in range(count) for line in (f"# part {number}\n", f"p{number}: {word}\n", "  end\n"))
    return [Line(line) for line in lines]


def test_a_change_in_each_of_many_entries_takes_linear_time() -> None:
    before = entries(2000, "before")
    after = entries(2000, "after")
    kinds = [kind for kind, *_ in Alignment(before, after).get_opcodes()]
    assert kinds.count("replace") == 2000


@pytest.mark.parametrize(("matcher", "is_linear"), [(Alignment, True), (partial(SequenceMatcher, None), False)])
def test_look_ups_grow_with_the_lines(matcher: Callable[..., SequenceMatcher[str]], is_linear: bool) -> None:
    def look_ups(count: int) -> int:
        return calls_of(matcher(entries(count, "before"), entries(count, "after")).get_opcodes)

    assert (look_ups(800) < 2.4 * look_ups(400)) == is_linear


def test_long_texts_without_a_common_line_are_replaced() -> None:
    before = [f"{number}\n" for number in range(3000)]
    after = [f"{number}!\n" for number in range(3000)]
    assert [kind for kind, *_ in Alignment(before, after).get_opcodes()] == ["replace"]

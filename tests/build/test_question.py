from __future__ import annotations

from composer.build.order import of_cell
from composer.build.question import GIVEN, Question, differences


def test_whatever_is_asked_otherwise_is_another_question() -> None:
    first = Question("cell.yaml", {"a": "1"})
    assert first.key == Question("cell.yaml", {"a": "1"}).key
    others = [Question("cell.yaml", {"a": "2"}), Question("other.yaml", {"a": "1"}), of_cell(first, "x", {})]
    assert len({first.key, *(each.key for each in others)}) == 4
    assert others[0].subject_key == first.subject_key


def test_differences() -> None:
    assert differences({"`--dedup`": GIVEN, "`load`": "1"}, {}) == (
        "`--dedup` is no longer given",
        "`load` was 1",
    )

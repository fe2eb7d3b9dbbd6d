from __future__ import annotations

import pytest

from composer.cache.options import of_cell
from composer.cache.question import GIVEN, Question, differences
from composer.cache.surroundings import environment_parts
from composer.sources.kinds import KINDS
from composer.sources.source_kind import SourceKind


def test_whatever_is_asked_otherwise_is_another_question() -> None:
    first = Question("cell.yaml", {"a": "1"})
    assert first.key == Question("cell.yaml", {"a": "1"}).key
    others = [Question("cell.yaml", {"a": "2"}), Question("other.yaml", {"a": "1"}), of_cell(first, "x", {})]
    assert len({first.key, *(each.key for each in others)}) == 4
    assert others[0].subject_key == first.subject_key


def test_what_leads_a_package_to_other_files_is_asked() -> None:
    """As this variable leads `robot_descriptions` to another commit, in another folder."""
    parts = environment_parts({"ROBOT_DESCRIPTION_COMMIT": "abc", "COLUMNS": "80"})
    assert parts == {"the variable `ROBOT_DESCRIPTION_COMMIT`": "abc"}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_variable_of_a_kind_of_source_is_asked(kind: SourceKind) -> None:
    environment = dict.fromkeys(kind.variables, "x")
    assert environment_parts(environment) == {f"the variable `{name}`": "x" for name in kind.variables}


def test_differences() -> None:
    assert differences({"`--dedup`": GIVEN, "`load`": "1"}, {}) == (
        "`--dedup` is no longer given",
        "`load` was 1",
    )

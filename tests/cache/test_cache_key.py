from __future__ import annotations

import pytest

from composer.cache.cache_key import CacheKey
from composer.cache.environment import environment_parts
from composer.cache.reasons import GIVEN, differences
from composer.sources.kinds import KINDS
from composer.sources.source_kind import SourceKind


def test_whatever_is_asked_otherwise_is_another_key() -> None:
    first = CacheKey("cell.yaml", {"a": "1"})
    assert first.digest == CacheKey("cell.yaml", {"a": "1"}).digest
    others = [CacheKey("cell.yaml", {"a": "2"}), CacheKey("other.yaml", {"a": "1"}), first.of_cell("x", {})]
    assert len({first.digest, *(each.digest for each in others)}) == 4
    assert others[0].subject_digest == first.subject_digest


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

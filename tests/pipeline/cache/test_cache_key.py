from __future__ import annotations

import os
from dataclasses import fields
from pathlib import Path

import pytest
from mjcompose.pipeline.cache.cache import Cache, CacheAnswer
from mjcompose.pipeline.cache.cache_key import (
    ABSENT,
    GIVEN,
    BuildOptions,
    CacheKey,
    FileState,
    FileStates,
    differences,
    file_state,
    now,
)
from mjcompose.pipeline.cache.inputs import _installed
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.reference import SourceKind
from mjcompose.sources.store import Store


def test_whatever_is_asked_otherwise_is_another_key() -> None:
    first = CacheKey("cell.yaml", {"a": "1"})
    assert first.digest == CacheKey("cell.yaml", {"a": "1"}).digest
    others = [CacheKey("cell.yaml", {"a": "2"}), CacheKey("other.yaml", {"a": "1"}), first.of_cell("x", {})]
    assert len({first.digest, *(each.digest for each in others)}) == 4
    assert others[0].subject_digest == first.subject_digest


OPTIONS = {
    "verified": False,
    "deduplicated": True,
    "text_beside": Path("/out"),
    "choices": {"`size`": "2"},
    "locked": True,
    "offline": True,
    "pictured": True,
    "target": "mjx",
    "worlds": True,
}


def test_every_option_of_a_build_gives_another_key(tmp_path: Path) -> None:
    assert OPTIONS.keys() == {each.name for each in fields(BuildOptions)}
    each_alone = [BuildOptions(), *(BuildOptions(**{name: value}) for name, value in OPTIONS.items())]
    keys = {each.key(Path("a.yaml"), tmp_path, {}, tmp_path).digest for each in each_alone}
    assert len(keys) == len(OPTIONS) + 1


def test_a_package_of_another_version_is_a_change(tmp_path: Path) -> None:
    (found,) = _installed("lxml")
    assert Path(found[2]).is_file() and found[1] in found[2]
    cache = Cache(Store(tmp_path), print)
    assert cache._changes(CacheAnswer("", (), (found,))) == []
    other = (found[0], "0.1", found[2].replace(found[1], "0.1"))
    assert cache._changes(CacheAnswer("", (), (found, other))) == [
        "the package `lxml` was 0.1, and its version has changed"
    ]


def variables_in_key(environment: dict[str, str], store: Path) -> dict[str, str]:
    parts = BuildOptions().key(Path("cell.yaml"), store, environment, store).parts
    return {name: value for name, value in parts.items() if name.startswith("the variable")}


def test_what_leads_a_package_to_other_files_is_asked(tmp_path: Path) -> None:
    """As this variable leads `robot_descriptions` to another commit, in another folder."""
    parts = variables_in_key({"ROBOT_DESCRIPTION_COMMIT": "abc", "COLUMNS": "80"}, tmp_path)
    assert parts == {"the variable `ROBOT_DESCRIPTION_COMMIT`": "abc"}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_variable_of_a_kind_of_source_is_asked(kind: SourceKind, tmp_path: Path) -> None:
    environment = dict.fromkeys(kind.variables, "x")
    assert variables_in_key(environment, tmp_path) == {f"the variable `{name}`": "x" for name in kind.variables}


def test_differences() -> None:
    assert differences({"`--dedup`": GIVEN, "`load`": "1"}, {}) == ("`--dedup` is no longer given", "`load` was 1")


def test_content_counts_where_stamps_differ(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    before = FileStates().look(str(file))
    os.utime(file, (0, 0))
    assert FileStates().is_same(before)
    file.write_text("two")
    assert not FileStates().is_same(before)
    file.unlink()
    assert not FileStates().is_same(before)
    assert FileStates().look(str(file)) == FileState(str(file), ABSENT, None)


def test_a_file_that_was_just_written_is_known_by_its_content_alone(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    assert FileStates().look(str(file)).stamp is None


def test_a_folder_is_its_licenses(tmp_path: Path) -> None:
    (tmp_path / "LICENSE").write_text("free")
    before = FileStates().look(str(tmp_path))
    (tmp_path / "model.xml").write_text("<mujoco/>")
    assert FileStates().is_same(before)
    (tmp_path / "NOTICE").write_text("more")
    assert not FileStates().is_same(before)


def test_what_was_looked_at_is_looked_at_anew_when_told(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    files = FileStates()
    moment = now()
    before = files.look(str(file))
    file.write_text("other")
    os.utime(file, ns=(moment + 10**9, moment + 10**9))
    assert files.look(str(file)).state == before.state
    files.forget()
    assert files.look(str(file)).state != before.state
    assert files.changed_since(str(file), moment)


def test_as_data(tmp_path: Path) -> None:
    each = FileState("a", "b", (1, 2, 3, 4))
    assert file_state(["a", "b", [1, 2, 3, 4]]) == each
    assert each.as_data() == ["a", "b", (1, 2, 3, 4)]

from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file


def test_the_file_is_there_only_when_the_block_ends(tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder" / "out"
    with staged_file(out) as stage:
        stage.write_text("done")
        assert not out.exists()
        assert stage.parent.parent == out.parent
    assert out.read_text() == "done"
    assert os.listdir(out.parent) == ["out"]


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path, failure: type[BaseException]) -> None:
    out = tmp_path / "out"
    out.write_text("old")
    with pytest.raises(failure), staged_file(out) as stage:
        stage.write_text("half")
        raise failure
    assert out.read_text() == "old"
    assert os.listdir(tmp_path) == ["out"]


def test_a_failure_takes_the_new_folders_with_it(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), staged_file(tmp_path / "a" / "b" / "out") as stage:
        stage.write_text("half")
        raise RuntimeError
    assert os.listdir(tmp_path) == []


def test_a_fault_of_the_file_system_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError) as caught, staged_file(tmp_path / "file" / "out"):
        pass
    assert caught.value.code == "output-unwritable"
    assert caught.value.message == f"cannot write `{tmp_path / 'file' / 'out'}`: not a directory"


def test_a_file_does_not_replace_a_folder(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(OutputError, match="a folder of that name is there"), staged_file(tmp_path / "out"):
        pass


def test_what_a_link_points_to_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    with staged_file(tmp_path / "link") as stage:
        stage.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"

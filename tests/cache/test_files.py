from __future__ import annotations

import os
from pathlib import Path

from composer.cache.files import ABSENT, Files, Seen, now, seen


def test_content_counts_where_stamps_differ(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    before = Files().look(str(file))
    os.utime(file, (0, 0))
    assert Files().is_same(before)
    file.write_text("two")
    assert not Files().is_same(before)
    file.unlink()
    assert not Files().is_same(before)
    assert Files().look(str(file)) == Seen(str(file), ABSENT, None)


def test_a_file_that_was_just_written_is_known_by_its_content_alone(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    assert Files().look(str(file)).stamp is None


def test_a_folder_is_its_licences(tmp_path: Path) -> None:
    (tmp_path / "LICENSE").write_text("free")
    before = Files().look(str(tmp_path))
    (tmp_path / "model.xml").write_text("<mujoco/>")
    assert Files().is_same(before)
    (tmp_path / "NOTICE").write_text("more")
    assert not Files().is_same(before)


def test_what_was_looked_at_is_looked_at_anew_when_told(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    files, moment = Files(), now()
    before = files.look(str(file))
    file.write_text("other")
    os.utime(file, ns=(moment + 10**9, moment + 10**9))
    assert files.look(str(file)).state == before.state
    files.forget()
    assert files.look(str(file)).state != before.state
    assert files.changed_since(str(file), moment)


def test_as_data(tmp_path: Path) -> None:
    each = Seen("a", "b", (1, 2, 3, 4))
    assert seen(["a", "b", [1, 2, 3, 4]]) == each
    assert each.as_data() == ["a", "b", (1, 2, 3, 4)]

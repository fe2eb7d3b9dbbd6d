from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.reading import memory
from composer.sources.digest import remembered_sha256, sha256_of

OLD = 1_000_000_000


def test_a_file_is_hashed_again_only_where_it_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "_SETTLED", -1)
    file = tmp_path / "link.obj"
    file.write_text("one")
    first = remembered_sha256(file)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", lambda *_: pytest.fail("it is known"))
        assert remembered_sha256(file) == first
    file.write_text("two")
    os.utime(file, (OLD, OLD))
    assert remembered_sha256(file) == sha256_of(file) != first
    file.unlink()
    with pytest.raises(FileNotFoundError):
        remembered_sha256(file)

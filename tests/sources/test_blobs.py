from __future__ import annotations

from pathlib import Path

import pytest

from composer.sources import blobs
from composer.sources.blobs import blobs_in
from composer.sources.store import Store


def test_what_is_put_is_there(tmp_path: Path) -> None:
    assert blobs.get(tmp_path, "raw", "a") is None
    blobs.put(tmp_path, "raw", "a", b"content")
    assert blobs.get(tmp_path, "raw", "a") == b"content"
    assert blobs.has(tmp_path, "raw", "a")
    (blob,) = blobs_in(tmp_path)
    assert (blob.kind, blob.key, blob.is_damaged) == ("raw", "a", False)


@pytest.mark.parametrize("content", [b"", b"short", bytes(40)])
def test_what_is_damaged_is_gone(tmp_path: Path, content: bytes) -> None:
    blobs.put(tmp_path, "raw", "a", b"content")
    (tmp_path / "raw" / "a").write_bytes(content)
    (blob,) = blobs_in(tmp_path)
    assert blob.is_damaged
    assert blobs.get(tmp_path, "raw", "a") is None
    assert not blobs.has(tmp_path, "raw", "a")


def test_a_failure_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "raw").write_text("in the way")
    with pytest.raises(OSError):
        blobs.put(tmp_path, "raw", "a", b"content")
    assert list((tmp_path / "writing").iterdir()) == []


def test_what_was_used_last_is_kept_longest(tmp_path: Path) -> None:
    import os

    for age, key in enumerate("abc"):
        blobs.put(tmp_path, "packed", key, bytes(100))
        os.utime(tmp_path / "packed" / key, (age, age))
    blobs.get(tmp_path, "packed", "a")
    removed = Store(tmp_path).prune(200)
    assert [each.key for each in removed] == ["b", "c"]
    assert blobs.get(tmp_path, "packed", "a") is not None

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
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


WRITES = """
import os, sys, time
from composer.sources import blobs

def replace(stage, path):
    print("writing", flush=True)
    time.sleep(300)

blobs.os.replace = replace
blobs.put(sys.argv[1], "raw", "a", b"content")
"""


@contextmanager
def writer(store: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that has written a blob and not moved it to its place."""
    with subprocess.Popen(
        [sys.executable, "-c", WRITES, str(store)], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None and process.stdout.readline() == "writing\n"
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.skipif(sys.platform == "win32", reason="what is left waits for an hour there")
def test_what_a_killed_process_was_writing_is_swept(tmp_path: Path) -> None:
    store = Store(tmp_path)
    with writer(tmp_path) as process:
        store.prune(1000)
        assert len(store.unfinished()) == 1
        process.kill()
        process.wait()
        store.prune(1000)
        assert store.unfinished() == []


def test_what_may_not_be_locked_yet_stays(tmp_path: Path) -> None:
    (tmp_path / "writing").mkdir()
    (tmp_path / "writing" / "a.0").touch()
    Store(tmp_path).prune(1000)
    assert (tmp_path / "writing" / "a.0").exists()


def test_a_note_is_written_in_one_step_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stages = []
    replace = blobs.os.replace
    monkeypatch.setattr(
        blobs.os, "replace", lambda stage, path: (stages.append(Path(stage).parent), replace(stage, path))
    )
    store = Store(tmp_path)
    store.remember("git+https://example.org/a@main", {"commit": "1"})
    assert stages == [tmp_path / "writing"]
    assert store.recall("git+https://example.org/a@main")["commit"] == "1"

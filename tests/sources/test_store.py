from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.blobs import let_go
from mjcompose.sources.fetching import quiet
from mjcompose.sources.reference import SourceError
from mjcompose.sources.store import Store

KEY = "a" * 40


def add(store: Store, key: str = KEY, size: int = 10) -> Any:
    def fill(folder: Path) -> None:
        (folder / "inner").mkdir()
        (folder / "inner" / "file").write_bytes(bytes(size))

    with store.lock(key, quiet):
        entry = store.add("git", key, "git+file:///robots@v1", fill, {"tree": "t"})
    let_go()  # as if another process had done it
    return entry


def test_an_entry_is_found_again(tmp_path: Path) -> None:
    store = Store(tmp_path)
    assert store.get("git", KEY) is None
    add(store)
    entry = store.get("git", KEY)
    assert entry is not None
    assert (entry.content / "inner" / "file").read_bytes() == bytes(10)
    assert (entry.size, entry.origin, entry.about) == (10, "git+file:///robots@v1", {"tree": "t"})
    assert store.damage(entry) == ()


def test_what_fails_half_way_is_not_there(tmp_path: Path) -> None:
    store = Store(tmp_path)

    def fill(folder: Path) -> None:
        (folder / "half").write_text("")
        raise OSError(28, "No space left on device")

    with pytest.raises(SourceError) as caught, store.lock(KEY, quiet):
        store.add("git", KEY, "x", fill, {})
    assert caught.value.code == "store-unusable"
    assert "no space left" in caught.value.message
    assert store.get("git", KEY) is None
    assert store.unfinished() == []


def test_an_entry_without_its_end_is_none(tmp_path: Path) -> None:
    store = Store(tmp_path)
    entry = add(store)
    (entry.folder / "entry.json").write_text('{"origin": ')
    assert store.get("git", KEY) is None
    assert add(store).size == 10


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_a_killed_process_leaves_no_entry_and_no_lock(tmp_path: Path, repository: Path) -> None:
    program = f"""
import sys, time
from pathlib import Path
from mjcompose.sources.store import Store
store = Store(Path({str(tmp_path)!r}))
def fill(folder):
    (folder / "half").write_text("")
    print("filling", flush=True)
    time.sleep(60)
with store.lock({KEY!r}, print):
    store.add("git", {KEY!r}, "x", fill, {{}})
"""
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, env=environment) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"filling\n"
        process.kill()
    store = Store(tmp_path)
    assert store.get("git", KEY) is None
    assert len(store.unfinished()) == 1
    add(store)
    assert store.unfinished() == []


def test_many_processes_make_one_entry(tmp_path: Path, repository: Path) -> None:
    program = f"""
from pathlib import Path
from mjcompose.sources.store import Store
store = Store(Path({str(tmp_path)!r}))
def fill(folder):
    print("filled")
    (folder / "file").write_bytes(bytes(100000))
with store.lock({KEY!r}, lambda message: None):
    if store.get("git", {KEY!r}) is None:
        store.add("git", {KEY!r}, "x", fill, {{}})
"""
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    started = [
        subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, env=environment) for _ in range(4)
    ]
    said = [process.communicate()[0] for process in started]
    assert [process.returncode for process in started] == [0] * 4
    assert sorted(said) == [b"", b"", b"", b"filled\n"]


def test_what_was_used_longest_ago_goes_first(tmp_path: Path) -> None:
    store = Store(tmp_path)
    for age, key in [(7200, "a" * 40), (9000, "b" * 40), (10, "c" * 40)]:
        entry = add(store, key)
        used = time.time() - age
        os.utime(entry.folder / "entry.json", (used, used))
    assert [entry.key[0] for entry in store.prune(20)] == ["b"]
    assert [entry.key[0] for entry in store.prune(0)] == ["a"]  # the other is in use
    assert [entry.key[0] for entry in store.prune(0, grace=0)] == ["c"]
    assert store.entries() == []


def test_the_store_stays_below_its_bound(tmp_path: Path) -> None:
    store = Store(tmp_path, limit=25)
    for key in "abc":
        for entry in store.entries():
            os.utime(entry.folder / "entry.json", (1, 1))
        add(store, key * 40)
    assert len(store.entries()) == 2


def test_damage_is_told_by_file(tmp_path: Path) -> None:
    store = Store(tmp_path)
    entry = add(store)
    file = entry.content / "inner" / "file"
    file.chmod(0o644)
    file.write_bytes(b"other")
    (entry.content / "more").write_text("")
    assert [line.split(":")[0] for line in store.damage(entry)] == ["`inner/file` changed", "`more` is new"]


def test_a_store_where_a_file_is(tmp_path: Path) -> None:
    (tmp_path / "store").write_text("")
    with pytest.raises(SourceError) as caught:
        add(Store(tmp_path / "store"))
    assert caught.value.code == "store-unusable"


def test_a_size_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="not a size"):
        Store.of({"MJCOMPOSE_CACHE": str(tmp_path), "MJCOMPOSE_CACHE_SIZE": "lots"})
    assert Store.of({"MJCOMPOSE_CACHE": str(tmp_path), "MJCOMPOSE_CACHE_SIZE": "2G"}).limit == 2 * 1024**3


def test_what_is_remembered_is_of_one_origin(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.remember("one", {"commit": "c"})
    assert store.recall("one")["commit"] == "c"
    assert store.recall("two") == {}

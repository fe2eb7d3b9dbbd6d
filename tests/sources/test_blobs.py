"""What a process reads is not pruned while it lives, however it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base import files
from mjcompose.sources import blobs
from mjcompose.sources.blobs import blobs_in, let_go, remembered_sha256, sha256_of
from mjcompose.sources.fetching import quiet
from mjcompose.sources.store import Store


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
from mjcompose.sources import blobs

def replace(stage, path):
    print("writing", flush=True)
    time.sleep(300)

blobs.os.replace = replace
blobs.put(sys.argv[1], "raw", "a", b"content")
"""


@contextmanager
def writer(store: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that has written a blob and not moved it to its place."""
    with subprocess.Popen([sys.executable, "-c", WRITES, str(store)], stdout=subprocess.PIPE, text=True) as process:
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


OLD = 1_000_000_000


def test_a_file_is_hashed_again_only_where_it_has_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_SETTLED", -1)
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


REPOSITORY = Path(__file__).resolve().parents[2]
KEY = "a" * 40


def environment(**more: str) -> dict[str, str]:
    path = os.pathsep.join(filter(None, [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]))
    return {**os.environ, "PYTHONPATH": path, **more}


def add(store: Store) -> None:
    def fill(folder: Path) -> None:
        (folder / "file").write_bytes(bytes(10))

    with store.lock(KEY, quiet):
        store.add("git", KEY, "git+file:///robots@v1", fill, {})
    let_go()  # as if another process had done it


HOLDS = f"""
    import sys
    from pathlib import Path
    from mjcompose.sources.store import Store
    entry = Store(Path(sys.argv[1])).get("git", "{KEY}")
    print("held" if entry else "gone", flush=True)
    sys.stdin.read()
"""


def holder(store: Path) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(HOLDS), str(store)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment(),
    )
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    return process


@pytest.mark.parametrize("how", [signal.SIGTERM, getattr(signal, "SIGKILL", signal.SIGTERM)])
def test_an_entry_in_use_stays_until_its_process_ends(tmp_path: Path, how: signal.Signals) -> None:
    store = Store(tmp_path)
    add(store)
    process = holder(tmp_path)
    try:
        assert store.prune(0, grace=0) == []
        assert len(list((tmp_path / "leases").iterdir())) == 2  # with the gate
    finally:
        process.send_signal(how)
        process.wait()
        for pipe in (process.stdin, process.stdout):
            assert pipe is not None
            pipe.close()
    assert [each.key for each in store.prune(0, grace=0)] == [KEY]
    assert [each.name for each in (tmp_path / "leases").iterdir()] == ["gate"]


def test_a_process_that_ends_takes_its_lease_away(tmp_path: Path) -> None:
    add(Store(tmp_path))
    process = holder(tmp_path)
    process.communicate()
    assert [each.name for each in (tmp_path / "leases").iterdir()] == ["gate"]


def test_the_next_process_takes_away_the_leases_of_killed_ones(tmp_path: Path) -> None:
    add(Store(tmp_path))
    for _ in range(2):
        process = holder(tmp_path)
        process.kill()
        process.communicate()
    assert len(list((tmp_path / "leases").iterdir())) == 2  # with the gate


def test_letting_go(tmp_path: Path) -> None:
    store = Store(tmp_path)
    add(store)
    assert store.get("git", KEY) is not None
    assert store.prune(0, grace=0) == []
    let_go()
    assert len(store.prune(0, grace=0)) == 1


@pytest.mark.slow
@pytest.mark.timeout(280)
@pytest.mark.parametrize("option", [("--all",), ("--size", "1")], ids=["all", "size"])
def test_builds_and_prunes_at_once(tmp_path: Path, robots: Any, option: tuple[str, ...]) -> None:
    """Every build that fetches gives its model, whatever is pruned meanwhile."""
    revisions = [robots.commit(**{"arm/k.obj": f"{number}"}) for number in range(4)]
    env = environment(MJCOMPOSE_CACHE=str(tmp_path / "store"))
    command = [sys.executable, "-m", "mjcompose"]
    pruning = "import subprocess, sys\nwhile True: subprocess.run(sys.argv[1:], stdout=-3, stderr=-3)"
    prune = [sys.executable, "-c", pruning, *command, "cache", "prune", *option]
    prunes = [subprocess.Popen(prune, env=env, start_new_session=True) for _ in range(2)]
    try:
        for attempt in range(3):
            builds = []
            for number, revision in enumerate(revisions):
                folder = tmp_path / f"{attempt}-{number}"
                folder.mkdir()
                (folder / "cell.yaml").write_text(f"recipe: 1\nbase: '{robots.reference(revision)}'\n")
                builds.append(
                    subprocess.Popen(
                        [*command, "build", "cell.yaml", "-o", "out.zip", "--no-compile"],
                        cwd=folder,
                        env=env,
                        stdout=subprocess.DEVNULL,
                        stderr=subprocess.PIPE,
                        text=True,
                    )
                )
            for build in builds:
                _, said = build.communicate(timeout=200)
                assert build.returncode == 0, said
    finally:
        for each in prunes:
            os.killpg(each.pid, signal.SIGKILL) if hasattr(os, "killpg") else each.kill()
            each.wait()


def test_prune_takes_away_the_leases_of_killed_processes(tmp_path: Path) -> None:
    add(Store(tmp_path))
    process = holder(tmp_path)
    process.kill()
    process.communicate()
    Store(tmp_path).prune(1 << 30)
    assert [each.name for each in (tmp_path / "leases").iterdir()] == ["gate"]

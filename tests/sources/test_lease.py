"""What a process reads is not pruned while it lives, however it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import pytest

from composer.sources.fetching import quiet
from composer.sources.lease import let_go
from composer.sources.store import Store

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
    from composer.sources.store import Store
    entry = Store(Path(sys.argv[1])).get("git", "{KEY}")
    print("held" if entry else "gone", flush=True)
    sys.stdin.read()
"""


def holder(store: Path) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(HOLDS), str(store)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment(),
    )  # fmt: skip
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
    command = [sys.executable, "-m", "composer"]
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
                builds.append(subprocess.Popen(
                    [*command, "build", "cell.yaml", "-o", "out.zip", "--no-verify"], cwd=folder, env=env,
                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                ))  # fmt: skip
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

"""The same bytes, whatever the machine does in another order."""

from __future__ import annotations

import json
import os
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cli.shell import ARM, RECIPE, TOOL, environment, process, run

MATRIX = (
    RECIPE
    + """\
params: {load: 1}
variants:
  end: {tool: {}, none: {attach: {tool: null}}}
matrix: {axes: {end: [tool, none], load: [1, 2]}}
option: {gravity: [0, 0, "${-load}"]}
"""
)


def test_the_order_of_a_file_system(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Folders are listed backwards, and the files were made in another order."""
    for name in ("LICENSE-ASSETS", "COPYING", "NOTICE"):
        (folder / "models" / name).write_text(f"{name}\n")
    other = tmp_path / "other"
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_file():
            target = other / path.relative_to(folder)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
    assert run("build", "--no-cache", "cell.yaml", "-o", "out.zip").exit_code == 0
    run("lock", "cell.yaml")
    monkeypatch.chdir(other)
    listed = _backwards(monkeypatch)
    assert run("build", "--no-cache", "cell.yaml", "-o", "out.zip").exit_code == 0
    run("lock", "cell.yaml")
    assert listed
    assert (folder / "out.zip").read_bytes() == (other / "out.zip").read_bytes()
    assert (folder / "cell.lock").read_bytes() == (other / "cell.lock").read_bytes()
    with zipfile.ZipFile("out.zip") as bundle:
        assert len([name for name in bundle.namelist() if name.startswith("LICENSES/arm/")]) == 4


def _backwards(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Have every listing of a folder in reverse order; what was listed."""
    listed: list[str] = []
    scandir = os.scandir
    listdir = os.listdir

    class Entries:
        def __init__(self, path: Any) -> None:
            listed.append(os.fspath(path) if not isinstance(path, int) else "")
            with scandir(path) as entries:
                self.entries = iter(sorted(entries, key=lambda entry: entry.name, reverse=True))

        def __iter__(self) -> Iterator[os.DirEntry[str]]:
            return self.entries

        def __next__(self) -> os.DirEntry[str]:
            return next(self.entries)

        def __enter__(self) -> Entries:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def close(self) -> None:
            pass

    def backwards(path: Any = ".") -> list[str]:
        listed.append(os.fspath(path) if not isinstance(path, int) else "")
        return sorted(listdir(path), reverse=True)

    monkeypatch.setattr(os, "scandir", Entries)
    monkeypatch.setattr(os, "listdir", backwards)
    return listed


def test_a_cell_is_the_same_alone_and_among_others(folder: Path) -> None:
    (folder / "cells.yaml").write_text(MATRIX)
    assert run("build", "--no-cache", "cells.yaml", "--all", "-o", "all/{name}.zip").exit_code == 0
    names = sorted(path.stem for path in (folder / "all").glob("*.zip"))
    assert len(names) == 4
    for name in names:
        assert run("build", "--no-cache", "cells.yaml", "--pick", name, "-o", "alone/{name}.zip").exit_code == 0
    turned = [word for name in reversed(names) for word in ("--pick", name)]
    assert run("build", "--no-cache", "cells.yaml", *turned, "-o", "turned/{name}.zip").exit_code == 0
    for name in names:
        expected = (folder / "all" / f"{name}.zip").read_bytes()
        assert (folder / "alone" / f"{name}.zip").read_bytes() == expected
        assert (folder / "turned" / f"{name}.zip").read_bytes() == expected


def test_a_page_is_the_same_in_another_process(folder: Path) -> None:
    arm = folder / "models" / "arm.xml"
    arm.write_text(ARM.replace('range="-90 90"', 'range="-90 90" damping="1" armature="0.1" frictionloss="0.2"'))
    for seed in ("1", "2"):
        done = process("view", "cell.yaml", "--html", f"{seed}.html", env=environment(PYTHONHASHSEED=seed))
        assert done.returncode == 0, done.stderr
    assert (folder / "1.html").read_bytes() == (folder / "2.html").read_bytes()


@pytest.mark.slow
def test_fetched_at_different_places_and_times(robots: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another store, another umask and a commit that came in between: with the lock the bytes are the same."""
    robots.commit(
        **{
            "arm/arm.xml": ARM,
            "arm/meshes/cover.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
            "arm/tool.xml": TOOL,
        }
    )
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.chdir(work)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "one"))
    (work / "cell.yaml").write_text(
        f"recipe: 1\nbase: {robots.reference('main')}\n"
        f"attach:\n  tool: {{model: '{robots.reference('main', 'arm/tool.xml')}', site: flange}}\n"
    )
    assert run("lock", "cell.yaml").exit_code == 0
    assert run("build", "--no-cache", "cell.yaml", "-o", "one.zip", "--locked").exit_code == 0
    robots.commit(**{"arm/tool.xml": TOOL.replace("0.01", "0.02")})
    done = process(
        "build",
        "--no-cache",
        "cell.yaml",
        "-o",
        "two.zip",
        "--locked",
        env=environment(MJCOMPOSE_CACHE=str(tmp_path / "two"), PYTHONHASHSEED="7", TZ="Asia/Tokyo"),
    )
    assert done.returncode == 0, done.stderr
    assert (work / "one.zip").read_bytes() == (work / "two.zip").read_bytes()


def test_a_lock_that_is_old_changes_no_model(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("build", "--no-cache", "cell.yaml", "-o", "one.zip").exit_code == 0
    assert run("lock", "cell.yaml").exit_code == 0
    lock = json.loads((folder / "cell.lock").read_text())
    lock["sources"]["./models/arm.xml"]["files"]["models/arm.xml"] = "0" * 64
    del lock["sources"]["./models/tool.xml"]
    (folder / "cell.lock").write_text(json.dumps(lock))
    monkeypatch.chdir(folder.parent)
    result = run("build", "--no-cache", "cell/cell.yaml", "-o", "two.zip")
    assert "warning[lock-stale]" in result.stderr and "warning[source-changed]" in result.stderr
    assert (folder / "one.zip").read_bytes() == (folder.parent / "two.zip").read_bytes()


@pytest.mark.parametrize("out", ["out.zip", "out.mjz", "out/"])
def test_source_date_epoch_changes_times_alone(folder: Path, monkeypatch: pytest.MonkeyPatch, out: str) -> None:
    def contents() -> dict[str, bytes]:
        if out == "out/":
            return {path.name: path.read_bytes() for path in (folder / out).rglob("*") if path.is_file()}
        with zipfile.ZipFile(folder / out) as bundle:
            return {name: bundle.read(name) for name in bundle.namelist()}

    found = []
    for epoch in (None, "1700000000", "0", "99999999999", "soon"):
        if epoch is not None:
            monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        result = run("build", "--no-cache", "cell.yaml", "-o", out, "--no-compile")
        assert result.exit_code in (0, 1), epoch
        if result.exit_code:
            assert "SOURCE_DATE_EPOCH" in result.stderr and epoch == "soon"
        else:
            found.append(contents())
    assert all(each == found[0] for each in found)

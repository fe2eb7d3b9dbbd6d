"""`--cluster`: the same models and words as without, whatever becomes of workers and connections."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli import balls
from cli.balls import MODEL
from tools.cluster.dask_cluster import Cluster, Way, wait_for

pytest.importorskip("distributed", reason="needs `mjcompose[cluster]`")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="signals")]

RECIPE = balls.RECIPE.replace("samples: 2", "samples: 3")
MANY = RECIPE.replace("[1, 2, -1]", "[1]")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    (here / "model.xml").write_text(MODEL)
    (here / "r.yaml").write_text(RECIPE)
    return here


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "dask").mkdir()
    found = Cluster(tmp_path / "dask")
    try:
        yield found
    finally:
        found.end()


@pytest.fixture(scope="module")
def two_workers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster for the tests that leave it whole."""
    found = Cluster(tmp_path_factory.mktemp("dask"))
    try:
        found.add(2)
        yield found
    finally:
        found.end()


def start(*words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "mjcompose", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def run(*words: str) -> tuple[int, str, str]:
    process = start(*words)
    said, faults = process.communicate(timeout=280)
    return (process.returncode, said, re.sub(r"(?m)^\d+/\d+ .*\n", "", faults))  # how far it is, every ten seconds


def whole_as_said(said: str) -> int:
    found = re.search(r"interrupted: (\d+) of \d+ are written and whole; `mjcompose build", said)
    assert found is not None, said
    return int(found[1])


def build(cluster: object, *words: str) -> tuple[int, str, str]:
    return run("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(cluster), *words)


def digests(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_local_is_the_same_as_without(folder: Path) -> None:
    """Models, faults and warnings, exit codes and tables; it is listened to on 127.0.0.1 with a key alone."""
    seen = []
    for words in (("--jobs", "2"), ("--cluster", "local", "--jobs", "2")):
        told = run("build", "r.yaml", "--all", "--no-cache", "-o", "out/{name}/", *words)
        seen.append((*told, digests(folder / "out")))
        (folder / "out").rename(folder / words[0])
    assert seen[0] == seen[1]
    assert seen[0][0] == 1 and seen[0][1].count("wrote out/ball") == 4


def test_a_check(folder: Path, two_workers: Cluster) -> None:
    seen = [
        run("check", "r.yaml", "--all", "--no-cache", *words)
        for words in (("--jobs", "1"), ("--cluster", str(two_workers.file)))
    ]
    assert seen[0] == seen[1] and seen[0][0] == 1


def test_workers_that_die_lose_nothing(folder: Path, cluster: Cluster) -> None:
    """Two of four are killed in the middle, and one that comes later works as well."""
    (folder / "r.yaml").write_text(MANY.replace("samples: 3", "samples: 160"))
    cluster.add(4)
    process = start("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(cluster.file))
    wait_for(lambda: len(list(folder.glob("out/ball*"))) >= 10)
    cluster.workers[0].kill()
    cluster.add()
    wait_for(lambda: len(list(folder.glob("out/ball*"))) >= 40)
    cluster.workers[1].kill()
    _, said = process.communicate(timeout=280)
    assert process.returncode == 0, said
    assert said.count("has ended; its cells go to others") == 2
    models = list(folder.glob("out/ball*"))
    assert len(models) == 161 and all((each / "manifest.json").exists() for each in models)
    assert len((folder / "out" / "models.csv").read_text().splitlines()) == 162
    assert not list(folder.glob("out/.*"))


def test_a_connection_that_is_cut_is_made_again(folder: Path, two_workers: Cluster) -> None:
    (folder / "r.yaml").write_text(MANY.replace("samples: 3", "samples: 80"))
    address = json.loads(two_workers.file.read_text())["address"]
    way = Way(int(address.rpartition(":")[2]))
    process = start("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", f"127.0.0.1:{way.port}")
    wait_for(lambda: len(list(folder.glob("out/ball*"))) >= 10)
    way.cut()
    _, said = process.communicate(timeout=280)
    way.end()
    assert process.returncode == 0, said
    assert "connecting to" in said and len(list(folder.glob("out/ball*"))) == 81


def test_a_scheduler_that_dies(folder: Path, cluster: Cluster) -> None:
    """One error, whole models, and the same command builds the rest."""
    (folder / "r.yaml").write_text(MANY.replace("samples: 3", "samples: 80"))
    cluster.add(2)
    process = start("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(cluster.file))
    wait_for(lambda: len(list(folder.glob("out/ball*"))) >= 10)
    cluster.scheduler.kill()
    _, said = process.communicate(timeout=280)
    assert process.returncode == 1 and said.count("error[cluster-unreachable]") == 1, said
    assert "Traceback" not in said and "models built" not in said
    models = list(folder.glob("out/ball*"))
    assert 10 <= whole_as_said(said) <= len(models)
    assert 10 <= len(models) < 81 and all((each / "manifest.json").exists() for each in models)
    code, again, _ = build("local", "--jobs", "2")
    assert code == 0 and again.count("is up to date") >= 10 and len(list(folder.glob("out/ball*"))) == 81


def test_an_interruption(folder: Path, two_workers: Cluster) -> None:
    (folder / "r.yaml").write_text(MANY.replace("samples: 3", "samples: 80"))
    process = start("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(two_workers.file))
    wait_for(lambda: len(list(folder.glob("out/ball*"))) >= 10)
    process.send_signal(2)
    _, said = process.communicate(timeout=60)
    whole = list(folder.glob("out/ball*"))
    assert process.returncode == 130 and whole_as_said(said) == len(whole)
    assert all((each / "manifest.json").exists() for each in whole) and not list(folder.glob("out/.*"))
    assert run("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(two_workers.file))[0] == 0


def test_another_mujoco_is_refused_before_anything_is_made(folder: Path, cluster: Cluster) -> None:
    other = folder / "other" / "mujoco-9.9.9.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: mujoco\nVersion: 9.9.9\n")
    cluster.add(1, PYTHONPATH=str(folder / "other"))
    code, said, faults = build(cluster.file)
    assert code == 1 and faults.count("error[cluster-worker]") == 1 and "has mujoco 9.9.9, and here it is" in faults
    assert "pip install 'mujoco==" in faults and not list(folder.glob("out/ball*")) and not said


def test_another_mjcompose_is_refused(folder: Path, cluster: Cluster) -> None:
    other = folder / "other" / "mjcompose"
    other.mkdir(parents=True)
    (other / "__init__.py").touch()
    (other / "base").mkdir()
    (other / "base" / "__init__.py").write_text('__version__ = "0.0.7"\n')
    cluster.add(1, PYTHONPATH=str(folder / "other"))
    code, _, faults = build(cluster.file)
    assert code == 1 and "has mjcompose 0.0.7 (" in faults and "install the same mjcompose there" in faults


@pytest.mark.parametrize("named", ["nowhere", "127.0.0.1:1", "model.xml"])
def test_what_is_no_cluster(folder: Path, named: str) -> None:
    code, said, faults = build(named)
    assert code == 1 and faults.count("error[cluster-unreachable]") == 1 and "Traceback" not in faults
    assert not (folder / "out").exists() and not said and "interrupted" not in faults

"""`--jobs` and `--shard`: any number of processes and parts gives the same bytes and the same words."""

from __future__ import annotations

import csv
import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from cli.balls import MODEL, RECIPE
from click.testing import CliRunner, Result
from mjcompose.base import runtime
from mjcompose.cli import build_cells, entry as process
from mjcompose.cli.entry import end_in_order
from mjcompose.cli.main import main
from mjcompose.cli.output import put
from mjcompose.pipeline.cache.builder import BuildResult


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    (tmp_path / "model.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text(RECIPE)
    return tmp_path


def run(*words: str) -> Result:
    return CliRunner().invoke(main, words, prog_name="mjcompose")


def digests(folder: Path, pattern: str = "*") -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob(pattern))
        if path.is_file()
    }


def test_any_number_of_processes_gives_the_same(folder: Path) -> None:
    """Models, faults and warnings, exit codes and tables; and what one number built, another knows."""
    seen = []
    for jobs in ("1", "3"):
        result = run("build", "r.yaml", "--all", "--no-cache", "--jobs", jobs, "-o", "out/{name}/")
        seen.append((result.exit_code, result.stdout, result.stderr, digests(folder / "out")))
        (folder / "out").rename(folder / f"out-{jobs}")
    assert seen[0] == seen[1]
    code, said, faults, files = seen[0]
    assert code == 1 and said.count("wrote out/ball") == 3 and {"samples.csv", "models.csv"} < files.keys()
    assert "6 of 9 cells failed" in faults and "check-failed" in faults


def test_the_cache_is_shared(folder: Path) -> None:
    first = run("build", "r.yaml", "--pick", "size=1", "--jobs", "2")
    assert first.exit_code == 0, first.output
    again = run("build", "r.yaml", "--pick", "size=1", "--jobs", "3")
    assert again.stdout.count("is up to date") == 3


def test_check_with_several(folder: Path) -> None:
    reports = []
    for jobs in ("1", "2"):
        result = run("check", "r.yaml", "--all", "--no-cache", "--jobs", jobs, "--junit", f"{jobs}.xml")
        reports.append((result.exit_code, result.output, (folder / f"{jobs}.xml").read_text()))
    assert reports[0] == reports[1] and reports[0][0] == 1 and "check-failed" in reports[0][1]


def test_shards_are_the_whole_together(folder: Path) -> None:
    (folder / "r.yaml").write_text(RECIPE.replace("[1, 2, -1]", "[1, 1.5]").replace("5000", "50000"))
    assert run("build", "r.yaml", "--all", "-o", "all/{name}/").exit_code == 0
    counts = []
    for number in range(1, 4):
        result = run("build", "r.yaml", "--all", "--shard", f"{number}/3", "-o", "parts/{name}/")
        assert result.exit_code == 0, result.output
        counts.append(result.stdout.count("wrote parts/ball"))
    assert counts == [2, 2, 2]
    assert digests(folder / "parts", "model.xml") == digests(folder / "all", "model.xml")
    rows = [row for n in range(1, 4) for row in table(folder / "parts" / f"samples-{n}-of-3.csv")]
    assert {row["model"]: row for row in rows} == {row["model"]: row for row in table(folder / "all" / "samples.csv")}


def table(path: Path) -> list[dict[str, str]]:
    """The rows; what a file has no column for, as that of a part without draws, is empty."""
    with path.open(newline="") as file:
        return [{name: text for name, text in row.items() if text} for row in csv.DictReader(file)]


def test_a_shard_without_cells(folder: Path) -> None:
    result = run("check", "r.yaml", "--pick", "size=1", "--sample", "0", "--shard", "2/2")
    assert (result.exit_code, result.stdout) == (0, "r.yaml: ok, 0 models\n")


@pytest.mark.parametrize("shard", ["0/3", "4/3", "3", "a/b", "1/0", "-1/3"])
def test_a_shard_that_is_none(folder: Path, shard: str) -> None:
    result = run("build", "r.yaml", "--all", f"--shard={shard}")
    assert result.exit_code == 2 and "write for instance `1/8`" in result.stderr


def test_shards_of_what_has_one_place(folder: Path) -> None:
    """Each part might have one model, and all of them would be the same file."""
    result = run("build", "r.yaml", "--pick", "size=1", "--shard", "1/3", "-o", "one.zip")
    assert result.exit_code == 2 and "several models cannot all be `one.zip`" in result.stderr


@pytest.mark.parametrize("words", [("--shard", "1/2"), ("--jobs", "2")])
def test_one_model_has_no_parts(folder: Path, words: tuple[str, ...]) -> None:
    result = run("build", "r.yaml", *words)
    assert result.exit_code == 2 and f"{words[0]} needs --all, --pick or --sample" in result.stderr


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_what_is_written_is_counted(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Though the signal comes between the moment when a model is in its place and the one when that is noted."""
    written = []

    def put_and_interrupt(*arguments: Any, **options: Any) -> BuildResult | None:
        made = put(*arguments, **options)
        written.append(made)
        if len(written) == 2:
            signal.raise_signal(signal.SIGINT)
        return made

    monkeypatch.setattr(build_cells, "put", put_and_interrupt)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        end_in_order()
        result = run("build", "r.yaml", "--pick", "size=1", "--jobs", "1", "-o", "out/{name}/")
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        process._exit_codes.clear()  # which are for a process that ends
        runtime._heard.clear()
    assert result.exit_code == 130 and "interrupted: 2 of 3 are written and whole" in result.stderr
    assert len(list(folder.glob("out/ball*"))) == 2


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption(folder: Path, number: int, code: int) -> None:
    """Whole models stay, no worker does, and the command says how to go on."""
    (folder / "r.yaml").write_text(RECIPE.replace("samples: 2", "samples: 400").replace("[1, 2, -1]", "[1]"))
    command = [sys.executable, "-m", "mjcompose", "build", "r.yaml", "--all", "--jobs", "3", "-o", "out/{name}/"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        for _ in range(600):
            if len(list(folder.glob("out/ball*"))) >= 12:
                break
            time.sleep(0.05)
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
    assert process.returncode == code, said
    whole = len(list(folder.glob("out/ball*")))
    assert f"interrupted: {whole} of 401 are written and whole" in said
    assert "--jobs 3" in said and not list(folder.glob("out/.*"))
    assert len(table(folder / "out" / "samples.csv")) == whole
    assert all((each / "manifest.json").exists() for each in folder.glob("out/ball*"))

"""Each change of the table does to a small model what the table says, and the compiled model is the same by it alone."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import venv
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco import environments, programs
from mjcompose.mujoco.environments import CompiledByVersion, Other, open_python
from mjcompose.mujoco.programs import ProgramError
from mjcompose.sources.context import Context
from mjcompose.tools.migrate.changes import ORDERED, TABLE, between
from mjcompose.tools.migrate.migrate import Migrated, Prover, installed, measured, migrate, read
from mjcompose.tree.history import RELEASED
from tools.migrate.features import FEATURES, Feature

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="
)
DUMP = Path(environments.__file__).with_name("dump.py")
MADE = Path(__file__).parents[3] / "build" / "mujocos"
IDS = [f"{index}-{each.name}" for index, each in enumerate(FEATURES)]


def written(feature: Feature, folder: Path) -> Path:
    model = folder / "model.xml"
    model.write_text(feature.model, encoding="utf-8")
    (folder / "t.png").write_bytes(PIXEL)
    return model


def migrated(
    feature: Feature, model: Path, adopt: tuple[str, ...] = (), values: dict[str, object] | None = None
) -> tuple[Migrated | None, Context]:
    context = Context(environment={}, folder=model.parent)
    unit = read(model, context)
    assert unit is not None, context.sink.diagnostics
    return migrate(unit, feature.before, feature.after, context, adopt, values), context


def test_every_change_has_a_feature() -> None:
    assert {each.name for each in TABLE} == {each.change for each in FEATURES}
    assert len({each.name for each in TABLE}) == len(TABLE)
    assert all(each.version in RELEASED and each.since in RELEASED for each in TABLE)
    assert list(ORDERED) == sorted(ORDERED, key=lambda each: RELEASED.index(each.version))


@pytest.mark.parametrize("feature", FEATURES, ids=IDS)
def test_what_becomes_of_a_model(feature: Feature, tmp_path: Path) -> None:
    model = written(feature, tmp_path)
    result, context = migrated(feature, model)
    assert context.sink.has_errors == feature.refuses, context.sink.diagnostics
    if result is None:
        assert all(each.code == "migrate-cannot" and each.span for each in context.sink.errors)
        assert any(feature.says in (each.help or "") for each in context.sink.errors)
        return
    text = result.files[model][1].decode()
    assert all(each in text for each in feature.written), text
    assert not any(each in text for each in feature.gone), text
    told = [each for each in result.meanings if each.change == feature.change]
    assert bool(told) == feature.warns, result.meanings
    if feature.written and feature.change != "texture-colors":
        without, _ = migrated(feature, model, (feature.change,))
        assert without is None or without.files[model][1] != result.files[model][1]


@pytest.mark.parametrize("feature", FEATURES, ids=IDS)
def test_there_and_back_is_the_same_text_where_nothing_changed(feature: Feature, tmp_path: Path) -> None:
    """A model that is not migrated keeps every character."""
    model = written(feature, tmp_path)
    context = Context(environment={}, folder=tmp_path)
    unit = read(model, context)
    assert unit is not None
    result = migrate(unit, feature.before, feature.before, context)
    assert result is not None
    assert not result.changed
    assert list(between(feature.before, feature.before)) == []


@cache
def _other(version: str) -> Other | str:
    """The MuJoCo of a version, or why it cannot be had: from `MJCOMPOSE_MUJOCOS`, or installed below `build`."""
    named = os.environ.get("MJCOMPOSE_MUJOCOS")
    try:
        if named is None and shutil.which("uv"):
            environment = {**os.environ, "MJCOMPOSE_PROGRAMS": str(MADE / "programs")}
            programs.install(version, environment, lambda words: None)
            return environments.kept(version, environment)
        return open_python(Path(named) / version if named else _install(version))
    except (ProgramError, OSError) as error:
        return str(error)
    except subprocess.CalledProcessError as error:
        return str(error.stderr)


def _install(version: str) -> Path:
    """An environment of MuJoCo alone, which takes all else from this one: in an eighth of the time of `install` without uv."""
    folder = MADE / version
    if not folder.exists():
        MADE.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=MADE) as made:
            inside = Path(made, version)
            venv.create(inside)
            site, ours = (
                Path(sysconfig.get_path("purelib", vars={"base": str(base), "platbase": str(base)}))
                for base in (inside, sys.prefix)
            )
            pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--only-binary", ":all:"]
            wanted = ["--target", str(site), f"mujoco=={version}"]
            subprocess.run([*pip, *wanted], check=True, capture_output=True, text=True)
            (site / "ours.pth").write_text(f"{ours}\n", encoding="utf-8")
            with suppress(OSError):  # another worker was sooner
                inside.rename(folder)
    return folder


_SERVES = """
import io, json, sys
sys.path.insert(0, sys.argv[1])
import dump
for line in sys.stdin:
    sys.argv = ["dump.py", *json.loads(line)]
    out, sys.stdout = sys.stdout, io.StringIO()
    dump.main()
    text, sys.stdout = sys.stdout.getvalue(), out
    print(text, flush=True)
"""


@pytest.fixture(scope="module")
def kept() -> Iterator[Callable[[Path, list[str], Path], dict[str, Any]]]:
    """Runs `dump.py` in one process for each Python: to start one takes longer than to compile these models."""
    started: dict[Path, subprocess.Popen[str]] = {}

    def run(python: Path, arguments: list[str], out: Path) -> dict[str, Any]:
        if python not in started:
            words = [str(python), "-B", "-c", _SERVES, str(DUMP.parent)]
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
            started[python] = subprocess.Popen(words, text=True, cwd=DUMP.parent, **pipes)  # type: ignore[call-overload]
        process = started[python]
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(json.dumps(arguments) + "\n")
        process.stdin.flush()
        said: dict[str, Any] = json.loads(process.stdout.readline())
        return said

    yield run
    for process in started.values():
        process.communicate()


def mujoco(version: str) -> Other:
    """The MuJoCo of a version, or the test is skipped."""
    found = _other(version)
    if isinstance(found, str):
        pytest.skip(f"MuJoCo {version} cannot be had: {found}")
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    "feature",
    [each for each in FEATURES if not each.refuses],
    ids=[name for name, each in zip(IDS, FEATURES, strict=True) if not each.refuses],
)
def test_the_compiled_model_is_the_same(
    feature: Feature,
    kept: Callable[[Path, list[str], Path], dict[str, Any]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By the MuJoCo of its version, and the other one; and with `shows` it is not without the change."""
    model = written(feature, tmp_path)
    others = {version: mujoco(version) for version in (feature.before, feature.after)}
    monkeypatch.setattr("mjcompose.mujoco.environments._run", kept)
    folders = [tmp_path / name for name in ("with", "without")]
    outcomes = []
    known: dict[str, CompiledByVersion] = {}
    for folder, adopt in zip(folders, ((), (feature.change,)), strict=True):
        folder.mkdir()
        prover = Prover(folder, others, lambda words: None, known)
        values = measured(prover.original(feature.before, model))
        result, _ = migrated(feature, model, adopt, values)
        if result is None:  # without the change there is a word that the other version does not know
            assert adopt
            outcomes.append(None)
            continue
        proof = prover.prove(result, model)
        assert proof.before is not None
        assert proof.before.error is None, proof.before.error
        assert proof.after is not None
        assert adopt or proof.after.error is None, proof.after.error
        outcomes.append(proof.outcome)
        if not adopt:
            told = {array for each in result.meanings for array in each.arrays}
            assert proof.outcome is not None
            left = [each.words() for each in proof.outcome.differences if each.array not in told]
            assert not left or told, left
            if not told:
                assert not left
    with_it, without = outcomes
    if feature.shows and without is not None:  # without the change it has a word that the other does not know
        assert {each.array for each in without.differences} - {each.array for each in with_it.differences}


def test_this_mujoco_is_in_the_table() -> None:
    assert installed() in RELEASED

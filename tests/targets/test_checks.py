"""The check `targets`: what a program lacks, and whether it reads the model."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from mjcompose.bundle.bundle import Bundle
from mjcompose.language.target_names import CONSUMERS
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.targets import read_back
from mjcompose.targets.read_back import READERS, ReaderProgram, interpreter, placed
from targets.models import PROBE, SELDOM

READER = """
import mujoco
from facts import of_mujoco, without_forces
def read(file):
    model = mujoco.MjModel.from_xml_path(file)
    for name, factor in CHANGED.items():
        getattr(model, name)[:] *= factor
    data = mujoco.MjData(model)
    def placed(rows):
        found = []
        for row in rows:
            data.qpos = row
            mujoco.mj_kinematics(model, data)
            found.append((data.xpos.copy(), data.xmat.copy()))
        return zip(*found)
    def moved(start, steps):
        free = without_forces(mujoco, model)
        data = mujoco.MjData(free)
        data.qpos = start
        for _ in range(steps):
            mujoco.mj_step(free, data)
        return data.qpos
    return of_mujoco("1", model, lambda name: getattr(model, name), placed=placed, moved=moved)
"""


def reader(**changed: float) -> str:
    """A program that is MuJoCo itself, with some arrays multiplied."""
    return READER.replace("CHANGED", repr(changed))


BALL = (
    "<mujoco><worldbody><body name='b'><joint name='swing' type='ball'/><geom size='.1'/></body></worldbody></mujoco>"
)


def checked(model: str, check: str, folder: Path, **environment: str) -> tuple[Bundle | None, Context]:
    (folder / "model.xml").write_text(model)
    recipe = folder / "recipe.yaml"
    recipe.write_text(
        f"recipe: 1\nallow: [license-missing]\nbase: ./model.xml\ncheck:\n  it: {{{check}}}\n", encoding="utf-8"
    )
    context = Context(folder=folder, environment=environment)
    built = build(ModelRequest(recipe), context)
    return (None if built is None else built.bundle), context


def told(context: Context) -> list[tuple[str, str]]:
    return [(each.code, each.message) for each in context.sink.diagnostics]


@pytest.fixture
def with_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program that is MuJoCo itself reads for MJX."""
    folder = tmp_path / "readers"
    folder.mkdir()
    monkeypatch.setattr(read_back, "_READERS", folder)
    monkeypatch.setattr(
        "mjcompose.targets.read_back.READERS", {"mjx": ReaderProgram("mjx", "it", "mujoco", ("mujoco",))}
    )
    return folder / "it.py"


def test_it_loads(with_reader: Path, tmp_path: Path) -> None:
    with_reader.write_text(reader())
    bundle, context = checked(SELDOM, "targets: {in: mjx, losses: warning}", tmp_path)
    assert bundle is not None and told(context) == []


def test_what_has_no_name_is_not_compared(with_reader: Path, tmp_path: Path) -> None:
    with_reader.write_text(reader())
    inner = '<body pos="0 0 .1"><joint/><geom size=".1"/></body><body pos="0 0 .2"><joint/><geom size=".2"/></body>'
    bundle, context = checked(
        SELDOM.replace('<geom class="bar"/>\n', f'<geom class="bar"/>{inner}\n', 1).replace(
            '<key name="home" qpos="0.4 0.1 0 0.2 0.2"/>', '<key name="home"/>'
        ),
        "targets: {in: mjx, losses: warning}",
        tmp_path,
    )
    assert bundle is not None and told(context) == []


def test_another_mass(with_reader: Path, tmp_path: Path) -> None:
    with_reader.write_text(reader(body_mass=2))
    bundle, context = checked(SELDOM, "targets: {in: [mjx], losses: warning}", tmp_path)
    assert bundle is None
    ((code, message),) = told(context)
    assert code == "check-failed"
    assert message.startswith("check `it`: `mjx` 1 reads another model: the mass of `stand` is ")
    (found,) = context.sink.diagnostics
    assert found.span is not None and (found.span.line, found.span.column) == (5, 23)


def test_what_the_target_loses_is_told_and_not_compared(with_reader: Path, tmp_path: Path) -> None:
    """MJX has no polynomials: they are not in the file, and what it reads has none."""
    with_reader.write_text(reader())
    bundle, context = checked(
        PROBE.replace('damping=".5"', 'damping=".5 9"'), "targets: {in: [mjx], losses: warning}", tmp_path
    )
    assert bundle is not None
    ((code, message),) = told(context)
    assert code == "target-loss"
    assert message == "check `it`: MJX ignores the higher terms of damping of 1 joint: `j1`; what is linear is read"


def test_a_program_that_ends_with_an_error(with_reader: Path, tmp_path: Path) -> None:
    with_reader.write_text("raise SystemExit('this file is not for me')")
    _, context = checked(SELDOM, "targets: {in: [mjx], losses: warning}", tmp_path)
    assert told(context) == [("check-failed", "check `it`: `mjx` does not read the model: this file is not for me")]


def test_a_model_that_is_refused(with_reader: Path, tmp_path: Path) -> None:
    with_reader.write_text(reader())
    model = BALL.replace("</mujoco>", '<option integrator="implicit"/></mujoco>')
    _, context = checked(model, "targets: {in: [mjx], losses: warning}", tmp_path)
    ((_, message),) = told(context)
    assert message == "check `it`: `mjx` does not read the model: option: MJX has no integrator `implicit`"


def test_a_program_that_is_not_installed(tmp_path: Path) -> None:
    bundle, context = checked(BALL, "targets: [drake]", tmp_path, **{CONSUMERS: str(tmp_path)})
    assert bundle is None
    (found,) = context.sink.errors
    assert found.code == "consumer-missing" and found.help is not None and "pip install drake" in found.help


def test_the_environment_that_is_named_comes_first(tmp_path: Path) -> None:
    reader = ReaderProgram("drake", "drake", "mujoco", ())
    assert interpreter(reader, {}) == sys.executable
    inside = tmp_path / "drake" / "bin"
    inside.mkdir(parents=True)
    (inside / "python").write_text("#!/bin/sh\nexit 0\n")
    (inside / "python").chmod(0o755)
    if sys.platform != "win32":
        assert interpreter(reader, {CONSUMERS: str(tmp_path)}) == str(inside / "python")
    assert interpreter(ReaderProgram("drake", "other", "no_such_module", ()), {CONSUMERS: str(tmp_path)}) is None


def test_what_a_simulator_lacks(tmp_path: Path) -> None:
    _, context = checked(SELDOM, "targets: {in: [mjx, warp, drake], read: false}", tmp_path)
    ((code, message),) = told(context)
    assert code == "check-failed" and message.startswith("check `it`: `drake` does not have all of the model: ")
    (found,) = context.sink.diagnostics
    assert found.span is not None and (found.span.line, found.span.column) == (5, 34)


def test_what_is_written_otherwise_is_not_lacking(tmp_path: Path) -> None:
    text = '<mujoco><worldbody><body name="b"><joint name="j" ref="30"/><geom size=".1"/></body></worldbody></mujoco>'
    bundle, context = checked(text, "targets: {in: [newton], read: false}", tmp_path)
    assert bundle is not None and told(context) == []


def test_a_package_stands_in_a_folder_of_its_name(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "package.xml").write_text("<package><name>arm</name></package>")
    assert placed(out, "model.urdf") == tmp_path / "arm" / "model.urdf"


def test_each_reader_has_its_program() -> None:
    folder = Path(read_back.__file__).with_name("readers")
    assert {each.program for each in READERS.values()} == {path.stem for path in folder.glob("[a-z]*.py")}

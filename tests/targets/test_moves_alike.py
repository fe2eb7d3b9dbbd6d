from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Fault
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.mujoco import environments
from mjcompose.mujoco.environments import Other, this_python
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.targets import read_back
from tools.migrate.test_upgrade import MODEL

OWN = mujoco.__version__


def checked(
    folder: Path, check: str, context: Context | None = None, *, model: str = MODEL
) -> tuple[list[tuple[str, str]], list[CheckOutcome]]:
    (folder / "m.xml").write_text(model)
    (folder / "r.yaml").write_text(f"recipe: 1\nbase: ./m.xml\ncheck: {{moves: {{moves_alike: {check}}}}}\n")
    context = context or Context(environment={}, folder=folder)
    outcomes: list[CheckOutcome] = []
    build(ModelRequest(folder / "r.yaml"), context, outcomes=outcomes)
    return [(each.code, each.message) for each in context.sink.errors], outcomes


@pytest.mark.parametrize("signal", ["qpos", "xpos"])
def test_the_same_version_moves_alike(tmp_path: Path, signal: str) -> None:
    found, (outcome,) = checked(tmp_path, f"{{as: mujoco=={OWN}, signal: {signal}, seconds: 0.1, tol: 1e-12}}")
    assert found == [] and outcome.values == {"apart": 0.0}


def test_a_key_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    ((code, message),), _ = checked(tmp_path, f"{{as: mujoco=={OWN}, seconds: 0.1, key: hom}}")
    assert code == "unknown-name" and "the keyframe `hom` does not exist" in message


def test_a_version_in_which_it_moves_differently(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another version, for which this one stands, gets a stiffer model."""

    class Stiffer(Other):
        def move(self, model: Path, out: Path, asked: object) -> dict[str, object]:
            model.with_name("other.xml").write_text(model.read_text().replace('kp="5"', 'kp="9"'))
            return super().move(model.with_name("other.xml"), out, asked)  # type: ignore[arg-type]

    monkeypatch.setattr(environments, "kept", lambda version, environment: Stiffer(this_python(), version))
    ((code, message),), (outcome,) = checked(tmp_path, "{as: mujoco==3.12, seconds: 0.5}")
    assert code == "check-failed"
    assert message.startswith("check `moves`: the model moves differently in MuJoCo 3.12.0: joint j: ")
    assert outcome.values["apart"] > 1e-3


def test_a_simulation_that_diverges_is_not_alike(tmp_path: Path) -> None:
    wild = MODEL.replace('damping=".1"', 'stiffness="1e9" springref="90"')
    ((code, message),), _ = checked(tmp_path, f"mujoco=={OWN}", model=wild)
    assert code == "check-failed" and "the simulation diverges in `" in message


def test_a_check_installs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stranger's recipe would choose what runs here. It names the command, which the user types."""
    monkeypatch.setattr("mjcompose.mujoco.programs.Process", None)
    context = Context(environment={"MJCOMPOSE_PROGRAMS": str(tmp_path / "programs")}, folder=tmp_path)
    found, _ = checked(tmp_path, "mujoco==3.13", context)
    assert found == [("consumer-missing", "check `moves`: MuJoCo 3.13.0 is not installed")]
    (error,) = context.sink.errors
    assert error.help == "run `mjcompose install mujoco==3.13.0`" and error.span is not None
    assert not (tmp_path / "programs").exists()


def test_a_program_that_others_can_change_is_not_run(tmp_path: Path) -> None:
    place = tmp_path / "programs" / "mujoco-3.13.0"
    (place / "bin").mkdir(parents=True)
    (place / ".ready").touch()
    (place / "bin" / "python").write_text(f"#!/bin/sh\ntouch {tmp_path}/ran\n")
    (place / "bin" / "python").chmod(0o755)
    (tmp_path / "programs").chmod(0o770)
    context = Context(environment={"MJCOMPOSE_PROGRAMS": str(tmp_path / "programs")}, folder=tmp_path)
    ((code, message),), _ = checked(tmp_path, "mujoco==3.13", context)
    assert code == "check-failed" and "is not run: others may use" in message
    assert not (tmp_path / "ran").exists()


def test_another_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, _ = checked(tmp_path, "drake")
    assert [code for code, _ in found] == ["consumer-missing"]
    monkeypatch.setattr("mjcompose.targets.read_back.motion_in", lambda *_: ({"j": 0.1, "slide": 0}, {"j": 0.3}))
    ((code, message),), _ = checked(tmp_path, "drake")
    assert code == "check-failed" and "in drake: joint j: 0.2 m or rad apart in `motion without forces`" in message
    monkeypatch.setattr("mjcompose.targets.read_back.motion_in", lambda *_: ({"j": 0.1}, {}))
    ((code, message),), _ = checked(tmp_path, "drake")
    assert code == "check-failed" and "nothing can be compared" in message
    ((code, _),), _ = checked(tmp_path, "{as: drake, signal: xpos}")
    assert code == "wrong-keyword"


@pytest.mark.slow
def test_drake_itself(tmp_path: Path) -> None:
    """The arm falls as in MuJoCo; it has moved, and a heavier one falls otherwise."""
    from mjcompose.targets.read_back import READERS, interpreter

    if interpreter(READERS["drake"], dict(os.environ)) is None:
        pytest.skip("drake is not installed")
    arm = MODEL.replace(MODEL[MODEL.index('    <body name="ball"') : MODEL.index("  </worldbody>")], "")
    arm = arm[: arm.index("  <actuator>")] + "</mujoco>"
    (tmp_path / "m.xml").write_text(arm)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./m.xml\ncheck: {moves: {moves_alike: {as: drake, seconds: 0.3}}}\n"
    )
    outcomes: list[CheckOutcome] = []
    ends: list[tuple[dict[str, float], dict[str, float]]] = []
    real = read_back.motion_in

    def kept(work: read_back.Work, name: str, seconds: float) -> object:
        found = real(work, name, seconds)
        assert not isinstance(found, Fault)
        ends.append(found)
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(read_back, "motion_in", kept)
        context = Context(folder=tmp_path)
        assert build(ModelRequest(tmp_path / "r.yaml"), context, outcomes=outcomes) is not None, context.sink.errors
    ((here, there),) = ends
    assert here.keys() == there.keys() == {"j"} and abs(there["j"]) > 0.1
    assert outcomes[0].values["apart"] == 0.0


@pytest.mark.parametrize("program", ["mujoco", "mujoco==2.3", "isaac"])
def test_programs_that_nobody_can_ask(tmp_path: Path, program: str) -> None:
    ((code, message),), _ = checked(tmp_path, program)
    assert (code, message) == ("wrong-keyword", f"`as` of check `moves` cannot be `{program}`")

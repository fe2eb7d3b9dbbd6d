from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import pytest
from fidelity import corpus, made, run
from fidelity.made import Made
from fidelity.summary import BEGIN, END


def test_the_table_is_printed_and_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = tmp_path / "models" / "robot.xml"
    robot.parent.mkdir()
    (tmp_path / "feature-cases").mkdir()
    robot.write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    monkeypatch.setenv("MJCOMPOSE_CORPUS", str(tmp_path))
    monkeypatch.setattr(corpus, "packaged", lambda: iter(()))
    page = tmp_path / "page.md"
    page.write_text(f"# Page\n{BEGIN}\n{END}\n")
    assert run.main(["--roundtrip", "--workers", "1", "--write", str(page)]) == 0
    out, err = capsys.readouterr()
    row = "| parse → write → compile: corpus | 1 | 1 (100 %) | 1 (100 %) |"
    assert row in out
    assert row in page.read_text(encoding="utf-8")
    assert "1 of 1" in err


def test_without_a_corpus_only_packages_are_read(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("MJCOMPOSE_CORPUS", raising=False)
    monkeypatch.setattr(corpus, "packaged", lambda: iter(()))
    assert run.main(["--roundtrip"]) == 0
    assert "names no corpus" in capsys.readouterr().err


@pytest.mark.mujoco4("the models have rods")
def test_what_is_made_holds(tmp_path: Path) -> None:
    """Some of each set."""
    for title, found in made.sets(tmp_path):
        for each in found[:: len(found) // 3]:
            verdict = made.judge(each)
            assert verdict.fine, (title, each.id, verdict.first_differences, verdict.diagnostics)


def damage_eq(model: mujoco.MjModel) -> None:
    model.eq_data[:, :6] += 0.05


def damage_key(model: mujoco.MjModel) -> None:
    model.key_act[0, -1] += 1


def damage_gain(model: mujoco.MjModel) -> None:
    model.actuator_gainprm[:, 0] *= 1.01


def damage_mass(model: mujoco.MjModel) -> None:
    model.body_mass[-1] *= 1.01


def damage_name(model: mujoco.MjModel) -> None:
    addresses = model.name_eqadr if model.neq else model.name_actuatoradr
    addresses[0] += 1


def damage_reference(model: mujoco.MjModel) -> None:
    model.sensor_refid[0] = model.body("link").id


@pytest.mark.mujoco4("the models have rods")
def test_what_is_asked_of_the_made_sees_a_damage(tmp_path: Path) -> None:
    asked = [found[0] for _, found in made.sets(tmp_path) if isinstance(found[0], Made)]
    damages = (damage_eq, damage_key, damage_gain, damage_mass, damage_name, damage_name, damage_reference)
    for each, damage in zip(asked, damages, strict=True):

        def ask(model: mujoco.MjModel, about: Made, folder: Path) -> list[str]:
            damage(model)  # noqa: B023
            return each.ask(model, about, folder)  # noqa: B023

        assert not made.judge(replace(each, ask=ask)).fine, each.id

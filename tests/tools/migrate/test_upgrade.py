"""The motion of a model in two versions of MuJoCo: what moves differently, by how much, and by which line."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.mujoco.environments import TRIALS, Motion, Other, differences, other_inertias, this_python
from mjcompose.mujoco.programs import ProgramError
from mjcompose.sources.context import Context
from mjcompose.tools.migrate.migrate import installed
from mjcompose.tools.migrate.upgrade import UpgradeRequest, upgrade
from tools.migrate.test_changes import mujoco

MODEL = """<mujoco model="m">
  <option timestep="0.005"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0" damping=".1"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/></body>
    <body name="ball" pos="0 1 1"><joint name="ball" type="ball"/><geom size=".05" pos=".1 0 0"/></body>
    <body name="slide" pos="0 2 1"><joint name="slide" type="slide"/><geom size=".05"/></body>
    <body name="box" pos="1 0 .1">
      <freejoint name="box"/>
      <geom type="box" size=".05 .04 .03" margin=".02" gap=".015"/>
    </body>
  </worldbody>
  <actuator><position name="j" joint="j" kp="5" ctrlrange="-1 1"/></actuator>
  <keyframe><key name="home" qpos=".3 1 0 0 0 0 1 0 .1 1 0 0 0" ctrl=".3"/><key name="up"/></keyframe>
</mujoco>
"""


def of_model(folder: Path, text: str, name: str = "m", **asked: object) -> Motion:
    (folder / f"{name}.xml").write_text(text)
    other = Other(this_python(), installed())
    request = {"seconds": 0.2, "trials": TRIALS, "key": None, **asked}
    return Motion.of(other, folder / f"{name}.xml", folder / f"{name}.npz", request)


def test_a_key_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match="the keyframe `hom` does not exist") as caught:
        of_model(tmp_path, MODEL, key="hom")
    assert caught.value.help == "name one of `home`, `up`"


def test_the_same_version_moves_alike(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(MODEL)
    context = Context(environment={}, folder=tmp_path)
    found = upgrade(UpgradeRequest("m.xml", installed(), None, seconds=0.1, tolerance=0), context, lambda _: None)
    assert found is not None and found.moved == found.diverged == ()
    assert found.trials == ("settle", "hold home", "step home", "drop home")


def test_what_differs_is_ranked_with_its_unit(tmp_path: Path) -> None:
    one = of_model(tmp_path, MODEL)
    changed = MODEL.replace('kp="5"', 'kp="9"').replace('type="slide"', 'type="slide" damping="1"')
    changed = changed.replace('type="ball"', 'type="ball" damping=".01"')
    other = of_model(tmp_path, changed, "n")
    found = differences(one, other, signal="qpos", tolerance=1e-4)
    assert {(each.kind, each.name, each.unit) for each in found} == {
        ("joint", "j", "rad"),
        ("joint", "ball", "rad"),
        ("joint", "slide", "m"),
    }
    amounts = [each.amount for each in found]
    assert amounts == sorted(amounts, reverse=True) and amounts[-1] > 1e-4
    assert all(0 < each.time <= 0.2 and each.trial in one.answer["trials"] for each in found)
    bodies = differences(one, other, signal="xpos", tolerance=1e-4)
    assert {each.name for each in bodies} == {"slide"}  # the others turn about their own origin
    assert differences(one, one, signal="xpos", tolerance=0) == []


def test_bodies_with_other_inertias_are_named(tmp_path: Path) -> None:
    one = of_model(tmp_path, MODEL)
    assert other_inertias(one, one) == []
    heavier = of_model(tmp_path, MODEL.replace('size=".05 .04 .03"', 'size=".05 .04 .0301"'), "n")
    assert other_inertias(one, heavier) == ["box"]
    shifted = of_model(tmp_path, MODEL.replace('pos=".1 0 0"', 'pos="0 .1 0"'), "o")
    assert other_inertias(one, shifted) == ["ball"]


def test_models_with_other_joints_are_not_compared(tmp_path: Path) -> None:
    one = of_model(tmp_path, MODEL)
    other = of_model(tmp_path, MODEL.replace('joint name="slide"', 'joint name="rail"'), "n")
    with pytest.raises(ProgramError, match="have other joints of the model"):
        differences(one, other, signal="qpos", tolerance=1)


def test_a_key_is_chosen_and_trials_that_make_no_sense_are_left_out(tmp_path: Path) -> None:
    assert of_model(tmp_path, MODEL, key="up").answer["trials"] == ["settle", "hold up", "step up", "drop up"]
    bare = '<mujoco><worldbody><body><joint/><geom size=".1"/></body></worldbody></mujoco>'
    found = of_model(tmp_path, bare)
    assert found.answer["trials"] == ["settle", "drop"] and found.answer["joints"][0][0] == "#0"


def test_a_model_that_diverges_or_is_rejected(tmp_path: Path) -> None:
    wild = MODEL.replace('damping=".1"', 'stiffness="1e9" springref="90"')
    assert of_model(tmp_path, wild).answer["diverged"]
    with pytest.raises(ProgramError, match="rejects the model: XML Error"):
        of_model(tmp_path, "<mujoco><wrong/></mujoco>")


def test_faults_of_the_request(tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(MODEL)
    for request in (
        UpgradeRequest("m.xml", "2.3", None, seconds=1, tolerance=0),
        UpgradeRequest("none.xml", "3.17", None, seconds=1, tolerance=0),
        UpgradeRequest("m.xml", "3.17", None, seconds=1, tolerance=0, pythons=(tmp_path / "python",)),
    ):
        context = Context(environment={}, folder=tmp_path)
        assert upgrade(request, context, lambda _: None) is None
        assert len(context.sink.errors) == 1


@pytest.mark.slow
@pytest.mark.skipif(installed() != "4.0.0", reason="compares with 4.0")
def test_another_version_and_the_line_that_moves_the_box(tmp_path: Path) -> None:
    """In MuJoCo 3.8, the `gap` was outside of the `margin`, and the box rests higher."""
    (tmp_path / "m.xml").write_text(MODEL)
    python = mujoco("3.8.1").python
    context = Context(environment={}, folder=tmp_path)
    request = UpgradeRequest("m.xml", "3.8.1", "4.0", seconds=1, tolerance=1e-3, pythons=(python,))
    found = upgrade(request, context, lambda _: None)
    assert found is not None, context.sink.errors
    first = found.moved[0]
    assert (first.moved.name, first.moved.unit) == ("box", "m") and 0.01 < first.moved.amount < 0.02
    (step,) = first.steps
    assert step.change == "gap" and step.span is not None and (step.span.file, step.span.line) == ("m.xml", 10)
    assert first.data()["causes"] == [{"change": "gap", "at": "m.xml:10:7", "edit": step.words}]
    both = MODEL.replace('size="1 1 1"', 'size="1 1 1" margin=".01"').replace(' gap=".015"', "")
    (tmp_path / "m.xml").write_text(both)
    request = UpgradeRequest("m.xml", "3.4.0", "4.0", seconds=1, tolerance=1e-3, pythons=(mujoco("3.4.0").python,))
    found = upgrade(request, context, lambda _: None)
    assert found is not None and found.moved[0].steps == ()
    assert [each.change for each in found.moved[0].suspects] == ["margins"]

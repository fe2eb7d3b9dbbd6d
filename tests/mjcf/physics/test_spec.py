from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, RootElement
from mjcompose.mujoco.attributes import save_digits


def test_a_composition_as_a_spec(arm: RootElement, gripper: RootElement) -> None:
    arm.find("site", "flange").attach(gripper)
    spec = arm.to_spec()
    assert isinstance(spec, mujoco.MjSpec)
    compiled = spec.compile()
    ours = arm.compile_model().model
    assert compiled.names == ours.names
    assert compiled.body_inertia.tolist() == ours.body_inertia.tolist()


def test_a_spec_as_a_model() -> None:
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="b")
    body.add_geom(name="g", size=[0.1, 0, 0])
    body.add_joint(name="j", axis=[0, 1, 0])
    model = mjcf.from_spec(spec)
    assert model.find("joint", "j").axis.tolist() == [0, 1, 0]
    assert model.find("geom", "g").parent is model.find("body", "b")
    assert model.compile_model().model.nq == 1


def test_there_and_back_with_files(arm: RootElement) -> None:
    back = mjcf.from_spec(arm.to_spec())
    assert back.compile_model().model.mesh_vert.tolist() == arm.compile_model().model.mesh_vert.tolist()


def test_what_cannot_be_converted() -> None:
    with pytest.raises(MjcfError, match="`spec` expects an `MjSpec`, got `str`"):
        mjcf.from_spec("<mujoco/>")
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(name="g")
    with pytest.raises(MjcfError, match="size 0 must be positive"):
        mjcf.from_spec(spec)
    model = mjcf.RootElement()
    model.actuator.add("motor", joint="nowhere")
    with pytest.raises(MjcfError, match="refers to the joint `nowhere`"):
        model.to_spec()


def test_a_model_with_models_in_it(tmp_path: Path) -> None:
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "tool.xml").write_text(
        '<mujoco><worldbody><body name="blade"><geom size="1"/></body></worldbody></mujoco>'
    )
    (tmp_path / "arm.xml").write_text(
        '<mujoco><asset><model name="tool" file="tools/tool.xml"/></asset>'
        '<worldbody><attach model="tool" body="blade" prefix="t_"/></worldbody></mujoco>'
    )
    assert mjcf.from_path(tmp_path / "arm.xml").to_spec().compile().body("t_blade").id == 1


_EXACT = pytest.mark.skipif(
    not hasattr(mujoco.MjSpec().compiler, "savecompiled"), reason="this MuJoCo writes six digits"
)


@_EXACT
def test_numbers_of_a_spec_are_kept_to_the_last_bit() -> None:
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="b", pos=[1 / 3, 0, 0])
    body.add_geom(name="g", size=[1 / 7, 0, 0], mass=1 / 9)
    body.add_joint(name="j", range=[-(2**0.5), 90])
    model = mjcf.from_spec(spec).compile_model().model
    expected = spec.compile()
    for field in ("body_pos", "body_mass", "geom_size", "jnt_range"):
        assert getattr(model, field).tolist() == getattr(expected, field).tolist()
    assert spec.compiler.savecompiled  # as it was


@_EXACT
def test_digits_that_mujoco_does_not_write_are_told() -> None:
    save_digits(mujoco, 6)  # MuJoCo's default is of the whole process, and another test may have changed it
    body = '<worldbody><body name="b" pos="0.123456789 0 0">{}<geom size="1"/></body></worldbody>'
    inertia = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    spec = mujoco.MjSpec.from_string(f'<mujoco><compiler inertiafromgeom="true"/>{body.format("")}</mujoco>')
    other = mujoco.MjSpec.from_string(f"<mujoco>{body.format(inertia)}</mujoco>")
    spec.attach(other, prefix="c/", frame=spec.worldbody.add_frame())
    with pytest.warns(mjcf.MjcfWarning, match="in six digits only: .*inertiafromgeom"):
        model = mjcf.from_spec(spec)
    assert model.find("body", "c/b").pos.tolist() == [0.123457, 0, 0]


def test_a_nan_is_not_lost_without_a_word() -> None:
    """MuJoCo 4.0 writes no attribute with a NaN, so that the geom is back at its default."""
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><body><geom name="g" size="1" pos="1 0 nan"/></body></worldbody></mujoco>'
    )
    with pytest.warns(mjcf.MjcfWarning, match=r"does not write NaN.*geom_pos"):
        model = mjcf.from_spec(spec)
    assert model.find("geom", "g").pos is None


def test_no_word_of_nan_where_all_are_numbers() -> None:
    """What a spec leaves to MuJoCo it has as NaN itself: masses, frictions of a class, orientations."""
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><frame pos="1 0 0"><body euler="1 2 3"><freejoint/><geom size="1"/></body></frame>'
        "</worldbody></mujoco>"
    )
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always", mjcf.MjcfWarning)
        mjcf.from_spec(spec)
    # MuJoCo before 3.16 writes six digits, which is a warning of its own.
    assert not [each for each in reported if "NaN" in str(each.message)]

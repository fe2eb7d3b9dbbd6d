"""What MJX and MuJoCo Warp refuse, and what other programs compute otherwise, is told before they do."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.targets.same import differences
from targets.refused import ALL, CARRIED, ELASTIC, model
from targets.writing import codes, compiled, losses, written

_POLYNOMIALS = 3_007_000  # of mj_version(): damping and stiffness of several numbers


@pytest.mark.parametrize(("target", "given", "told"), ALL)
def test_it_is_refused(target: str, given: dict[str, str], told: str, tmp_path: Path) -> None:
    bundle, context = written(model(**given), target, tmp_path)
    assert bundle is None
    assert [each.message for each in context.sink.errors] == [told]


@pytest.mark.parametrize("target", ["mjx", "warp"])
def test_what_they_have(target: str, tmp_path: Path) -> None:
    more = '<actuator><position joint="j" kp="3"/><muscle joint="j" lengthrange="0 1"/></actuator>'
    text = model(option='integrator="implicitfast" cone="elliptic"', joint='damping="1"', more=more)
    bundle, context = written(text, target, tmp_path)
    assert bundle is not None and codes(context) == []
    text = text.replace('model="m"', 'model="recipe"')
    before = mujoco.MjModel.from_xml_string(text)
    after = compiled(bundle, tmp_path / "out")
    assert [after.opt.integrator, after.opt.cone] == [before.opt.integrator, before.opt.cone]
    assert list(differences(before, after)) == []


@pytest.mark.parametrize(
    "given",
    [
        {"option": 'integrator="discrete"', "more": ELASTIC},
        {"option": 'integrator="discrete" solver="CG"', "more": CARRIED},
    ],
    ids=["in the world", "with CG"],
)
@pytest.mark.mujoco4("it has no such integrator, or no such flexes")
def test_flexes_that_warp_has(given: dict[str, str], tmp_path: Path) -> None:
    bundle, _ = written(model(**given), "warp", tmp_path)
    assert bundle is not None


@pytest.mark.mujoco4("it has no pid")
@pytest.mark.parametrize(("target", "name"), [("mjx", "MJX"), ("warp", "MuJoCo Warp")])
def test_neither_has_a_pid(target: str, name: str, tmp_path: Path) -> None:
    more = '<actuator><pid name="a" joint="j" kp="3" ki="1" kv="1" input="pos"/></actuator>'
    bundle, context = written(model(more=more), target, tmp_path)
    assert bundle is None and all(f"{name} has no such" in each.message for each in context.sink.errors)


@pytest.mark.parametrize(
    ("target", "given", "told"),
    [
        (
            "drake",
            {"option": 'timestep=".01" cone="elliptic"'},
            "Drake ignores `timestep`, `cone`; it has settings of its own",
        ),
        ("pybullet", {"flags": '<flag contact="disable"/>'}, "PyBullet ignores `flag`; it has settings of its own"),
        ("pinocchio", {"option": 'gravity="0 0 -1.6"'}, "Pinocchio ignores gravity; set it to 0 0 -1.6 in the program"),
        ("newton", {"option": 'gravity="0 0 -1.6"'}, "Newton ignores gravity; set it to 0 0 -1.6 in the program"),
        (
            "drake",
            {"geom": 'solref=".01 1" condim="4"'},
            "Drake ignores `solref`, `condim` of the contacts of 1 geom: `g`",
        ),
        ("drake", {"geom": 'friction=".5 .1"'}, "Drake ignores torsional friction of the contacts of 1 geom: `g`"),
        ("urdf", {"geom": 'friction=".5"'}, "URDF ignores sliding friction of the contacts of 1 geom: `g`"),
        (
            "drake",
            {"geom": 'contype="2"'},
            "Drake ignores `contype` and `conaffinity` of 1 geom: `g`; they collide with everything",
        ),
        ("drake", {"joint": 'range="-1 1" margin=".1"'}, "Drake ignores `margin` of the limits of 1 joint: `j`"),
        ("drake", {"body": 'gravcomp="1"'}, "Drake ignores `gravcomp` of 1 body: `b`; all of their weight pulls"),
    ],
)
def test_it_is_lost(target: str, given: dict[str, str], told: str, tmp_path: Path) -> None:
    plain = losses(written(model(), target, tmp_path)[1])
    bundle, context = written(model(**given), target, tmp_path)
    assert bundle is not None and losses(context).keys() - plain.keys() == {told}


def test_what_drake_reads_is_not_lost(tmp_path: Path) -> None:
    text = model(option='gravity="0 0 -1.6" iterations="9" tolerance="1e-5"', geom='friction=".5"')
    plain = losses(written(model(), "drake", tmp_path)[1])
    assert losses(written(text, "drake", tmp_path)[1]).keys() == plain.keys()


@pytest.mark.parametrize(
    ("target", "given", "told"),
    [
        ("pybullet", {"joint": 'damping=".1"'}, "PyBullet ignores damping of 1 joint: `j`"),
        ("pybullet", {"joint": 'frictionloss=".1"'}, "PyBullet ignores dry friction of 1 joint: `j`"),
        ("pybullet", {"joint": 'armature=".1"'}, "PyBullet ignores armature of 1 joint: `j`"),
        ("pybullet", {"joint": 'actuatorfrcrange="-1 1"'}, "PyBullet ignores the greatest force of 1 joint: `j`"),
        (
            "pybullet",
            {"geom": 'type="ellipsoid" fromto="0 0 0 0 0 .1"'},
            "PyBullet ignores the ellipsoid of 1 geom: `g`",
        ),
        (
            "drake",
            {"geom": 'contype="0" conaffinity="0" group="3"'},
            "Drake ignores 1 geom: `g`; they neither collide nor are shown",
        ),
        (
            "drake",
            {"joint": 'armature=".1"'},
            "Drake ignores armature of 1 joint: `j`; it reads that of joints with an actuator",
        ),
        (
            "drake",
            {"joint": 'damping="1 2"'},
            "Drake ignores the higher terms of damping of 1 joint: `j`; what is linear is read",
        ),
        (
            "drake",
            {"more": '<actuator><position name="a" joint="j" kp="2" kv="1"/></actuator>'},
            "Drake ignores `kv` of 1 actuator: `a`",
        ),
        (
            "drake",
            {"more": '<actuator><motor name="a" joint="j" ctrlrange="0 1"/></actuator>'},
            "Drake ignores the narrower side of `ctrlrange` of 1 actuator: `a`; it has the same limit on both sides",
        ),
        (
            "drake",
            {"more": '<actuator><motor name="a" joint="j" gear="2"/></actuator>'},
            "Drake gets 1 actuator: `a` in another form: their gear is in their gains, and controls are at the joint",
        ),
        ("pinocchio", {"joint": 'type="ball" damping="1"'}, "Pinocchio ignores damping of 1 joint: `j`"),
        ("newton", {"joint": 'type="free" armature="1"'}, "Newton ignores armature of 1 joint: `j`"),
        (
            "newton",
            {"more": '<actuator><motor name="a" joint="j" gear="2"/></actuator>'},
            "Newton ignores `gear` of 1 actuator: `a`; its solvers other than MuJoCo take the gains as they are",
        ),
        (
            "genesis",
            {"joint": 'stiffness="1" springref="9"'},
            "Genesis ignores stiffness of 1 joint: `j`; it has springs that rest at zero",
        ),
        (
            "genesis",
            {"joint": 'armature="0"'},
            "Genesis gets 1 joint: `j` in another form: it adds an armature of 0.1 unless you load it with `default_armature=None`",
        ),
    ],
)
def test_numbers_that_are_not_read(target: str, given: dict[str, str], told: str, tmp_path: Path) -> None:
    if "damping=" in str(given) and " 2" in str(given) and mujoco.mj_version() < _POLYNOMIALS:
        pytest.skip("this MuJoCo has no polynomials")
    bundle, context = written(model(**given), target, tmp_path)
    assert bundle is not None and told in losses(context)


@pytest.mark.parametrize("target", ["newton", "pinocchio", "genesis"])
def test_a_force_range_is_carried_to_the_joint(target: str, tmp_path: Path) -> None:
    more = '<actuator><position name="a" joint="j" kp="2" forcerange="-3.5 3.5"/></actuator>'
    bundle, _ = written(model(more=more), target, tmp_path)
    assert bundle is not None
    joint = etree.fromstring(bundle.files["model.xml"]).find(".//joint[@name='j']")
    assert joint is not None and joint.get("actuatorfrcrange") == "-3.5 3.5"


def test_drake_gets_no_limit_without_a_range(tmp_path: Path) -> None:
    """`ctrllimited` alone would limit the torque to zero."""
    more = '<actuator><position name="a" joint="j" kp="2" ctrlrange="-1 1" ctrllimited="true"/></actuator>'
    bundle, _ = written(model(more=more), "drake", tmp_path)
    assert bundle is not None and b"ctrllimited" not in bundle.files["model.xml"]


@pytest.mark.parametrize(("target", "kept"), [("pinocchio", False), ("drake", False), ("newton", True)])
def test_height_fields(target: str, kept: bool, tmp_path: Path) -> None:
    text = """<mujoco><asset><hfield name="t" nrow="2" ncol="2" size="1 1 .1 .1" elevation="0 0 0 1"/></asset>
      <worldbody><geom name="hills" type="hfield" hfield="t"/><body><joint/><geom size=".1"/></body></worldbody></mujoco>"""
    bundle, context = written(text, target, tmp_path)
    assert bundle is not None and (b"<hfield" in bundle.files["model.xml"]) is kept
    assert any("the height field of 1 geom: `hills`" in each for each in losses(context)) is not kept


def test_losses_are_one_warning(tmp_path: Path) -> None:
    joints = "".join(f'<body><joint name="j{n}" damping="1" stiffness="2"/><geom size=".1"/></body>' for n in range(6))
    text = f"<mujoco><worldbody>{joints}</worldbody></mujoco>"
    bundle, context = written(text, "pybullet", tmp_path)
    assert bundle is not None and codes(context) == ["target-loss"]
    assert "PyBullet ignores damping of 6 joints: `j0`, `j1`, `j2` and 3 more" in losses(context)
    about = json.loads(bundle.files["manifest.json"])["target"]["left_out"]
    (named,) = [each["names"] for each in about if each["feature"] == "damping of joints"]
    assert named == [f"j{n}" for n in range(6)]

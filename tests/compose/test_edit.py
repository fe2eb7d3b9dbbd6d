"""What each verb does to the compiled model, and that it does nothing else: MuJoCo's arrays, by name."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from link.test_files import skin

from composer.compose.foresee import foresee
from composer.context import Context
from composer.diagnostics import Severity
from composer.plan.planner import make_plan
from composer.stages import Request, build

ARM = """\
<mujoco model="arm">
  <compiler angle="{angle}" autolimits="true"/>
  <default>
    <default class="link">
      <geom type="capsule" size="0.03" friction="0.8"/>
      <joint axis="0 1 0" damping="2" range="{range}"/>
      <position kp="100" kv="10" ctrlrange="-1 1" forcerange="-50 50"/>
      <default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>
    </default>
  </default>
  <asset><material name="steel" rgba=".5 .5 .5 1"/></asset>
  <worldbody>
    <light name="sun" pos="0 0 3"/>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="base" pos="0 0 .1" childclass="link">
      <geom name="base_geom" type="cylinder" size=".1 .05" material="steel"/>
      <body name="link1" pos="0 0 .1">
        <joint name="shoulder"/>
        <geom name="upper" fromto="0 0 0 0 0 .3" mass="1"/>
        <geom name="visual_upper" class="visual" fromto="0 0 0 0 0 .3" mass="0"/>
        <body name="link2" pos="0 0 .3">
          <inertial pos="0 0 .1" mass="2" diaginertia=".02 .02 .003"/>
          <joint name="elbow" ref="{ref}"/>
          <geom name="lower" fromto="0 0 0 0 0 .2"/>
          <frame pos="0 0 .2"><site name="tip"/></frame>
          <body name="tray" pos="0 0 .2">
            <geom type="box" size=".1 .1 .01"/>
            <geom type="box" size=".01 .1 .02" pos=".1 0 0"/>
          </body>
        </body>
      </body>
    </body>
    <body name="prop" pos="1 0 .1"><freejoint name="free"/><geom name="ball" size=".05"/></body>
  </worldbody>
  <contact><exclude name="no" body1="base" body2="link1"/></contact>
  <actuator>
    <position name="a1" joint="shoulder" class="link"/>
    <position name="a2" joint="elbow" class="link" kp="50"/>
    <motor name="m1" joint="elbow" ctrlrange="-3 3"/>
    <velocity name="v1" joint="shoulder" kv="4"/>
    <position name="f1" joint="shoulder" kp="7" timeconst="0.2"/>
    <general name="g1" joint="shoulder" gainprm="20" biastype="affine" biasprm="0 -20 -3"/>
  </actuator>
  <sensor><jointpos name="s1" joint="elbow"/><framepos name="s2" objtype="site" objname="tip"/></sensor>
  <keyframe>
    <key name="home" qpos=".1 .2 1 0 .1 1 0 0 0" qvel="1 2 3 4 5 6 7 8" ctrl=".1 .2 .3 .4 .5 .6" act=".7"/>
    <key name="other" qpos=".3 .4 1 0 .1 1 0 0 0"/>
  </keyframe>
</mujoco>
"""
RADIANS = ARM.format(angle="radian", range="-1.5 1.5", ref="0.2")
DEGREES = ARM.format(angle="degree", range="-90 90", ref="10")
NAMES = {
    "body": mujoco.mjtObj.mjOBJ_BODY, "jnt": mujoco.mjtObj.mjOBJ_JOINT, "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "site": mujoco.mjtObj.mjOBJ_SITE, "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR,
    "sensor": mujoco.mjtObj.mjOBJ_SENSOR, "key": mujoco.mjtObj.mjOBJ_KEY, "light": mujoco.mjtObj.mjOBJ_LIGHT,
    "exclude": mujoco.mjtObj.mjOBJ_EXCLUDE, "mat": mujoco.mjtObj.mjOBJ_MATERIAL,
}  # fmt: skip
COUNTS = {"actuator": "nactuator" if hasattr(mujoco.MjModel, "nactuator") else "nu"}
# Derived of masses and poses of the whole model.
DERIVED = ("subtreemass", "invweight0", "acc0", "sameframe", "bvh", "weldid", "rootid", "treeid", "simple", "adr", "actuator_length0",
           "parentid", "bodyid", "id", "num", "M0", "user", "aabb", "signature", "lightid", "trntype", "plugin", "rbound", "history", "poslocal", "poscom0", "length0", "body_margin")  # fmt: skip

Arrays = dict[tuple[str, str, str], list[float]]


class Case:
    """A folder with `arm.xml` in which recipes are built."""

    def __init__(self, folder: Path, text: str) -> None:
        self.folder = folder
        (folder / "arm.xml").write_text(text)
        self.context = Context(environment={}, folder=folder)

    def text(self, recipe: str) -> str:
        (self.folder / "recipe.yaml").write_text(recipe)
        self.context = Context(environment={}, folder=self.folder)
        built = build(Request(self.folder / "recipe.yaml", verified=False), self.context)
        assert built is not None, [each.message for each in self.context.sink.diagnostics]
        return built.bundle.files["model.xml"].decode()

    def model(self, recipe: str) -> mujoco.MjModel:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return mujoco.MjModel.from_xml_string(self.text(recipe))

    def edited(self, edits: str, own: bool = False, head: str = "") -> mujoco.MjModel:
        where = f"base: {{model: ./arm.xml, edit: [{edits}]}}" if own else f"base: ./arm.xml\nedit: [{edits}]"
        return self.model(f"recipe: 1\n{head}{where}\n")

    def told(self, edits: str, head: str = "") -> list[str]:
        """Place and code of every fault."""
        (self.folder / "recipe.yaml").write_text(f"recipe: 1\n{head}base: ./arm.xml\nedit:\n  - {edits}\n")
        self.context = Context(environment={}, folder=self.folder)
        assert build(Request(self.folder / "recipe.yaml", verified=False), self.context) is None
        return [f"{each.span.column} {each.code}" for each in self.context.sink.errors if each.span]

    @property
    def said(self) -> str:
        return "\n".join(
            f"{each.message}\n{chr(10).join(note.message for note in each.notes)}\n{each.help or ''}"
            for each in self.context.sink.diagnostics
        )


@pytest.fixture(params=["radian", "degree"])
def arm(request: pytest.FixtureRequest, tmp_path: Path) -> Case:
    return Case(tmp_path, RADIANS if request.param == "radian" else DEGREES)


@pytest.fixture
def radian(tmp_path: Path) -> Case:
    return Case(tmp_path, RADIANS)


@pytest.fixture(params=[False, True], ids=["whole", "own"])
def own(request: pytest.FixtureRequest) -> bool:
    own: bool = request.param
    return own


def arrays(model: mujoco.MjModel) -> Arrays:
    """Every number that belongs to an element with a name, by kind, name and array."""
    found: Arrays = {}
    for kind, code in NAMES.items():
        for array in [name for name in dir(model) if name.startswith(f"{kind}_")]:
            if any(word in array.removeprefix(kind) or word == array for word in DERIVED):
                continue
            values = getattr(model, array)
            for row in range(len(values)) if isinstance(values, np.ndarray) else ():
                name = mujoco.mj_id2name(model, code, row)
                if name is not None:
                    found[kind, name, array.removeprefix(f"{kind}_")] = np.ravel(values[row]).tolist()
        for row in range(getattr(model, COUNTS.get(kind, f"n{kind}"))):
            if name := mujoco.mj_id2name(model, code, row):
                found[kind, name, "name"] = []
    for joint in range(model.njnt):
        name = mujoco.mj_id2name(model, NAMES["jnt"], joint)
        found["jnt", name, "ref"] = [float(model.qpos0[model.jnt_qposadr[joint]])]
        for array in ("dof_damping", "dof_armature", "dof_frictionloss"):
            found["jnt", name, array] = np.ravel(getattr(model, array)[model.jnt_dofadr[joint]]).tolist()
    return found


def changed(before: mujoco.MjModel, after: mujoco.MjModel) -> set[str]:
    """`NAME ARRAY` of all that differs, `+NAME` and `-NAME` of what is new or gone."""
    old, new = arrays(before), arrays(after)
    names_before, names_after = {key[:2] for key in old}, {key[:2] for key in new}
    found = {f"+{name}" for _, name in names_after - names_before}
    found |= {f"-{name}" for _, name in names_before - names_after}
    return found | {
        f"{key[1]} {key[2]}" for key in old.keys() & new.keys() if not np.array_equal(old[key], new[key])
    }


@pytest.mark.parametrize(
    ("edits", "expected"),
    [
        ("{select: {joint: elbow}, set: {armature: 0.3}}", {"elbow dof_armature"}),
        ("{select: {joint: '{shoulder,elbow}'}, scale: {damping: 0.5}}", {"shoulder dof_damping", "elbow dof_damping"}),
        ("{select: {joint: elbow}, offset: {ref: 5deg}}", {"elbow ref"}),
        ("{select: {joint: elbow}, set: {range: [-20deg, 1rad]}}", {"elbow range"}),
        ("{select: {joint: elbow}, set: {'range[1]': 30deg}}", {"elbow range"}),
        ("{select: {geom: upper}, set: {'friction[1]': 0.1}}", {"upper friction"}),
        ("{select: {geom: upper}, set: {friction: [1, 0.1]}}", {"upper friction"}),
        ("{select: {geom: upper}, unset: [mass], set: {density: 1}}", {"link1 mass", "link1 inertia"}),
        ("{select: {geom: base_geom}, set: {euler: [90deg, 0, 0]}}", {"base_geom quat", "base iquat"}),
        ("{select: {geom: '**', class: link, where: {group: 2}}, set: {rgba: [1, 0, 0, 1]}}", {"visual_upper rgba"}),
        ("{select: {geom: '**', in: {body: link1}, where: '${size[0] == 0.03 and group == 0}'}, set: {condim: 4}}", {"upper condim", "lower condim"}),
        ("{select: {geom: '*', parent: {body: link1}}, set: {solmix: 2}}", {"upper solmix", "visual_upper solmix"}),
        ("{select: {geom: '/(upper|lower)/'}, set: {gap: 0.01}}", {"upper gap", "lower gap"}),
        ("{select: {default: visual}, set: {geom: {group: 3}}}", {"visual_upper group"}),
        ("{select: {default: link}, scale: {joint: {damping: 3}}}", {"shoulder dof_damping", "elbow dof_damping"}),
        ("{select: {xpath: 'worldbody/geom[1]'}, set: {rgba: [1, 1, 1, 1]}}", {"floor rgba"}),
        ("{select: {body: link2}, set: {gravcomp: 1}}", {"link2 gravcomp"}),
        ("{select: {body: link2}, scale: {mass: 1.5}}", {"link2 mass", "link2 inertia"}),
        ("{select: {body: link1}, scale: {mass: 1.5}}", {"link1 mass", "link1 inertia"}),
        ("{select: {body: prop}, set: {mass: 3}}", {"prop mass", "prop inertia"}),
        ("{select: {site: tip}, move: {to: tray, pos: [0, 0, 0.3]}}", {"tip pos"}),
        ("{select: {geom: upper}, rename: '${name}_${parent}'}", {"-upper", "+upper_link1"}),
        ("{select: {key: other}, remove: true}", {"-other"}),
        ("{select: {sensor: s1}, remove: true}", {"-s1"}),
        ("{select: {site: tip}, remove: cascade}", {"-tip", "-s2"}),
        ("{select: {material: steel}, remove: cascade}", {"-steel"}),
        ("{select: {actuator: a1}, set: {kp: 3, 'forcerange[1]': 20}}", {"a1 gainprm", "a1 biasprm", "a1 forcerange"}),
        ("{select: {actuator: '?1', where: {joint: shoul*}}, set: {gear: [2]}}", {f"{each} gear" for each in ("a1", "v1", "f1", "g1")}),
        ("{select: {actuator: '?1', where: {joint: '/sho.+r/'}}, set: {gear: [2]}}", {f"{each} gear" for each in ("a1", "v1", "f1", "g1")}),
    ],
)  # fmt: skip
def test_a_verb_changes_what_it_says(arm: Case, edits: str, expected: set[str]) -> None:
    """In a whole model in radians, and in a part alone in degrees."""
    own = "degree" in (arm.folder / "arm.xml").read_text()
    before = arm.model("recipe: 1\nbase: ./arm.xml\n")
    assert changed(before, arm.edited(edits, own)) == expected


def test_angles_are_in_the_unit_of_the_recipe(arm: Case, own: bool) -> None:
    """Bare ones, and what is there now."""
    edits = "{select: {joint: elbow}, set: {range: [-45, 30]}}, {select: {joint: elbow}, offset: {range: [5, -10]}}"
    model = arm.edited(edits, own, "angle: degree\n")
    assert model.joint("elbow").range == pytest.approx(np.radians([-40, 20]), abs=1e-12)
    doubled = "{select: {joint: shoulder}, set: {range: ['${value - 10}', '${value}']}}"
    now = arm.model("recipe: 1\nbase: ./arm.xml\n").joint("shoulder").range
    model = arm.edited(doubled, own, "angle: degree\n")
    assert model.joint("shoulder").range == pytest.approx(now - np.radians([10, 0]), abs=1e-12)


def test_without_a_unit_values_are_in_radians_and_say_so(arm: Case) -> None:
    now = arm.model("recipe: 1\nbase: ./arm.xml\n").joint("shoulder").range
    model = arm.edited("{select: {joint: shoulder}, set: {range: ['${value / 2}rad', '${value / 2}rad']}}")
    assert model.joint("shoulder").range == pytest.approx(now / 2, abs=1e-12)
    assert arm.told("{select: {joint: shoulder}, set: {range: ['${value}', 1]}}") == ["46 bare-angle"]


@pytest.mark.parametrize("body", ["link1", "link2", "tray", "base"])
def test_a_mass_is_the_whole_inertia(radian: Case, body: str) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n").body(body)
    for verb, value, factor in (
        ("scale", 1.25, 1.25),
        ("set", 3, 3 / before.mass[0]),
        ("offset", 0.5, 1 + 0.5 / before.mass[0]),
        ("set", "'${2 * value}'", 2),
    ):
        after = radian.edited(f"{{select: {{body: {body}}}, {verb}: {{mass: {value}}}}}").body(body)
        assert after.mass == pytest.approx(factor * before.mass, rel=1e-12)
        assert after.inertia == pytest.approx(factor * before.inertia, rel=1e-12)
        assert after.ipos == pytest.approx(before.ipos) and after.iquat == pytest.approx(before.iquat)


def test_a_mass_under_rules_for_the_whole_model(tmp_path: Path) -> None:
    """`settotalmass` has been applied before a body is changed."""
    arm = Case(tmp_path, RADIANS.replace('autolimits="true"', 'settotalmass="20"'))
    before = arm.model("recipe: 1\nbase: ./arm.xml\n")
    after = arm.edited("{select: {body: link2}, scale: {mass: 2}}")
    assert after.body("link2").mass == pytest.approx(2 * before.body("link2").mass)
    assert after.body("base").mass == pytest.approx(before.body("base").mass)


def test_a_body_that_moves_keeps_the_class_around_it(radian: Case, own: bool) -> None:
    """Its geoms and joints name no class: the `childclass` of the old place goes with it."""
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited("{select: {body: link2}, move: {to: world}}", own)
    for model in (before, after):
        assert (
            model.geom("lower").friction[0] == 0.8
            and model.geom("lower").type[0] == mujoco.mjtGeom.mjGEOM_CAPSULE
        )
        assert model.joint("elbow").damping[0] == 2 and model.joint("elbow").axis.tolist() == [0, 1, 0]


# -- rename and remove ------------------------------------------------------------------------------------------


def test_every_reference_follows_a_rename(radian: Case, own: bool) -> None:
    edits = (
        "{select: {joint: elbow}, rename: bend}, {select: {body: '*'}, rename: 'b_${name}'},"
        "{select: {site: tip}, rename: tool}, {select: {material: steel}, rename: iron},"
        "{select: {default: link}, rename: limb}, {select: {actuator: a2}, rename: drive}"
    )
    before, after = radian.model("recipe: 1\nbase: ./arm.xml\n"), radian.edited(edits, own)
    assert after.joint("bend").range == pytest.approx(before.joint("elbow").range)
    for array in (
        "actuator_trnid",
        "sensor_objid",
        "geom_matid",
        "exclude_signature",
        "key_qpos",
        "dof_damping",
    ):
        assert np.array_equal(getattr(before, array), getattr(after, array))
    assert after.actuator("drive").trnid[0] == after.joint("bend").id


def test_two_names_may_change_places(radian: Case) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(
        "{select: {joint: '{shoulder,elbow}'}, rename: \"${'elbow' if name == 'shoulder' else 'shoulder'}\"}"
    )
    assert after.joint("elbow").id == before.joint("shoulder").id
    assert np.array_equal(after.actuator_trnid, before.actuator_trnid)


def test_a_bone_keeps_the_name_of_its_body_when_a_geom_of_that_name_is_renamed(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(skin("trunk"))
    puppet = """<mujoco><asset><skin name="coat" file="coat.skn"/></asset>
    <worldbody><body name="trunk"><geom name="trunk" size=".1"/></body></worldbody></mujoco>"""
    (tmp_path / "arm.xml").write_text(puppet)

    def bones(selected: str) -> bytes:
        recipe = f"recipe: 1\nbase: ./arm.xml\nedit: [{{select: {{{selected}: trunk}}, rename: chest}}]\n"
        (tmp_path / "recipe.yaml").write_text(recipe)
        built = build(
            Request(tmp_path / "recipe.yaml", verified=False), Context(environment={}, folder=tmp_path)
        )
        assert built is not None
        (coat,) = [content for path, content in built.bundle.files.items() if path.endswith(".skn")]
        return coat

    assert bones("body") == skin("chest")
    assert bones("geom") == skin("trunk")


def test_copies_of_a_replicate_are_renamed(tmp_path: Path) -> None:
    text = (
        '<mujoco><worldbody><replicate count="3" offset="1 0 0"><body name="b"><joint name="j"/><geom size=".1"/></body></replicate>'
        '</worldbody><actuator><motor name="m" joint="j2"/></actuator></mujoco>'
    )
    model = Case(tmp_path, text).edited("{select: {joint: j}, rename: wheel}")
    assert model.actuator("m").trnid[0] == model.joint("wheel2").id == 2


def test_what_is_referred_to_stays(radian: Case) -> None:
    assert radian.told("{select: {joint: elbow}, remove: true}") == ["38 still-referred-to"]
    for word in ("a2", "m1", "s1"):
        assert f"`{word}` refers to the joint `elbow`" in radian.said
    assert "remove: cascade" in radian.said


def test_a_cascade_takes_all_that_refers(radian: Case, own: bool) -> None:
    model = radian.edited("{select: {body: link2}, remove: cascade}", own)
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    gone = {each for each in changed(before, model) if each.startswith("-")}
    assert gone == {"-link2", "-tray", "-elbow", "-lower", "-tip", "-a2", "-m1", "-s1", "-s2"}
    assert {each for each in changed(before, model) if not each.startswith("-")} <= {
        "home qpos", "home qvel", "home ctrl", "other qpos", "other ctrl", "home act", "other qvel", "other act",
    }  # fmt: skip


# -- keyframes --------------------------------------------------------------------------------------------------


def test_keys_follow(radian: Case, own: bool) -> None:
    """The columns of what is gone go, and those of what is moved come with it."""
    model = radian.edited("{select: {joint: shoulder}, remove: cascade}", own)
    assert model.key("home").qpos == pytest.approx([0.2, 1, 0, 0.1, 1, 0, 0, 0])
    assert model.key("home").qvel == pytest.approx([2, 3, 4, 5, 6, 7, 8])
    assert model.key("home").ctrl == pytest.approx([0.2, 0.3])
    model = radian.edited("{select: {body: base}, move: {to: world}}", own)
    assert model.key("home").qpos == pytest.approx([1, 0, 0.1, 1, 0, 0, 0, 0.1, 0.2])
    assert model.key("home").ctrl == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    ball = "{select: {joint: elbow}, unset: [ref], set: {type: ball, limited: false}}"
    model = radian.edited(f"{{select: {{sensor: s1}}, remove: true}}, {ball}", own)
    assert model.key("home").qpos[:5] == pytest.approx([0.1, 1, 0, 0, 0])


def test_keys_of_parts_follow_edits_of_the_whole(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nbase: ./arm.xml\nattach: {b: {model: ./arm.xml, pos: [0, 3, 0]}}\nedit:\n"
        "  - {select: {joint: '{elbow,b/shoulder}'}, remove: cascade}\n  - {select: {key: other}, rename: last}\n"
    )
    assert model.key("home").qpos[:1] == pytest.approx([0.1])
    assert model.key("home").qpos[8:9] == pytest.approx([0.2]) and model.key("last").qpos[
        8:9
    ] == pytest.approx([0.4])
    assert model.key("home").ctrl == pytest.approx([0.1, 0.4, 0.5, 0.6, 0.2, 0.3])


# -- convert ----------------------------------------------------------------------------------------------------

LAW = ("actuator_gaintype", "actuator_biastype", "actuator_dyntype", "actuator_gainprm", "actuator_biasprm",
       "actuator_ctrlrange", "actuator_ctrllimited", "actuator_forcerange", "actuator_gear", "actuator_trnid")  # fmt: skip


@pytest.mark.parametrize("name", ["a1", "a2", "m1", "v1", "f1", "g1"])
def test_any_actuator_is_a_general_one(radian: Case, own: bool, name: str) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(f"{{select: {{actuator: {name}}}, convert: {{to: general}}}}", own)
    for array in (*LAW, "key_ctrl", "key_act"):
        assert np.array_equal(getattr(before, array), getattr(after, array)), array
    assert not radian.context.sink.diagnostics


def force(model: mujoco.MjModel, name: str) -> float:
    data = mujoco.MjData(model)
    data.qpos[:2], data.qvel[:2] = [0.3, 0.25], [0.7, -0.4]
    data.ctrl[:] = 0.4
    mujoco.mj_forward(model, data)
    force: float = data.actuator(name).force[0]
    return force


@pytest.mark.parametrize(
    ("name", "to"),
    [("g1", "position"), ("a1", "pid"), ("v1", "pid"), ("a2", "general"), ("m1", "motor"), ("g1", "pid"), ("a1", "position")],
)  # fmt: skip
def test_what_can_be_kept_is_kept(radian: Case, name: str, to: str) -> None:
    if to == "pid" and not hasattr(mujoco.mjtGain, "mjGAIN_PID"):
        pytest.skip("this MuJoCo has no pid")
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert force(after, name) == pytest.approx(force(before, name), abs=1e-12) != 0
    assert np.array_equal(before.key_ctrl, after.key_ctrl)
    assert not radian.context.sink.diagnostics


def test_what_is_lost_is_told(radian: Case) -> None:
    model = radian.edited("{select: {actuator: a?}, convert: {to: motor, ctrlrange: from-forcerange}}")
    assert model.actuator("a1").ctrlrange == pytest.approx([-50, 50])
    assert force(model, "a1") == pytest.approx(0.4)
    assert [each.severity for each in radian.context.sink.diagnostics] == [Severity.WARNING]
    assert "kp 100 and kv 10 (position `a1`)" in radian.said and "a force now, not a position" in radian.said
    assert model.key("home").ctrl == pytest.approx([0, 0, 0.3, 0.4, 0.5, 0.6]), "they would be forces"
    model = radian.edited("{select: {actuator: a1}, convert: {to: velocity}}")
    assert model.actuator("a1").gainprm[0] == 10 and not model.actuator("a1").ctrllimited[0]
    assert (
        "`ctrlrange`, which limits another thing" in radian.said and "its position gain, 100" in radian.said
    )
    model = radian.edited("{select: {actuator: f1}, convert: {to: motor}}")
    assert model.na == 0 and "its dynamics, `filterexact`" in radian.said
    assert model.key("home").ctrl == pytest.approx([0.1, 0.2, 0.3, 0.4, 0, 0.6])


SERVOS = """\
<mujoco>
  <worldbody><body><joint name="j" range="-30 30"/><joint name="k" axis="0 1 0"/><geom size=".1"/></body></worldbody>
  <actuator>
    <pid name="two" joint="k" kp="3" kv="1" posrange="-2 2" velrange="-3 3"/>
    <position name="own" joint="j" kp="7" kv="1" ctrlrange="-1 1"/>
    <position name="free" joint="j" kp="7" kv="1"/>
    <position name="inherits" joint="j" kp="7" inheritrange="0.5"/>
    <position name="damped" joint="j" kp="7" dampratio="1"/>
    <general name="filtered" joint="j" dyntype="filterexact" dynprm=".1" gainprm="5" biastype="affine" biasprm="0 -5 -1"
             actlimited="true" actrange="-.2 .2" actearly="true"/>
    <intvelocity name="rate" joint="j" kp="7" actrange="-1 1" ctrlrange="-2 2"/>
    <pid name="full" joint="j" kp="7" kv="2" ki="4" imax="2" input="pos" posrange="-1 1"/>
    <pid name="slow" joint="j" kp="7" kv="2" slewmax="5" input="pos"/>
    <pid name="plain" joint="j" kp="7" kv="2" input="pos"/>
    <pid name="speed" joint="j" kp="0" kv="2" input="vel" velrange="-4 4"/>
    <pid name="push" joint="j" kp="0" kv="0" input="ff"/>
  </actuator>
  <keyframe><key name="home" ctrl=".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14" act=".1 .2 .3 .4"/></keyframe>
</mujoco>
"""


@pytest.fixture
def servos(tmp_path: Path) -> Case:
    if not hasattr(mujoco.mjtGain, "mjGAIN_PID"):
        pytest.skip("this MuJoCo has no pid")
    return Case(tmp_path, SERVOS)


def limits(model: mujoco.MjModel, name: str) -> list[list[float]]:
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    first = model.actuator_ctrladr[index]
    rows = range(first, first + model.actuator_ctrlnum[index])
    return [list(model.actuator_ctrlrange[row]) for row in rows if model.actuator_ctrllimited[row]]


@pytest.mark.parametrize(
    ("name", "to"),
    [
        *((name, "general") for name in (
            "two", "own", "free", "inherits", "damped", "filtered", "rate", "full", "slow", "plain", "speed", "push")),
        *((name, name_of) for name_of in ("position", "pid") for name in ("own", "free", "inherits", "damped", "plain")),
        *((name, "pid") for name in ("two", "full", "slow", "speed", "push")),
        ("speed", "velocity"), ("push", "motor"),
    ],
)  # fmt: skip
def test_limits_gains_and_keys_stay_with_the_actuator(servos: Case, name: str, to: str) -> None:
    before = servos.model("recipe: 1\nbase: ./arm.xml\n")
    after = servos.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert servos.context.sink.diagnostics == []
    for each in re.findall('<.* name="(.*?)" joint', SERVOS)[2:]:
        assert limits(after, each) == limits(before, each), each
    assert np.array_equal(before.key_ctrl, after.key_ctrl) and np.array_equal(before.key_act, after.key_act)
    rng = np.random.default_rng(0)
    for _ in range(5):
        state = [rng.normal(size=size) for size in (before.nq, before.nv, before.nu, before.na)]
        forces = []
        for model in (before, after):
            data = mujoco.MjData(model)
            data.qpos[:], data.qvel[:], data.ctrl[:], data.act[:] = state
            mujoco.mj_step(model, data, 2)
            forces.append([*data.actuator_force, *data.act])
        assert forces[0] == pytest.approx(forces[1], abs=1e-9)


@pytest.mark.parametrize("name", ["two", "full", "slow", "plain", "speed"])
def test_a_pid_comes_back_from_its_general_form(servos: Case, name: str) -> None:
    """All that it has, its integral gain and slew rate too, has to be read from a gain of MuJoCo's kind `pid`."""
    before = servos.model("recipe: 1\nbase: ./arm.xml\n")
    one, two = (f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}" for to in ("general", "pid"))
    after = servos.edited(f"{one}, {two}")
    for array in ("gainprm", "biasprm", "dynprm", "dyntype", "ctrlspec"):
        array = f"actuator_{array}"
        assert np.array_equal(getattr(before, array), getattr(after, array)), array


@pytest.mark.parametrize(
    ("name", "to", "said", "home"),
    [
        ("filtered", "position", "`actrange`|`actearly`", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("rate", "position", "a position now, not the rate of a position|`ctrlrange`, which", ".1 .2 .3 .4 .5 .6 .7 0 .9 .11 .12 .13 .14"),
        ("full", "position", "its integral gain, 4", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("slow", "position", "its slew rate, 5", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("two", "position", "a position now, not a position and a velocity|`velrange`", "0 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("two", "motor", "kp 3 and kv 1|a force now, not a position and a velocity", "0 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("own", "motor", "`ctrlrange`, which limits another thing", ".1 .2 0 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
    ],
)  # fmt: skip
def test_what_servos_lose_is_told(servos: Case, name: str, to: str, said: str, home: str) -> None:
    after = servos.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert after.key("home").ctrl == pytest.approx([float(number) for number in home.split()])
    assert [each.code for each in servos.context.sink.diagnostics] == ["convert-loss"]
    for words in said.split("|"):
        assert words in servos.said


def test_a_law_of_its_own_is_lost_and_told(tmp_path: Path) -> None:
    general = 'gaintype="affine" gainprm="1 2 0" biastype="affine" biasprm="1 2 3"'
    arm = Case(
        tmp_path,
        f"""<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
        <actuator><general name="law" joint="j" {general}/></actuator></mujoco>""",
    )
    model = arm.edited("{select: {actuator: law}, convert: {to: position, kp: 5, kv: 1}}")
    assert model.actuator("law").gainprm[0] == 5
    assert "its own gain and bias (`affine`, `affine`)" in arm.said


def test_a_gain_that_there_is_not_must_be_given(radian: Case) -> None:
    assert radian.told("{select: {actuator: m1}, convert: {to: position}}") == ["39 missing-key"]
    model = radian.edited("{select: {actuator: m1}, convert: {to: position, kp: 5, ctrlrange: [-1, 1]}}")
    assert model.actuator("m1").gainprm[0] == 5 and model.actuator("m1").biasprm[:3] == pytest.approx(
        [0, -5, 0]
    )


# -- what is wrong ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("edit", "expected", "said"),
    [
        ("{select: {joint: elbw}, set: {damping: 1}}", "14 selector", "did you mean `joint: elbow`"),
        ("{select: {joint: '*'}, expect: 2, set: {damping: 1}}", "36 selector", "selects 3 elements, expected 2\nit selects joint `shoulder`"),
        ("{select: {geom: '*', parent: {body: lnk}}, set: {group: 1}}", "14 selector", "`parent: {body: lnk}` selects nothing"),
        ("{select: {geom: '*', part: x}, set: {group: 1}}", "14 selector", "parts that exist: base"),
        ("{select: {xpath: '//geom['}, set: {group: 1}}", "22 selector", "not an XPath"),
        ("{select: {geom: '*'}, rename: x}", "35 name-clash", "would both be called `x`"),
        ("{select: {geom: upper}, rename: lower}", "37 name-clash", "cannot be called `lower`"),
        ("{select: {geom: upper}, set: {material: stel}}", "45 unknown-name", "did you mean `material: steel`"),
        ("{select: {geom: upper}, set: {pos: [0, 0, 1]}}", "40 wrong-type", "`fromto` says where it is"),
        ("{select: {geom: upper}, set: {group: '${vlue}'}}", "42 unknown-name", "did you mean `value`"),
        ("{select: {geom: base_geom}, scale: {mass: 2}}", "41 wrong-type", "change that, or the whole mass"),
        ("{select: {geom: upper}, unset: [rgba]}", "37 unknown-attribute", "written on none"),
        ("{select: {body: prop}, move: {to: link1}}", "39 freejoint-on-body", "has a free joint"),
        ("{select: {body: link1}, move: {to: tray}}", "40 wrong-type", "into itself"),
        ("{select: {site: tip}, move: {to: trai}}", "38 unknown-name", "did you mean `to: tray`"),
        ("{select: {joint: elbow}, move: {to: world}}", "41 unknown-element", "cannot stand in `world`"),
        ("{select: {actuator: v1}, convert: {to: motor, ctrlrange: from-forcerange}}", "62 missing-key", "no `forcerange`"),
    ],
)  # fmt: skip
def test_wrong(radian: Case, edit: str, expected: str, said: str) -> None:
    assert radian.told(edit) == [expected]
    assert said in radian.said


def test_a_regular_expression_has_a_bound(tmp_path: Path) -> None:
    arm = Case(tmp_path, RADIANS.replace('"upper"', f'"{"a" * 40}"'))
    assert arm.told("{select: {geom: '/(a+)+b/'}, rename: x}") == ["14 selector"]
    assert "takes longer than 2 seconds" in arm.said


# -- drop, parts and nested recipes -----------------------------------------------------------------------------


def test_drop(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nbase: {model: ./arm.xml, drop: [light, contact, {geom: 'visual_*'}, {body: prop}]}\n"
    )
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    found = changed(before, model)
    assert {each for each in found if each[0] == "-"} == {
        "-sun",
        "-no",
        "-visual_upper",
        "-prop",
        "-free",
        "-ball",
    }
    assert {each for each in found if each[0] != "-"} <= {
        f"{key} {row}" for key in ("home", "other") for row in ("qpos", "qvel")
    }
    assert model.key("home").qpos == pytest.approx([0.1, 0.2])


def test_what_is_dropped_is_listed(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text("recipe: 1\nbase: {model: ./arm.xml, drop: [{body: link2}]}\n")
    context = Context(environment={}, folder=radian.folder)
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    (found,) = foresee(plan, context).subtrees.values()
    listed = {(each.what, each.name) for each in found.left}
    assert {("body", "link2"), ("joint", "elbow"), ("site", "tip"), ("actuator", "a2")} <= listed
    assert not {"frame", "inertial"} & {what for what, _ in listed}, "they are no more than poses and numbers"


def test_drop_of_what_is_not_there(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text(
        "recipe: 1\nbase: {model: ./arm.xml, drop: [equality, camera]}\n"
    )
    context = Context(environment={}, folder=radian.folder)
    assert build(Request(radian.folder / "recipe.yaml", verified=False), context) is None
    assert [(each.code, each.span.column) for each in context.sink.errors if each.span] == [
        ("selector", 33),
        ("selector", 43),
    ]


def test_a_part_is_edited_alone_in_its_own_names(radian: Case) -> None:
    """And in its own unit of angle, whatever that of the model will be."""
    (radian.folder / "deg.xml").write_text(DEGREES)
    model = radian.model(
        "recipe: 1\nbase: ./arm.xml\nattach:\n  d: {model: ./deg.xml, pos: [0, 2, 0], keyframes: none, edit: "
        "[{select: {joint: elbow}, set: {range: [-10deg, 0.1rad]}, offset: {ref: 5deg}}, {select: {geom: lower}, rename: low}]}\n"
    )
    assert model.joint("d/elbow").range == pytest.approx([-np.radians(10), 0.1])
    assert model.joint("d/elbow").qpos0 == pytest.approx([np.radians(15)])
    assert model.geom("d/low").id > model.geom("lower").id
    assert model.joint("elbow").range == pytest.approx([-1.5, 1.5])


def test_by_part(radian: Case) -> None:
    (radian.folder / "pair.yaml").write_text(
        "recipe: 1\nbase: ./arm.xml\nattach: {inner: {model: ./arm.xml, pos: [0, 1, 0]}}\n"
    )
    head = "recipe: 1\nbase: ./arm.xml\nattach: {outer: {model: ./pair.yaml, pos: [0, 3, 0]}}\nadd: [{to: world, geom: {name: new, size: [0.1]}}]\nedit: "
    for part, expected in (
        ("outer", {"outer/ball", "outer/inner/ball"}),
        ("outer/inner", {"outer/inner/ball"}),
        ("base", {"ball"}),
        ("'*'", {"outer/ball", "outer/inner/ball"}),
    ):
        model = radian.model(head + f"[{{select: {{geom: '**/ball', part: {part}}}, set: {{condim: 6}}}}]\n")
        found = {model.geom(each).name for each in range(model.ngeom) if model.geom_condim[each] == 6}
        assert found == expected


def test_degrees_where_mujoco_has_them(radian: Case) -> None:
    eye = "add: [{to: world, camera: {name: eye, fovy: 40}}, {to: world, light: {name: lamp, cutoff: 30}}]\n"
    model = radian.edited(
        "{select: {camera: '*', where: {fovy: 40deg}}, offset: {fovy: 0.1rad}}, {select: {light: lamp}, offset: {cutoff: 10deg}}",
        head=eye,
    )
    assert model.camera("eye").fovy[0] == pytest.approx(40 + np.degrees(0.1))
    assert model.light("lamp").cutoff[0] == pytest.approx(40)


def test_no_value_yet_in_a_list(radian: Case) -> None:
    assert radian.told("{select: {geom: upper}, set: {rgba: [1, '${value}', 0, 1], user: ['${value}']}}")
    assert "geom `upper` has no `user` yet" in radian.said


def test_angles_in_where(arm: Case) -> None:
    range = "-90deg, 90deg" if "degree" in (arm.folder / "arm.xml").read_text() else "-1.5rad, 1.5rad"
    for own in (False, True):
        model = arm.edited(
            f"{{select: {{joint: '**', where: {{range: [{range}]}}}}, expect: 2, set: {{group: 1}}}}", own
        )
        assert model.joint("elbow").group[0] == 1


def test_a_condition_on_what_others_of_the_family_have(radian: Case) -> None:
    model = radian.edited("{select: {joint: '**', where: '${range[1] > 1}'}, expect: 2, set: {group: 1}}")
    assert model.joint("elbow").group[0] == 1
    assert radian.told("{select: {geom: '**', where: '${mass > 0}'}, set: {group: 1}}") == ["34 expression"]
    assert "geom `floor` has no `mass`" in radian.said


def test_a_part_is_called_with_the_separator_of_the_recipe(radian: Case) -> None:
    (radian.folder / "pair.yaml").write_text(
        "recipe: 1\nseparator: __\nattach: {inner: {model: ./arm.xml, pos: [0, 1, 0]}}\n"
    )
    head = "recipe: 1\nseparator: __\nattach: {outer: {model: ./pair.yaml, pos: [0, 3, 0]}}\nedit: "
    model = radian.model(head + "[{select: {geom: '**ball', part: outer__inner}, set: {condim: 6}}]\n")
    assert model.geom("outer__inner__ball").condim[0] == 6
    where = "{select: {geom: '**', part: inner}, set: {condim: 6}}]\n"
    (radian.folder / "recipe.yaml").write_text(f"{head}[{where}")
    assert (
        build(
            Request(radian.folder / "recipe.yaml"), context := Context(environment={}, folder=radian.folder)
        )
        is None
    )
    assert "parts that exist: base, outer, outer__inner" in str(context.sink.errors)


def test_edits_are_done_in_order(radian: Case) -> None:
    model = radian.edited(
        "{select: {joint: elbow}, rename: bend, scale: {damping: 2}, set: {damping: 5}}, {select: {joint: bend}, offset: {damping: 1}}"
    )
    assert model.joint("bend").damping[0] == 11


def test_attributes_stand_in_values_and_new_names(radian: Case) -> None:
    edit = "{select: {actuator: 'm?'}, set: {gear: ['${index + 3}']}, rename: '${joint}_motor'}"
    assert radian.edited(edit).actuator("elbow_motor").gear[0] == 3


def test_a_parameter_stands_before_an_attribute_of_its_name(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nparams: {armature: 0.5}\nbase: ./arm.xml\n"
        "edit: [{select: {joint: elbow}, set: {damping: '${armature}', frictionloss: '${damping + 1}'}}]\n"
    )
    joint = model.joint("elbow")
    assert (joint.damping[0], model.dof_frictionloss[joint.dofadr[0]]) == (0.5, 1.5)


def names(model: mujoco.MjModel, kind: str) -> Iterable[str]:
    return [mujoco.mj_id2name(model, NAMES[kind], row) for row in range(getattr(model, f"n{kind}"))]


def test_names_by_parent_and_index(radian: Case) -> None:
    model = radian.edited("{select: {geom: '**', parent: {body: tray}}, rename: '${parent}_g${index}'}")
    assert {"tray_g0", "tray_g1"} <= set(names(model, "geom"))


def test_expressions_know_parameters(radian: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from composer.plan import planner as make

    plan_of: Callable[..., Any] = make.plan_what_remains
    monkeypatch.setattr(
        "composer.stages.plan_what_remains", lambda *given: replace(plan_of(*given), scope={"payload": 0.5})
    )
    model = radian.edited("{select: {joint: elbow}, set: {armature: '${payload + index}'}}")
    assert model.joint("elbow").armature[0] == 0.5


def test_who_refers_may_be_renamed_with_what_it_refers_to(radian: Case) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited("{select: {xpath: '//joint[@name]|//actuator/*'}, rename: 'x_${name}'}")
    assert after.actuator("x_a2").trnid[0] == after.joint("x_elbow").id
    assert np.array_equal(after.actuator_trnid, before.actuator_trnid)

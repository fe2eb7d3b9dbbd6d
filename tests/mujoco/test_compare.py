"""The judge, against MuJoCo's own attach: silent where nothing changed, and exact where something did."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from mjcompose.base.rotation import Pose
from mjcompose.mujoco.arrays import Treatment, about
from mjcompose.mujoco.attributes import KINDS
from mjcompose.mujoco.compare import KeyMode, Roots
from mjcompose.mujoco.match import Difference, Mount
from mjcompose.mujoco.unchanged import compare, same_dampratio

MODEL = """
<mujoco>
  <worldbody>
    <site name="s" pos="0 0 1"/>
    <body><joint name="a" axis="0 1 0"/><geom size="0.1" mass="{mass}" pos="0.3 0 0"/><site name="t" pos="0.3 0 0"/></body>
    <body pos="0 1 0"><joint name="b" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/></body>
  </worldbody>
  <tendon>
    <fixed name="pulled"><joint joint="a" coef="1"/><joint joint="b" coef="{coefficient}"/></fixed>
    <spatial name="rope"><site site="s"/><site site="t"/></spatial>
  </tendon>
  <actuator>{actuator}</actuator>
</mujoco>
"""


def _model(actuator: str, mass: float = 1, coefficient: float = 2) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MODEL.format(actuator=actuator, mass=mass, coefficient=coefficient))


@pytest.mark.parametrize("tendon", ["pulled", "rope"])
@pytest.mark.parametrize("coefficient", [2, 0])
def test_a_damping_ratio_on_a_tendon_is_the_same_as_itself(tendon: str, coefficient: float) -> None:
    servo = f'<position tendon="{tendon}" kp="5" dampratio="1"/>'
    first, second = (_model(servo, coefficient=coefficient) for _ in range(2))
    assert same_dampratio(first, second, 0, 0)


def test_another_damping_ratio_is_another() -> None:
    first, second = (_model(f'<position tendon="pulled" kp="5" dampratio="{ratio}"/>') for ratio in (1, 0.5))
    assert not same_dampratio(first, second, 0, 0)


ARM = """
<mujoco model="arm">
  <default><geom friction="0.7 0.01 0.001"/></default>
  <asset><mesh name="wedge" vertex="0 0 0  .1 0 0  0 .1 0  0 0 .1"/></asset>
  <worldbody>
    <light pos="0 0 3"/>
    <geom type="plane" size="2 2 .1"/>
    <body name="base" pos="0 0 .5">
      <joint name="turn" axis="0 0 1" range="-2 2" limited="true" damping=".3"/>
      <geom type="box" size=".1 .1 .2"/>
      <geom type="mesh" mesh="wedge" contype="0" conaffinity="0"/>
      <body name="link" pos="0 0 .3">
        <joint name="bend" axis="0 1 0" armature=".02"/>
        <geom type="capsule" fromto="0 0 0 0 0 .3" size=".04"/>
        <site name="flange" pos="0 0 .3" euler="0 30 0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="turn" joint="turn" kp="40" dampratio="1"/>
    <position name="bend" joint="bend" kp="30" kv="2"/>
  </actuator>
  <sensor><force site="flange"/></sensor>
  <keyframe><key name="home" qpos=".5 -.2" ctrl=".5 -.2"/></keyframe>
</mujoco>
"""

HAND = """
<mujoco model="hand">
  <size nuser_geom="2"/>
  <asset>
    <texture name="checks" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 1 0"/>
    <texture type="skybox" builtin="gradient" width="4" height="4" rgb1="0 0 1" rgb2="1 1 1"/>
    <material name="skin" texture="checks" shininess=".3"/>
    <mesh name="wedge" vertex="0 0 0  .2 0 0  0 .1 0  0 0 .1" scale=".5 .5 .5"/>
    <hfield name="bumps" nrow="2" ncol="3" size="1 1 1 .1" elevation="0 1 2 3 4 5"/>
  </asset>
  <worldbody>
    <geom name="plate" type="box" size=".05 .05 .01" mass=".1"/>
    <site name="mark" pos="0 .02 0"/>
    <camera name="eye" pos="0 0 .2" fovy="50"/>
    <body name="palm" pos="0 0 .05">
      <geom type="box" size=".05 .03 .01" material="skin" user="1 2"/>
      <geom type="mesh" mesh="wedge"/>
      <geom name="ball" type="sphere" size=".02" pos="0 0 .1"/>
      <site name="grasp" pos="0 0 .06"/>
      <body name="left" pos="0 .03 .02">
        <joint name="left" type="slide" axis="0 1 0" range="0 .04" limited="true" damping="1"/>
        <geom type="box" size=".01 .005 .03"/>
        <site name="left" pos="0 0 .02"/>
      </body>
      <body pos="0 -.03 .02">
        <joint name="right" type="slide" axis="0 -1 0" springdamper=".1 1"/>
        <geom name="right" type="box" size=".01 .005 .03"/>
        <site name="right" pos="0 0 .02"/>
      </body>
    </body>
  </worldbody>
  <contact>
    <pair geom1="right" geom2="ball" condim="4"/>
    <exclude body1="palm" body2="left"/>
  </contact>
  <tendon>
    <fixed name="grip"><joint joint="left" coef=".5"/><joint joint="right" coef=".5"/></fixed>
    <spatial name="cord" range="0 1" limited="true">
      <site site="left"/><geom geom="ball" sidesite="grasp"/><site site="right"/>
    </spatial>
  </tendon>
  <equality>
    <joint joint1="left" joint2="right"/>
    <connect body1="left" body2="palm" anchor="0 0 0" active="false"/>
  </equality>
  <actuator>
    <motor name="squeeze" tendon="grip" gear="3"/>
    <general joint="left" dyntype="filter" dynprm="2"/>
  </actuator>
  <sensor>
    <jointpos name="opening" joint="left"/>
    <framepos objtype="site" objname="grasp" reftype="body" refname="palm"/>
    <framepos objtype="site" objname="mark" reftype="camera" refname="eye"/>
  </sensor>
  <custom>
    <numeric name="gains" size="4" data="1 2 3"/>
    <text name="maker" data="nobody"/>
    <tuple name="tips"><element objtype="site" objname="left" prm="1"/></tuple>
  </custom>
  <keyframe>
    <key name="open" qpos=".03 .01" qvel=".1 .2" act=".4" ctrl="1 2" time="3"/>
    <key qpos=".02 0"/>
  </keyframe>
</mujoco>
"""

PROP = """
<mujoco model="prop">
  <worldbody>
    <body name="cup" pos="0 0 .1"><freejoint/><geom size=".05"/><site name="rim" pos="0 0 .05"/></body>
    <body name="hoop" mocap="true" pos=".3 0 0"><geom size=".02" contype="0" conaffinity="0"/></body>
  </worldbody>
  <keyframe>
    <key name="home" qpos=".1 .2 .3 1 0 0 0" qvel="1 0 0 0 0 1" mpos=".3 .1 0" mquat="0 1 0 0"/>
  </keyframe>
</mujoco>
"""


@dataclass(frozen=True)
class Composition:
    """A hand on an arm's flange, both compiled alone and together."""

    arm: mujoco.MjModel
    hand: mujoco.MjModel
    both: mujoco.MjModel

    def hand_differences(self, **options: object) -> list[Difference]:
        given: dict[str, object] = {
            "prefix": "hand/",
            "hung_on": Mount.of(self.both, site="flange"),
            "keys": KeyMode.PREFIX,
        }
        return compare(self.hand, self.both, **{**given, **options})

    def arm_differences(self, **options: object) -> list[Difference]:
        return compare(self.arm, self.both, **{"keys": KeyMode.PREFIX, **options})


def compose(
    change_hand: Callable[[mujoco.MjSpec], None] = lambda spec: None,
    change_both: Callable[[mujoco.MjSpec], None] = lambda spec: None,
) -> Composition:
    arm = mujoco.MjSpec.from_string(ARM)
    hand = mujoco.MjSpec.from_string(HAND)
    arm.nuser_geom = 2
    for key in hand.keys:
        key.name = key.name or "second"
    change_hand(hand)
    arm.compile()
    hand.compile()
    arm.attach(hand, prefix="hand/", site=arm.site("flange"))
    change_both(arm)
    alone = mujoco.MjSpec.from_string(HAND)
    for key in alone.keys:
        key.name = key.name or "second"
    return Composition(mujoco.MjModel.from_xml_string(ARM), alone.compile(), arm.compile())


def told(differences: list[Difference]) -> set[tuple[str, str, str]]:
    return {(found.kind, found.name, found.array) for found in differences}


def test_attach_changes_neither_part() -> None:
    composition = compose()
    assert composition.arm_differences() == []
    assert composition.hand_differences(others=[("", composition.arm)]) == []


def test_a_part_is_equal_to_itself() -> None:
    for xml in (ARM, HAND, PROP):
        model = mujoco.MjModel.from_xml_string(xml)
        assert compare(model, model) == []


def test_a_negative_zero_is_zero_and_any_other_bit_is_not() -> None:
    alone, other = (mujoco.MjModel.from_xml_string(ARM) for _ in range(2))
    other.geom_pos[1] = -0.0
    assert compare(alone, other) == []
    other.dof_damping[0] = np.nextafter(0.3, 1)
    assert [str(found) for found in compare(alone, other)] == [
        "joint `turn`: `dof_damping` is 0.30000000000000004, alone it is 0.3"
    ]
    assert compare(alone, other, tolerance=1e-12) == []


def _geom(spec: mujoco.MjSpec, name: str) -> mujoco.MjsGeom:
    return next(geom for geom in spec.geoms if geom.name == name)


def _damage_joint(spec: mujoco.MjSpec) -> None:
    spec.joint("left").damping = [2, 0, 0]


def _damage_friction(spec: mujoco.MjSpec) -> None:
    _geom(spec, "ball").friction = [0.9, 0.01, 0.001]


def _damage_unnamed_geom(spec: mujoco.MjSpec) -> None:
    spec.body("left").geoms[0].size = [0.01, 0.006, 0.03]
    spec.body("left").geoms[0].mass = 0.001 * 4 * 2 * 1.5  # the mass it had


def _damage_sensor(spec: mujoco.MjSpec) -> None:
    spec.sensor("opening").objname = "right"


def _damage_unnamed_sensor(spec: mujoco.MjSpec) -> None:
    spec.sensors[1].objname = "mark"


def _damage_key(spec: mujoco.MjSpec) -> None:
    spec.keys[0].qpos = [0.03, 0.02]


def _damage_path(spec: mujoco.MjSpec) -> None:
    other = spec.add_tendon(name="other")
    other.wrap_joint("left", 0.5)
    other.wrap_joint("right", 0.25)
    spec.tendon("grip").name = "former"
    other.name = "grip"
    spec.actuator("squeeze").target = "grip"
    spec.delete(spec.tendon("former"))


def _damage_gear(spec: mujoco.MjSpec) -> None:
    spec.actuator("squeeze").gear = [4, 0, 0, 0, 0, 0]


def _damage_pixels(spec: mujoco.MjSpec) -> None:
    spec.texture("checks").rgb1 = [1, 0, 0.5]


def _damage_mesh(spec: mujoco.MjSpec) -> None:
    spec.mesh("wedge").scale = [0.5, 0.5, 0.6]


def _damage_heights(spec: mujoco.MjSpec) -> None:
    spec.hfield("bumps").userdata = [0, 1, 2, 3, 5, 5]


def _damage_material(spec: mujoco.MjSpec) -> None:
    spec.material("skin").shininess = 0.4


def _damage_pair(spec: mujoco.MjSpec) -> None:
    spec.pairs[0].condim = 3


def _damage_numeric(spec: mujoco.MjSpec) -> None:
    spec.numerics[0].data = [1, 2, 4]


def _damage_text(spec: mujoco.MjSpec) -> None:
    spec.texts[0].data = "nobodx"


def _damage_user(spec: mujoco.MjSpec) -> None:
    spec.body("palm").geoms[0].userdata = [1, 3]


def _damage_limit(spec: mujoco.MjSpec) -> None:
    spec.tendon("cord").range = [0, 2]


def _damage_dynamics(spec: mujoco.MjSpec) -> None:
    spec.actuators[1].dynprm = [3] + [0] * 9


def _damage_equality(spec: mujoco.MjSpec) -> None:
    spec.equalities[0].data = [0, 2] + [0] * (mujoco.mjNEQDATA - 2)


def _damage_exclude(spec: mujoco.MjSpec) -> None:
    spec.excludes[0].bodyname2 = "world"


DAMAGES: list[tuple[Callable[[mujoco.MjSpec], None], set[tuple[str, str, str]]]] = [
    (_damage_joint, {("joint", "hand/left", "dof_damping")}),
    (_damage_friction, {("geom", "hand/ball", "geom_friction")}),
    (
        _damage_unnamed_geom,
        {("geom", "#0 of body `hand/left`", field) for field in ("geom_size", "geom_rbound", "geom_aabb")}
        | {("body", "hand/left", "body_inertia")},
    ),
    (_damage_sensor, {("sensor", "hand/opening", "sensor_objid")}),
    (_damage_unnamed_sensor, {("sensor", "#2", "sensor_objid")}),
    (_damage_key, {("key", "hand/open", "key_qpos")}),
    (_damage_path, {("tendon", "hand/grip", "wrap_prm")}),
    (_damage_gear, {("actuator", "hand/squeeze", "actuator_gear")}),
    (_damage_pixels, {("texture", "hand/checks", "tex_data")}),
    (_damage_heights, {("hfield", "hand/bumps", "hfield_data")}),
    (_damage_material, {("material", "hand/skin", "mat_shininess")}),
    (_damage_pair, {("pair", "#0", "pair_dim")}),
    (_damage_numeric, {("numeric", "hand/gains", "numeric_data")}),
    (_damage_text, {("text", "hand/maker", "text_data")}),
    (_damage_user, {("geom", "#0 of body `hand/palm`", "geom_user")}),
    (_damage_limit, {("tendon", "hand/cord", "tendon_range")}),
    (_damage_dynamics, {("actuator", "#3", "actuator_dynprm")}),
    (_damage_equality, {("equality", "#0", "eq_data")}),
]


@pytest.mark.parametrize(("damage", "expected"), DAMAGES, ids=[damage.__name__ for damage, _ in DAMAGES])
def test_one_damage_is_one_difference(
    damage: Callable[[mujoco.MjSpec], None], expected: set[tuple[str, str, str]]
) -> None:
    composition = compose(damage)
    assert told(composition.hand_differences()) == expected
    assert composition.arm_differences() == []


def test_a_scaled_mesh_shows_in_the_mesh_its_geom_and_its_body() -> None:
    found = told(compose(_damage_mesh).hand_differences())
    assert ("mesh", "hand/wedge", "mesh_scale") in found
    assert ("mesh", "hand/wedge", "mesh_vert") in found
    assert {kind for kind, _, _ in found} == {"mesh", "geom", "body"}


def test_an_exclude_of_other_bodies_is_an_exclude_of_other_bodies() -> None:
    (found,) = compose(_damage_exclude).hand_differences()
    assert (found.kind, found.expected, found.actual) == ("exclude", "hand/left", "world")


def test_what_is_gone_is_missing() -> None:
    def drop(spec: mujoco.MjSpec) -> None:
        spec.delete(spec.sensor("opening"))

    found = compose(drop).hand_differences()
    assert [str(difference) for difference in found] == ["sensor `hand/opening` is missing"]


def test_what_bears_the_prefix_without_being_of_the_part_is_extra() -> None:
    composition = compose(change_both=lambda spec: spec.body("base").add_site(name="hand/new") and None)
    assert composition.hand_differences() == []
    found = composition.hand_differences(others=[("", composition.arm)])
    assert [str(difference) for difference in found] == ["site `hand/new` is not in the part alone"]


def test_what_the_base_calls_by_the_prefix_is_not_extra() -> None:
    arm = ARM.replace('"flange"', '"hand/flange"')
    cup = "<mujoco><worldbody><body name='cup'><geom size='.1'/></body></worldbody></mujoco>"
    base = mujoco.MjSpec.from_string(arm)
    base_alone = base.compile()
    base.attach(mujoco.MjSpec.from_string(cup), prefix="hand/", site=base.site("hand/flange"))
    both = base.compile()
    alone = mujoco.MjModel.from_xml_string(cup)
    mount = Mount.of(both, site="hand/flange")
    assert compare(alone, both, prefix="hand/", hung_on=mount, others=[("", base_alone)]) == []
    assert compare(alone, both, prefix="hand/", hung_on=mount, others=[]) != []


def test_what_stands_at_the_root_must_move_with_the_mount() -> None:
    composition = compose(change_both=lambda spec: setattr(spec.site("hand/mark"), "pos", [0, 0.1, 0.3]))
    found = composition.hand_differences()
    assert told(found) == {("site", "hand/mark", "site_pos")}
    elsewhere = Mount("link", Pose((0, 0, 0.1)))
    assert {"geom_pos", "site_pos", "cam_pos", "body_pos"} <= {
        f.array for f in compose().hand_differences(hung_on=elsewhere)
    }


def test_a_part_may_stand_on_a_body_put_in_between() -> None:
    part = """
    <mujoco><worldbody>
      <geom name="g" size=".1" pos="0 0 1"/><body name="b">{}</body>
    </worldbody></mujoco>"""
    inner = "<joint damping='{}'/><geom size='.1'/>"
    whole = f"""
    <mujoco><worldbody><body name="base">
      <body name="p/" pos="0 1 0" euler="0 0 90">
        <geom name="p/g" size=".1" pos="0 0 1"/><body name="p/b">{inner.format(1)}</body>
      </body>
    </body></worldbody></mujoco>"""
    both = mujoco.MjModel.from_xml_string(whole)
    turned = Pose((0, 1, 0), (0.7071067811865476, 0.0, 0.0, 0.7071067811865476))
    for damping, expected in ((1, set()), (2, {("joint", "#0 of body `p/b`", "dof_damping")})):
        alone = mujoco.MjModel.from_xml_string(part.format(inner.format(damping)))
        for mount in (Mount("p/"), Mount("base", turned), Mount("base", None)):
            assert told(compare(alone, both, prefix="p/", hung_on=mount)) == expected
    assert {found.array for found in compare(alone, both, prefix="p/", hung_on=Mount("base"))} >= {"body_pos"}


def test_an_authored_sleep_policy_is_kept() -> None:
    xml = """
    <mujoco><worldbody>
      <body name="a" sleep="{}"><freejoint/><geom size=".1"/></body>
    </worldbody></mujoco>"""
    never, allowed, auto = (mujoco.MjModel.from_xml_string(xml.format(p)) for p in ("never", "allowed", "auto"))
    assert told(compare(never, allowed)) == {("body", "a", "tree_sleep_policy")}
    assert compare(auto, never) == []


def test_an_unknown_pose_is_taken_from_the_first_root() -> None:
    assert compose().hand_differences(hung_on=Mount("link", None)) == []
    moved = compose(change_both=lambda spec: setattr(spec.site("hand/mark"), "pos", [0, 0.1, 0.3]))
    assert told(moved.hand_differences(hung_on=Mount("link", None))) == {("site", "hand/mark", "site_pos")}


def test_a_body_hung_elsewhere_is_told_by_its_parent() -> None:
    found = compose().hand_differences(hung_on=Mount("base", None))
    assert ("body", "hand/palm", "body_parentid") in told(found)
    assert "is `link`, alone it is `world`" in str(next(f for f in found if f.array == "body_parentid"))


def test_a_damping_ratio_is_kept_but_a_changed_one_is_not() -> None:
    composition = compose()
    turn = composition.both.actuator("turn").id
    assert composition.both.actuator_biasprm[turn, 2] != composition.arm.actuator_biasprm[turn, 2]
    assert composition.arm_differences() == []
    composition.both.actuator_biasprm[turn, 2] *= 1.01
    assert told(composition.arm_differences()) == {("actuator", "turn", "actuator_biasprm")}


def test_a_spring_given_by_its_time_constant_is_kept_but_a_changed_one_is_not() -> None:
    composition = compose()
    alone = composition.hand.joint("right").id
    both = composition.both.joint("hand/right").id
    assert composition.hand.jnt_stiffness[alone] != composition.both.jnt_stiffness[both]
    composition.both.jnt_stiffness[both] *= 1.01
    assert told(composition.hand_differences()) == {("joint", "hand/right", "jnt_stiffness")}


def test_the_lens_of_a_camera_counts_where_somebody_reads_it() -> None:
    text = """<mujoco><visual><map znear="{near}"/></visual><worldbody>
      <camera name="plain"/><camera name="real" sensorsize="0.01 0.01" focal="{focal} 0.03" resolution="8 8"/>
    </worldbody></mujoco>"""
    alone = mujoco.MjModel.from_xml_string(text.format(near=0.01, focal=0.03))
    assert not compare(alone, mujoco.MjModel.from_xml_string(text.format(near=0.02, focal=0.03)))
    other = mujoco.MjModel.from_xml_string(text.format(near=0.01, focal=0.04))
    assert {(found.name, found.array) for found in compare(alone, other)} >= {("real", "cam_intrinsic")}


def test_ignored_attributes_and_arrays_are_left_out() -> None:
    composition = compose(_damage_friction)
    assert composition.hand_differences(ignore=["friction"]) == []
    assert composition.hand_differences(ignore=["geom_friction"]) == []
    assert composition.hand_differences(ignore=["pair_friction"]) != []


def test_renamed_elements_are_found_by_their_new_name() -> None:
    def rename_plate(spec: mujoco.MjSpec) -> None:
        spec.geom("hand/plate").name = "tray"

    composition = compose(change_both=rename_plate)
    assert told(composition.hand_differences()) == {("geom", "hand/plate", "missing")}
    assert composition.hand_differences(renamed={"geom": {"plate": "tray"}}) == []


@pytest.mark.mujoco4("keys of attached models cannot be deleted from a spec")
def test_merged_keys_are_compared_by_the_entries_of_the_part() -> None:
    def merge(spec: mujoco.MjSpec) -> None:
        for key in list(spec.keys):
            spec.delete(key)
        spec.add_key(name="home", qpos=[0.5, -0.2, 0, 0], ctrl=[0.5, -0.2, 0, 0])
        spec.add_key(name="open", qpos=[0, 0, 0.03, 0.01], qvel=[0, 0, 0.1, 0.2], act=[0.4], ctrl=[0, 0, 1, 2])
        spec.add_key(name="second", qpos=[0, 0, 0.02, 0])

    composition = compose(change_both=merge)
    assert composition.arm_differences(keys=KeyMode.MERGE) == []
    assert composition.hand_differences(keys=KeyMode.MERGE) == []
    assert composition.hand_differences(keys=KeyMode.NONE) == []
    composition.both.key_ctrl[1, 3] = 7
    assert [str(found) for found in composition.hand_differences(keys=KeyMode.MERGE)] == [
        "key `open`: `key_ctrl of `#3`` is [7.0], alone it is [2.0]"
    ]


def test_a_key_that_did_not_come_along_is_missing() -> None:
    alone = mujoco.MjModel.from_xml_string(PROP)
    other = mujoco.MjModel.from_xml_string(PROP.replace('"home"', '"rest"'))
    assert [str(found) for found in compare(alone, other)] == ["key `home` is missing"]
    assert compare(alone, other, keys=KeyMode.NONE) == []
    assert compare(alone, other, renamed={"key": {"home": "rest"}}) == []


def _props(moved: bool) -> tuple[mujoco.MjModel, mujoco.MjModel, Mount]:
    """A prop on a turned and shifted place in the world; its key as attach leaves it, or moved along."""
    place = Pose((1.0, 2.0, 0.0), (0.7071067811865476, 0.0, 0.0, 0.7071067811865476))
    base = mujoco.MjSpec.from_string(ARM)
    prop = mujoco.MjSpec.from_string(PROP)
    base.compile()
    prop.compile()
    base.attach(prop, prefix="prop/", frame=base.worldbody.add_frame(pos=place.pos, quat=place.quat))
    both = base.compile()
    if moved:
        key = both.key("prop/home").id
        cup = place @ Pose((0.1, 0.2, 0.3))
        hoop = place @ Pose((0.3, 0.1, 0.0), (0.0, 1.0, 0.0, 0.0))
        both.key_qpos[key, 2:9] = [*cup.pos, *cup.quat]
        both.key_qvel[key, 2:5] = [0, 1, 0]
        both.key_mpos[key] = hoop.pos
        both.key_mquat[key] = hoop.quat
    return mujoco.MjModel.from_xml_string(PROP), both, Mount(None, place)


def test_a_key_moves_the_free_bodies_of_a_moved_part_or_keeps_them() -> None:
    for moved, right, wrong in ((True, Roots.MOVED, Roots.KEPT), (False, Roots.KEPT, Roots.MOVED)):
        alone, both, mount = _props(moved)

        def differences(roots: Roots) -> list[Difference]:
            return compare(alone, both, prefix="prop/", hung_on=mount, keys=KeyMode.PREFIX, roots_in_keys=roots)  # noqa: B023

        assert differences(right) == []
        assert {found.array for found in differences(wrong)} == {"key_qpos", "key_qvel", "key_mpos", "key_mquat"}


def test_identical_unnamed_bodies_are_told_apart_by_where_they_stand() -> None:
    cubes = "".join(f'<body pos="{x} 0 0"><freejoint/><geom size=".1"/></body>' for x in (1, 2, 3))
    xml = f"<mujoco><worldbody>{cubes}<light pos='0 0 2'/><light pos='0 0 3'/></worldbody></mujoco>"
    alone = mujoco.MjModel.from_xml_string(xml)
    base = mujoco.MjSpec.from_string(xml)
    part = mujoco.MjSpec.from_string(xml)
    base.attach(part, prefix="p/", frame=base.worldbody.add_frame(pos=[0, 1, 0]))
    both = base.compile()
    assert compare(alone, both) == []
    assert compare(alone, both, prefix="p/", hung_on=Mount(None, Pose((0, 1, 0)))) == []
    both.light_pos[3] = [0, 1, 9]
    found = compare(alone, both, prefix="p/", hung_on=Mount(None, Pose((0, 1, 0))))
    assert [(difference.kind, difference.array) for difference in found] == [("light", "light_pos")]


def test_a_named_body_is_no_stand_in_for_one_without_a_name() -> None:
    body = '<body {} pos="0 0 {}"><geom size=".1"/></body>'
    xml = "<mujoco><worldbody><body name='palm'>{}</body></worldbody></mujoco>"
    alone = mujoco.MjModel.from_xml_string(xml.format(body.format("", 1)))
    both = mujoco.MjModel.from_xml_string(xml.format(body.format("", 2) + body.format('name="added"', 1)))
    assert told(compare(alone, both)) == {("body", "#2", "body_pos")}


def test_plain_arrays_have_one_row_an_element() -> None:
    """With all counts different, an array of another length than its kind's can be no plain one."""
    limb = '<body><joint/><joint axis="1 0 0"/><geom size=".1"/><site/><site/><site/></body>'
    cloth = '<flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" radius=".01" dim="2"/>'
    sheet = """<skin vertex="0 0 0 1 0 0 0 1 0" texcoord="0 0 1 0 0 1" face="0 1 2">
      <bone body="palm" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1" vertweight="1 1"/>
      <bone body="left" bindpos="0 0 0" bindquat="1 0 0 0" vertid="2 1" vertweight="1 1"/></skin>"""
    xml = HAND.replace("</worldbody>", f"{limb * 5}{cloth}</worldbody><deformable>{sheet}</deformable>")
    keyless = xml[: xml.index("<keyframe>")] + "</mujoco>"
    crowd = mujoco.MjModel.from_xml_string(keyless)
    rows = {kind.arrays: len(getattr(crowd, kind.addresses)) for kind in KINDS.values()} | {"dof": crowd.nv}
    assert rows["flex"] == rows["skin"] == 1
    odd = [
        name
        for name in dir(crowd)
        if isinstance(array := getattr(crowd, name), np.ndarray)
        and (word := name.split("_", 1)[0]) in rows
        and about(name).treatment is Treatment.PLAIN
        and array.shape[:1] != (rows[word],)
    ]
    assert odd == []
    assert compare(crowd, crowd) == []


def test_a_mesh_may_collide_where_others_use_it_too() -> None:
    """MuJoCo computes the convex hull of a mesh only for what collides with it."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    obj = "\n".join(["v {} {} {}".format(*corner) for corner in corners] + ["f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5"])

    def model(shown: str, *others: str) -> mujoco.MjModel:
        geoms = "".join(f'<geom type="mesh" mesh="m" {each}/>' for each in (shown, *others))
        xml = f"""<mujoco><asset><mesh name="m" file="m.obj" inertia="shell"/></asset>
          <worldbody>{geoms}</worldbody></mujoco>"""
        return mujoco.MjModel.from_xml_string(xml, {"m.obj": obj.encode()})

    visual = 'name="own" contype="0" conaffinity="0"'
    colliding = 'name="own"'
    assert compare(model(visual), model(visual, 'name="new"')) == []
    lost = {each.array for each in compare(model(colliding), model(visual))}
    assert {"mesh_graphadr", "mesh_polynum"} <= lost


@pytest.mark.parametrize(("array", "value"), [("light_dir", [0, 0, -1]), ("light_pos", [0, 0, 3])])
def test_lights_at_the_root_turn_with_the_part(array: str, value: list[float]) -> None:
    """Compared with where the mount puts them: left as they are alone they light another side."""
    xml = "<mujoco><worldbody>{}<light name='l' pos='0 0 3' dir='0 0 -1'/><geom name='g' size='.1'/>{}</worldbody></mujoco>"
    alone = mujoco.MjModel.from_xml_string(xml.format("", ""))
    composed = mujoco.MjModel.from_xml_string(xml.format("<frame euler='90 0 0'>", "</frame>"))
    hung_on = Mount(None, Pose((0, 0, 0), (0.5**0.5, 0.5**0.5, 0, 0)))
    assert compare(alone, composed, hung_on=hung_on) == []
    getattr(composed, array)[0] = value
    found = compare(alone, composed, hung_on=hung_on)
    assert [(each.name, each.array) for each in found] == [("l", array)]


@pytest.mark.parametrize("sign", [1, -1])
def test_a_turn_of_a_weld_and_its_negative_are_the_same(sign: int) -> None:
    def model(pose: Pose, prefix: str = "", frame: str = "", by: int = 1) -> mujoco.MjModel:
        body = f'<body name="{prefix}b"><freejoint/><geom size=".1"/></body>{"</frame>" if frame else ""}'
        numbers = " ".join(map(repr, [*pose.pos, *(by * each for each in pose.quat)]))
        weld = f'<weld name="{prefix}w" body1="world" body2="{prefix}b" relpose="{numbers}"/>'
        return mujoco.MjModel.from_xml_string(
            f"<mujoco><worldbody>{frame}{body}</worldbody><equality>{weld}</equality></mujoco>"
        )

    moved = Pose((1, 2, 3), (0.6, 0, 0, 0.8))
    pose = Pose((0, 0, 1), (0.8, 0.6, 0, 0))
    for there, expected in ((pose, set()), (Pose(pose.pos, (0.8, -0.6, 0, 0)), {("equality", "p/w", "eq_data")})):
        both = model(moved @ there, "p/", '<frame pos="1 2 3" quat=".6 0 0 .8">', sign)
        assert told(compare(model(pose), both, prefix="p/", hung_on=Mount(None, moved))) == expected

"""What follows from an attribute: MuJoCo compiles a model with two values of it, and the judge compares.

The tables say the same of which array an attribute of MJCF becomes.
"""

from __future__ import annotations

import mujoco
import pytest
from mjcompose.language.checks.unchanged import attributes as attributes_unchanged
from mjcompose.mujoco.arrays import BALL, ENUMS, FREE, HINGE, JOINT_TYPES, SLIDE, about
from mjcompose.mujoco.attributes import (
    _BECOMES,
    _KINDS,
    ENUMERATED,
    HOLDERS,
    KINDS,
    TAGS as ATTRIBUTES_TAGS,
    array_of,
    arrays_of,
    attributes,
)
from mjcompose.mujoco.unchanged import compare
from mjcompose.tree.grammar import GRAMMAR

MODEL = """
<mujoco>
  <compiler autolimits="true" angle="radian"/>
  <asset>
    <texture name="t" builtin="flat" type="2d" width="4" height="4"/>
    <texture name="u" builtin="flat" type="2d" width="4" height="4" rgb1="1 0 0"/>
    <material name="m" {material}/>
    <material name="n" rgba="0 1 0 1"/>
    <mesh name="cube" vertex="0 0 0 1 0 0 0 1 0 0 0 1" {mesh}/>
    <mesh name="other" vertex="0 0 0 2 0 0 0 2 0 0 0 2"/>
  </asset>
  <worldbody>
    <light name="l" {light}/>
    <camera name="c" {camera}/>
    <body name="a" {body}>
      <joint name="j" {joint}/>
      <geom name="g" size=".1 .1 .1" {geom}/>
      <geom name="mesh" type="mesh" {meshgeom}/>
      <site name="s" {site}/>
      <body name="b" pos="0 0 1"><joint name="k" axis="0 1 0"/><geom name="h" size=".1"/><site name="z"/>
      </body>
    </body>
  </worldbody>
  <contact><pair name="p" geom1="g" geom2="h" {pair}/></contact>
  <equality><joint name="e" joint1="j" joint2="k" {equality}/></equality>
  <tendon><spatial name="x" {spatial}><site site="s"/><site site="z"/></spatial></tendon>
  <actuator>
    <position name="act" joint="j" {position}/>
    <motor name="drive" joint="k" {motor}/>
  </actuator>
  <sensor><jointpos name="q" joint="j" {sensor}/></sensor>
</mujoco>
"""
CASES = {
    ("geom", "friction"): "0.7 0.1 0.1",
    ("geom", "rgba"): "1 0 0 1",
    ("geom", "mass"): "7",
    ("geom", "density"): "700",
    ("geom", "pos"): "1 0 0",
    ("geom", "euler"): "1 0 0",
    ("geom", "quat"): "1 1 0 0",
    ("geom", "type"): "box",
    ("geom", "condim"): "6",
    ("geom", "margin"): "0.1",
    ("geom", "solref"): "0.01 1",
    ("geom", "contype"): "2",
    ("geom", "conaffinity"): "2",
    ("geom", "group"): "3",
    ("geom", "priority"): "3",
    ("geom", "material"): "n",
    ("geom", "fluidshape"): "ellipsoid",
    ("geom", "user"): "1 2",
    ("meshgeom", "mesh"): "other",
    ("mesh", "scale"): "1 1 2",
    ("mesh", "inertia"): "shell",
    ("body", "gravcomp"): "0.5",
    ("body", "pos"): "0 1 0",
    ("joint", "damping"): "3",
    ("joint", "armature"): "0.3",
    ("joint", "stiffness"): "3",
    ("joint", "springdamper"): "0.1 1",
    ("joint", "frictionloss"): "3",
    ("joint", "range"): "-1 1",
    ("joint", "ref"): "0.3",
    ("joint", "springref"): "0.3",
    ("joint", "axis"): "1 0 0",
    ("joint", "pos"): "1 0 0",
    ("joint", "type"): "slide",
    ("joint", "actuatorfrcrange"): "-1 1",
    ("joint", "actuatorgravcomp"): "true",
    ("joint", "solreflimit"): "0.01 1",
    ("joint", "solimpfriction"): "0.8 0.9 0.01",
    ("site", "size"): "0.3",
    ("site", "rgba"): "1 0 0 1",
    ("site", "pos"): "1 0 0",
    ("site", "type"): "box",
    ("camera", "fovy"): "30",
    ("camera", "pos"): "1 0 0",
    ("camera", "mode"): "trackcom",
    ("camera", "resolution"): "20 20",
    ("light", "diffuse"): "1 0 0",
    ("light", "dir"): "1 0 0",
    ("light", "castshadow"): "false",
    ("light", "active"): "false",
    ("light", "type"): "directional",
    ("material", "rgba"): "1 0 0 1",
    ("material", "texture"): "u",
    ("material", "shininess"): "0.1",
    ("pair", "friction"): "0.7",
    ("pair", "condim"): "6",
    ("pair", "solreffriction"): "0.01 1",
    ("equality", "polycoef"): "0 2 0 0 0",
    ("equality", "active"): "false",
    ("spatial", "stiffness"): "3",
    ("spatial", "springlength"): "0.3",
    ("spatial", "width"): "0.3",
    ("spatial", "range"): "0 3",
    ("spatial", "damping"): "3",
    ("spatial", "solreflimit"): "0.01 1",
    ("spatial", "solimpfriction"): "0.8 0.9 0.01",
    ("position", "kp"): "7",
    ("position", "kv"): "7",
    ("position", "dampratio"): "1",
    ("position", "ctrlrange"): "-1 1",
    ("position", "forcerange"): "-1 1",
    ("position", "gear"): "3",
    ("motor", "gear"): "3",
    ("motor", "group"): "3",
    ("sensor", "noise"): "0.1",
    ("sensor", "cutoff"): "0.1",
}
FIRST = {("meshgeom", "mesh"): 'mesh="cube"'}
TAGS = {"meshgeom": "geom"}


PLACES = "geom meshgeom mesh material light camera body joint site pair equality spatial position motor sensor".split()


def _model(place: str, text: str) -> mujoco.MjModel:
    given = dict.fromkeys(PLACES, "") | {"meshgeom": 'mesh="cube"', place: text}
    return mujoco.MjModel.from_xml_string(MODEL.format(**given))


@pytest.mark.parametrize(("place", "attribute"), CASES)
def test_what_follows_is_excused_and_nothing_else(place: str, attribute: str) -> None:
    plain = _model(place, FIRST.get((place, attribute), ""))
    changed = _model(place, f'{attribute}="{CASES[place, attribute]}"')
    assert compare(plain, changed)
    assert attribute in attributes_unchanged()
    assert not compare(plain, changed, ignore=arrays_of(attribute))
    if place not in ("equality", "sensor"):
        assert not compare(plain, changed, ignore=arrays_of(attribute, TAGS.get(place, place)))
    assert compare(plain, _model("sensor", 'noise="0.5"'), ignore=arrays_of("friction", "geom"))


def test_the_tables_speak_of_what_mjcf_has() -> None:
    assert set(_BECOMES) - {"target", "force"} <= set(attributes_unchanged())
    tags = {tag for section in ("worldbody", "tendon", "equality", "actuator") for tag in GRAMMAR.within(section)}
    assert set(_KINDS) <= tags


EVERY = [(tag, attribute) for tag in ATTRIBUTES_TAGS for attribute in attributes(tag)]


@pytest.mark.parametrize("tag", ATTRIBUTES_TAGS)
def test_the_array_of_an_attribute_is_among_those_that_follow_from_it(tag: str) -> None:
    missing = [each for each in attributes(tag) if array_of(tag, each) not in arrays_of(each, tag)]
    assert missing == []


def test_without_a_tag_it_is_the_end_of_its_name() -> None:
    assert {"solref", "solref_lim"} <= arrays_of("solreflimit") and "tendon_solref_lim" not in arrays_of("solreflimit")
    assert "qpos0" in arrays_of("ref")


def test_the_quantity_of_an_array_names_the_attribute() -> None:
    for tag, attribute in EVERY:
        known = about(array_of(tag, attribute))
        own = known.name.partition("_")[2]
        assert attribute in known.attributes or known.attributes == (own,), (tag, attribute)


def test_words_are_of_arrays_with_enumerations() -> None:
    pairs = [(tag, attribute) for tag, names in ENUMERATED.items() for attribute in names]
    assert {array_of(*pair) for pair in pairs} == set(ENUMS) - {"actuator_trntype"}
    assert ENUMERATED["texture"] == {"type"} and not ENUMERATED["body"]


def test_the_arrays_are_mujocos() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    assert {array_of(*pair) for pair in EVERY if not hasattr(compiled, array_of(*pair))} <= {
        "mat_metallic",
        "light_intensity",
        "geom_margin",
        "pair_margin",
    } | NEWER


NEWER = {array_of(tag, attribute) for tag, attribute in EVERY} if mujoco.__version__ < "4" else set()


def test_every_name_in_the_table_is_of_mujoco() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    arrays = [kind.addresses for kind in KINDS.values()] + list(HOLDERS.values())
    sizes = [kind.size for kind in KINDS.values() if kind.size != "nactuator"]  # that is new in MuJoCo 4
    assert [name for name in arrays + sizes if not hasattr(compiled, name)] == []
    for word, kind in KINDS.items():
        assert kind.object_type == int(getattr(mujoco.mjtObj, f"mjOBJ_{word.upper()}"))


def test_joints_are_mujocos() -> None:
    types = mujoco.mjtJoint
    ours = (FREE, BALL, SLIDE, HINGE)
    assert ours == tuple(map(int, (types.mjJNT_FREE, types.mjJNT_BALL, types.mjJNT_SLIDE, types.mjJNT_HINGE)))
    for number, kind in zip(ours, JOINT_TYPES, strict=True):
        assert types(number).name == f"mjJNT_{kind.word.upper()}"
        one = "<freejoint/>" if kind.word == "free" else f'<joint type="{kind.word}"/>'
        text = f'<mujoco><worldbody><body>{one}<geom size="1"/></body></worldbody></mujoco>'
        compiled = mujoco.MjModel.from_xml_string(text)
        assert (kind.positions, kind.velocities) == (compiled.nq, compiled.nv)

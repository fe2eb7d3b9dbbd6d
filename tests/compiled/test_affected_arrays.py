"""What follows from an attribute: MuJoCo compiles a model with two values of it, and the judge compares."""

from __future__ import annotations

import mujoco
import pytest

from composer.compiled.affected_arrays import _BECOMES, _KINDS, arrays_of
from composer.compiled.unchanged import compare
from composer.grammar import GRAMMAR
from composer.recipe.checks.unchanged import attributes

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
    assert attribute in attributes()
    assert not compare(plain, changed, ignore=arrays_of(attribute))
    if place not in ("equality", "sensor"):
        assert not compare(plain, changed, ignore=arrays_of(attribute, TAGS.get(place, place)))
    assert compare(plain, _model("sensor", 'noise="0.5"'), ignore=arrays_of("friction", "geom"))


def test_the_tables_speak_of_what_mjcf_has() -> None:
    assert set(_BECOMES) - {"target", "force"} <= set(attributes())
    tags = {
        tag for section in ("worldbody", "tendon", "equality", "actuator") for tag in GRAMMAR.within(section)
    }
    assert set(_KINDS) <= tags

"""What MJX and MuJoCo Warp refuse, and what other programs compute otherwise, is told before they do."""

from __future__ import annotations

from pathlib import Path

import pytest
from targets.writing import codes, written

BODY = """<mujoco model="m"><option {option}>{flags}</option>
  <worldbody><body name="b" {body}><joint name="j" {joint}/><geom name="g" size=".1" {geom}/><site name="s"/></body>
  <body name="c"><geom name="h" type="mesh" mesh="m"/></body></worldbody>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  {more}</mujoco>"""


def model(**given: str) -> str:
    keys = ("option", "flags", "body", "joint", "geom", "more")
    return BODY.format(**{key: given.get(key, "") for key in keys})


BODY_SENSOR = '<sensor><contact body1="b" num="1"/></sensor>'
NETFORCE = '<sensor><contact geom1="g" geom2="h" num="1" reduce="netforce"/></sensor>'


PLUGIN = (
    '<extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="1"/></instance></plugin>'
    '</extension><actuator><plugin name="p" joint="j" plugin="mujoco.pid" instance="i" actdim="0"/></actuator>'
)


@pytest.mark.parametrize(
    ("target", "given", "told"),
    [
        ("mjx", {"option": 'integrator="implicit"'}, "option: MJX has no integrator `implicit`"),
        ("mjx", {"option": 'solver="PGS"'}, "option: MJX has no solver `pgs`"),
        ("mjx", {"flags": '<flag energy="enable"/>'}, "option: MJX does not have the flag `energy`"),
        ("mjx", {"geom": 'margin=".01"'}, "geom `g`: MJX has no margin for contacts with meshes and height fields"),
        ("mjx", {"more": '<actuator><adhesion name="a" body="b" ctrlrange="0 1"/></actuator>'},
         "general `a`: MJX has no such transmission"),
        ("mjx", {"more": '<sensor><jointlimitpos name="l" joint="j"/></sensor>', "joint": 'range="-1 1"'},
         "jointlimitpos `l`: MJX has no such sensor"),
        ("mjx", {"more": BODY_SENSOR}, "contact: MJX has no contact sensor of a body"),
        ("mjx", {"more": BODY_SENSOR.replace('body1="b"', 'site="s"')}, "contact: MJX has no contact sensor of a site"),
        ("mjx", {"more": '<contact><pair name="p" geom1="g" geom2="h" margin=".1"/></contact>'},
         "pair `p`: MJX has no margin for contacts with meshes and height fields"),
        ("mjx", {"more": NETFORCE}, "contact: MJX has no contact sensor of the net force"),
        ("warp", {"option": 'solver="PGS"'}, "option: MuJoCo Warp has no solver `pgs`"),
        ("warp", {"body": 'sleep="init"', "joint": 'type="free"'},
         "body `b`: MuJoCo Warp has no body that sleeps from the start"),
        ("warp", {"more": PLUGIN}, "plugin `p`: a plugin computes this actuator"),
        ("warp", {"flags": '<flag fwdinv="enable"/>'}, "option: MuJoCo Warp does not have the flag `fwdinv`"),
    ],
)  # fmt: skip
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


@pytest.mark.mujoco4("it has no pid")
@pytest.mark.parametrize(("target", "name"), [("mjx", "MJX"), ("warp", "MuJoCo Warp")])
def test_neither_has_a_pid(target: str, name: str, tmp_path: Path) -> None:
    more = '<actuator><pid name="a" joint="j" kp="3" ki="1" kv="1" input="pos"/></actuator>'
    bundle, context = written(model(more=more), target, tmp_path)
    assert bundle is None and all(f"{name} has no such" in each.message for each in context.sink.errors)


@pytest.mark.parametrize(
    ("target", "given", "told"),
    [
        ("drake", {"option": 'timestep=".01" cone="elliptic"'},
         "option: it does not read `timestep`, `cone`: the program has settings of its own"),
        ("pybullet", {"flags": '<flag contact="disable"/>'},
         "option: it does not read `flag`: the program has settings of its own"),
        ("pinocchio", {"option": 'gravity="0 0 -1.6"'}, "option: gravity is not read: set it to 0 0 -1.6 in the program"),
        ("newton", {"option": 'gravity="0 0 -1.6"'}, "option: gravity is not read: set it to 0 0 -1.6 in the program"),
        ("drake", {"geom": 'solref=".01 1" condim="4"'}, "geom `g`: it does not read `solref`, `condim` of its contacts"),
        ("drake", {"geom": 'friction=".5 .1"'}, "geom `g`: it does not read torsional friction of its contacts"),
        ("urdf", {"geom": 'friction=".5"'}, "geom `g`: it does not read sliding friction of its contacts"),
        ("drake", {"geom": 'contype="2"'},
         "geom `g`: its `contype` and `conaffinity` are not read: it collides with everything"),
        ("drake", {"joint": 'range="-1 1" margin=".1"'}, "joint `j`: it does not read `margin` of its limit"),
        ("drake", {"body": 'gravcomp="1"'}, "body `b`: its `gravcomp` is not read: all of its weight pulls"),
    ],
)  # fmt: skip
def test_it_is_lost(target: str, given: dict[str, str], told: str, tmp_path: Path) -> None:
    plain = {each.message for each in written(model(), target, tmp_path)[1].sink.diagnostics}
    bundle, context = written(model(**given), target, tmp_path)
    assert bundle is not None
    assert {each.message for each in context.sink.diagnostics} - plain == {told}


def test_what_drake_reads_is_not_lost(tmp_path: Path) -> None:
    text = model(option='gravity="0 0 -1.6" iterations="9" tolerance="1e-5"', geom='friction=".5"')
    plain = {each.message for each in written(model(), "drake", tmp_path)[1].sink.diagnostics}
    assert {each.message for each in written(text, "drake", tmp_path)[1].sink.diagnostics} == plain

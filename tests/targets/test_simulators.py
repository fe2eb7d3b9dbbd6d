"""What MJX and MuJoCo Warp refuse, and what other programs compute otherwise, is told before they do."""

from __future__ import annotations

from pathlib import Path

import pytest
from targets.refused import ALL, CARRIED, ELASTIC, model
from targets.writing import codes, written


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

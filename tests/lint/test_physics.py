from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import check_case, linted
from mjcompose.mujoco.engine import Session

BOX = '<geom type="box" size=".1 .1 .1"/>'
ARM = """<mujoco><worldbody><body><joint name="shoulder" axis="0 1 0"{joint}/>
  <geom type="capsule" fromto="0 0 0 1 0 0" size=".05" mass="1"/></body></worldbody>
  <actuator>{actuator}</actuator><keyframe><key name="home"/></keyframe></mujoco>"""
FREE = """<mujoco><default><joint damping="1"/></default><worldbody>
  <body>{free}<geom size=".1"/><body><joint/><geom size=".1"/></body></body></worldbody></mujoco>"""


def body(inside: str, compiler: str = "") -> str:
    return f"<mujoco>{compiler}<worldbody><body name='link'><freejoint/>{inside}</body></worldbody></mujoco>"


def inertial(mass: float, inertia: str = ".01 .01 .01", pos: str = "0 0 0") -> str:
    return f'<inertial pos="{pos}" mass="{mass}" diaginertia="{inertia}"/>{BOX}'


def arm(actuator: str, joint: str = "", option: str = "") -> str:
    return ARM.format(joint=f" {joint}", actuator=actuator).replace("<worldbody>", f"{option}<worldbody>")


CAMERA = BOX + '<body><joint/><inertial pos="0 0 0" mass="1e-7" diaginertia="1e-7 1e-7 1e-7"/><geom size=".1"/></body>'
STIFF = '<position joint="shoulder" kp="{}" kv="1"/>'
WEAK = '<position joint="shoulder" kp="50" kv="5" forcerange="-{0} {0}"/>'
NUMB = '<motor joint="shoulder" ctrlrange="-1 1" gear="{}"/>'
COMPENSATED = arm(NUMB.format(1), 'actuatorgravcomp="true"').replace("<body>", '<body gravcomp="1">')
BALANCED = '<compiler balanceinertia="true"/>'
IGNORED = '<compiler inertiafromgeom="true"/>'
CASES = [
    ("inertia-implausible", body(inertial(1, "1 1 1")), body(inertial(1)), "radius of gyration is 1 m"),
    (
        "inertia-implausible",
        body(inertial(1, pos=".6 0 0")),
        body(inertial(1, pos=".1 0 0")),
        "center of mass is 0.5 m",
    ),
    ("inertia-implausible", body(inertial(1, "1 1 1")), body(CAMERA), ""),
    ("density-impossible", body(inertial(8000, "99 99 99")), body(inertial(80, "1 1 1")), "weighs 8000 kg in 8000 cm³"),
    ("inertial-missing", body(BOX), body(BOX.replace("/>", ' mass="1"/>')), "body `link` has no `<inertial>`"),
    ("inertial-ignored", body(inertial(2), IGNORED), body(inertial(8), IGNORED), "it computes 8 kg from the geoms"),
    ("inertial-ignored", body(inertial(2), IGNORED), body(inertial(2)), "ignores this `mass` of 2 kg"),
    (
        "inertia-balanced",
        body(inertial(1, ".01 .01 .09"), BALANCED),
        body(inertial(1, ".01 .02 .03"), BALANCED),
        "replaces all three by 0.03667",
    ),
    ("free-joint-damped", FREE.format(free='<joint type="free"/>'), FREE.format(free="<freejoint/>"), "`damping` 1"),
    (
        "free-joint-damped",
        FREE.format(free='<joint type="free"/>'),
        FREE.format(free='<joint type="free" damping="2"/>'),
        "as hinges have",
    ),
    ("timestep-too-long", arm(STIFF.format(1e6)), arm(STIFF.format(1e5)), "in each step of 2 ms; up to 1.2 ms it does"),
    (
        "timestep-too-long",
        arm('<velocity joint="shoulder" kv="900"/>'),
        arm('<velocity joint="shoulder" kv="900"/>', option='<option integrator="implicitfast"/>'),
        "small motions grow",
    ),
    (
        "timestep-too-long",
        arm(STIFF.format(3e6), option='<option integrator="RK4"/>'),
        arm(STIFF.format(3e5), option='<option integrator="RK4"/>'),
        "joint `shoulder` with actuator #0",
    ),
    ("servo-undamped", arm('<position joint="shoulder" kp="9"/>'), arm(STIFF.format(9)), "with 9 N·m/rad"),
    ("servo-undamped", arm('<position joint="shoulder"/>'), arm('<position joint="shoulder"/>', 'damping="1"'), ""),
    (
        "friction-exceeds-motor",
        arm(NUMB.format(2), 'frictionloss="3"'),
        arm(NUMB.format(4), 'frictionloss="3"'),
        "3 N·m of dry friction, and its actuators give at most 2 N·m",
    ),
    ("motor-too-weak", arm(WEAK.format(4)), arm(WEAK.format(6)), "in keyframe `home` takes -4.905 N·m"),
    ("motor-too-weak", arm(WEAK.format(4)), arm(WEAK.format(4), 'frictionloss="2"'), "give -4 to 4 N·m"),
    ("motor-too-weak", arm(NUMB.format(1)), arm(NUMB.format(1)).replace("<body>", '<body gravcomp="1">'), ""),
    ("motor-too-weak", arm(NUMB.format(1)), COMPENSATED, "-1 to 1 N·m"),
    ("armature-missing", arm(STIFF.format(9)), arm(STIFF.format(9), 'armature=".1"'), "has an actuator"),
    (
        "simulation-diverges",
        arm('<velocity joint="shoulder" kv="9000"/>', option='<option gravity="0 0 -9"/>'),
        arm(STIFF.format(9)),
        "from keyframe `home`, the simulation is unstable",
    ),
]


@pytest.mark.parametrize("case", CASES)
def test_a_fault_is_found_and_a_near_model_is_not(
    case: tuple[str, str, str, str], tmp_path: Path, session: Session
) -> None:
    check_case(case, tmp_path, session)


def test_joints_that_an_equality_couples_are_not_judged_alone(tmp_path: Path, session: Session) -> None:
    coupled = arm(STIFF.format(1e6)).replace("<actuator>", '<equality><joint joint1="shoulder"/></equality><actuator>')
    assert not linted(coupled, "timestep-too-long", tmp_path, session)


def test_a_mass_that_is_guessed_is_found_in_urdf_alone(tmp_path: Path, session: Session) -> None:
    box = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'

    def found(inside: str) -> list[tuple[str, int]]:
        text = f"""<robot name="r">
          <link name="base">{box}</link>
          <link name="arm">{box}{inside}</link>
          <joint name="j" type="continuous"><parent link="base"/><child link="arm"/></joint></robot>"""
        findings = linted(text, "mass-guessed", tmp_path, session, name="r.urdf")
        return [(each.message, 0 if each.span is None else each.span.line) for each in findings]

    assert found("") == [("the link `arm` has no `<inertial>`: its shapes weigh 1000 kg/m³", 3)]
    assert found(mass) == []
    assert not linted(body(BOX), "mass-guessed", tmp_path, session)

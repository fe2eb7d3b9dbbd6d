"""Models that the consumers read: recipes of the project, and some with what is seldom."""

from __future__ import annotations

from pathlib import Path

import mujoco

RECIPES = Path(__file__).parents[2] / "recipes"

_SELDOM = """<mujoco model="seldom">
  <default><default class="bar"><geom type="capsule" size="0.04 0.1" rgba="1 0 0 1"/></default></default>
  <worldbody>
    <body name="stand" pos="0.3 -0.2 0.5" quat="0.8 0 0.6 0">
      <geom type="box" size="0.1 0.2 0.05" pos="0.02 0 0"/>
      <body name="two_joints" pos="0 0 0.2" euler="20 5 -30">
        <joint name="turn" axis="0 1 1" pos="0.05 0 0.02" range="-60 100" ref="20"/>
        <joint name="slide" type="slide" axis="1 0 0" range="-0.1 0.2" ref="0.05"/>
        <geom class="bar"/>
        <frame pos="0 0 0.1" euler="0 30 0">
          <body name="tip" pos="0 0 0.05">
            <joint name="spin" axis="1 0 0" damping="0.1"/>
            <geom type="cylinder" size="0.02 0.05" contype="0" conaffinity="0"/>
            <geom size="0.03" pos="0.1 0 0"/>
            <body name="pad" pos="0 0.1 0"><geom type="box" size="0.01 0.01 0.02"/></body>
          </body>
        </frame>
        {fingers}
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="stand" body2="two_joints"/></contact>
  <equality><joint joint1="bend_0" joint2="bend_1" polycoef="0.1 0.5 0 0 0"/></equality>
  <actuator>
    <position name="turn" joint="turn" kp="50" kv="2" forcerange="-30 30" ctrlrange="-1 1"/>
    <motor name="slide" joint="slide" gear="2" ctrlrange="-5 5"/>
  </actuator>
  <keyframe><key name="home" qpos="0.4 0.1 0 0.2 0.2"/></keyframe>
</mujoco>
"""
_FINGER = """<body name="finger{}" pos="0 {} 0.3"><joint name="bend{}" axis="0 0 1" range="0 40"/><geom class="bar"/></body>"""
_REPLICATED = f'<replicate count="2" offset="0 0.2 0" sep="_">{_FINGER.format("", -0.1, "")}</replicate>'
_WRITTEN_OUT = _FINGER.format("_0", -0.1, "_0") + _FINGER.format("_1", 0.1, "_1")


def _reads(text: str) -> bool:
    try:
        mujoco.MjSpec.from_string(text)
    except ValueError:
        return False
    return True


SELDOM = _SELDOM.replace("{fingers}", _REPLICATED)
# MuJoCo 3.12 takes no key of all joints where some are made by a `replicate`.
SELDOM = SELDOM if _reads(SELDOM) else _SELDOM.replace("{fingers}", _WRITTEN_OUT)
"""Several joints of one body away from its origin, references that are not zero, frames, copies, what is fixed."""

PROBE = """<mujoco model="probe">
  <asset>
    <hfield name="t" nrow="2" ncol="2" size="1 1 .1 .1" elevation="0 0 0 1"/>
    <texture name="chk" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 1 0" width="16" height="16"/>
    <material name="m1" texture="chk"/>
    <mesh name="tet" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .1"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1" pos="0 0 -1" material="m1"/>
    <geom name="hills" type="hfield" hfield="t" pos="3 0 0"/>
    <body name="base" pos="0 0 .5">
      <geom name="gbox" type="box" size=".1 .1 .1"/>
      <body name="b1" pos="0 0 .2"><joint name="j1" axis="0 1 0" range="-60 60" damping=".5" frictionloss=".05" armature=".02" actuatorfrcrange="-7 7"/><geom name="gcap" type="capsule" size=".03 .1"/>
        <body name="b2" pos="0 0 .2"><joint name="j2" axis="0 1 0" damping=".3" armature=".01" /><geom name="gcyl" contype="0" conaffinity="0" type="cylinder" size=".03 .1"/>
          <body name="b3" pos="0 0 .2"><joint name="j3" axis="1 0 0" damping=".1" armature=".03" stiffness="2" springref="10"/><geom name="gell" contype="0" conaffinity="0" type="ellipsoid" size=".03 .04 .05"/>
            <body name="b4" pos="0 0 .2"><joint name="j4" type="slide" axis="0 0 1" range="-.1 .1" damping="3" frictionloss=".2"/><geom name="gmesh" type="mesh" mesh="tet"/>
              <geom name="gsph" size=".02" pos=".1 0 0" contype="0" conaffinity="0" group="2"/>
              <body name="b5" pos="0 0 .2"><joint name="j5" axis="0 0 1" armature=".007"/><geom name="g5" type="box" size=".02 .03 .04"/>
                <body name="b6" pos="0 0 .2"><joint name="j6" axis="0 1 0"/><geom name="g6" type="box" size=".02 .03 .04" rgba="1 0 0 1"/><geom name="hidden" type="box" size=".01 .01 .01" contype="0" conaffinity="0" group="3"/></body>
              </body></body></body></body></body></body>
    <body name="free" pos="1 0 1"><freejoint name="ff"/><geom name="gf" type="box" size=".1 .1 .1"/></body>
  </worldbody>
  <actuator>
    <motor name="a1" joint="j1" gear="3" ctrlrange="-5 5" forcerange="-4 6"/>
    <position name="a2" joint="j2" kp="50" kv="2" forcerange="-3.5 3.5" ctrlrange="-1 1"/>
    <velocity name="a3" joint="j3" kv="4" ctrlrange="-2 2"/>
    <position name="a4" joint="j4" kp="500" gear="2"/>
    <position name="a5" joint="j5" kp="7" kv="1" ctrlrange="-1 1"/>
  </actuator>
  <keyframe><key name="home" qpos=".1 .2 -.1 .05 .3 0 1 0 1 1 0 0 0"/></keyframe>
</mujoco>
"""
"""All shapes, all numbers of joints, motors and servos."""

ODD = """<mujoco model="odd">
  <worldbody>
    <body name="base" pos="0 0 .5"><geom name="gbox" type="box" size=".1 .1 .1"/>
      <body name="hub" pos="0 0 .1">
      <body name="b1" pos="0 0 .2"><joint name="j1" axis="0 1 0" damping=".5 .2" armature=".02"/><geom name="gcap" type="capsule" size=".03 .1"/>
        <body name="b2" pos="0 0 .2"><joint name="j2" axis="0 1 0" damping=".3" armature=".01" stiffness="3 .3"/><geom name="g2" type="capsule" size=".03 .1"/>
          <body name="b3" pos="0 0 .2"><joint name="j3" axis="1 0 0" damping=".1" armature=".03"/><geom name="g3" type="box" size=".02 .03 .05"/>
            <body name="b4" pos="0 0 .2"><joint name="j4" axis="0 1 0" armature=".05"/><geom name="g4" type="box" size=".02 .03 .05"/>
            <body name="b5" pos="0 0 .2"><joint name="j5" axis="0 1 0" armature=".05" actuatorfrcrange="-3 2"/><geom name="g5" type="box" size=".02 .03 .05"/></body></body></body></body></body></body></body>
    <body name="free" pos="1 0 1"><joint name="ff" type="free" damping=".3" armature=".2" frictionloss=".1"/><geom name="gf" type="box" size=".1 .1 .1"/></body>
  </worldbody>
  <tendon><fixed name="t" stiffness="4" damping=".2"><joint joint="j3" coef="1"/><joint joint="j4" coef="-1"/></fixed></tendon>
  <actuator>
    <motor name="a1" joint="j1" gear="-3" ctrlrange="0 5"/>
    <motor name="a1b" joint="j1" armature=".05"/>
    <position name="a2" joint="j2" kp="50" ctrlrange="-1 1" ctrllimited="true" forcerange="-1 0"/>
    <general name="a3" joint="j3" gainprm="3" gear="2"/>
    <motor name="a4" joint="j4" gear="7"/>
    <motor name="a4b" joint="j4" ctrlrange="-1 1"/>
    <position name="at" tendon="t" kp="3"/>
    <position name="a5" joint="j5" kp="30" forcerange="-9 9"/>
  </actuator>
  <keyframe><key name="other"/><key name="home" qpos=".1 .2 -.1 .3 -.2 1 0 1 1 0 0 0"/></keyframe>
</mujoco>
"""
"""What several programs read in part: several actuators of a joint, ranges with unlike sides, polynomials, a massless body."""

BALL = """<mujoco model="ball"><worldbody><body name="post" pos="0 0 1"><geom name="post" size=".05"/>
  <body name="bob" pos="0 0 -.1"><joint name="swing" type="ball" damping=".2" armature=".003"/>
    <geom name="bob" type="box" size=".02 .03 .04" pos=".1 0 -.1"/>
    <body name="arm" pos=".2 0 0"><joint name="j" axis="0 1 0"/><geom name="arm" type="capsule" size=".02 .1"/></body></body></body>
</worldbody></mujoco>
"""
PROBES = {"seldom": SELDOM, "probe": PROBE, "odd": ODD, "ball": BALL}

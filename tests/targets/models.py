"""Models that the consumers read: recipes of the project, and one with what is seldom."""

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

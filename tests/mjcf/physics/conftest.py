"""One model with an element of nearly every kind that MuJoCo compiles."""

from __future__ import annotations

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import Physics, RootElement

EVERYTHING = """
<mujoco model="everything">
  <asset>
    <texture name="t" type="2d" builtin="flat" width="4" height="2"/>
    <material name="m" texture="t"/>
    <mesh name="me" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <hfield name="hf" nrow="3" ncol="2" size="1 1 1 1"/>
  </asset>
  <worldbody>
    <light name="l" pos="0 0 4"/>
    <camera name="c" pos="0 -3 1" xyaxes="1 0 0 0 0 1"/>
    <body name="a" pos="0 0 1">
      <freejoint name="f"/>
      <geom name="g" size="0.1"/>
      <site name="s"/>
      <body name="b" pos="0 0 1">
        <joint name="h" axis="0 1 0"/>
        <geom name="g2" size="0.1" density="5" friction="0.9 0.1 0.1"/>
        <body name="c" pos="0 0 1">
          <joint name="h2" axis="0 1 0" range="-1 1"/>
          <joint name="ball" type="ball" pos="0 0 0.5"/>
          <geom name="g3" size="0.1"/>
        </body>
      </body>
    </body>
    <body name="mo" mocap="true" pos="1 2 3"><geom name="mg" size="0.1" contype="0"/></body>
    <body name="mo2" mocap="true" pos="4 5 6"/>
  </worldbody>
  <contact>
    <pair name="p" geom1="g" geom2="g2"/>
    <exclude name="x" body1="a" body2="b"/>
  </contact>
  <equality><joint name="e" joint1="h" joint2="h2"/><weld name="w" body1="a" body2="mo" active="false"/></equality>
  <tendon><fixed name="te"><joint joint="h" coef="1"/><joint joint="h2" coef="2"/></fixed></tendon>
  <actuator>
    <motor name="mot" joint="h" gear="3"/>
    <general name="state" joint="h2" dyntype="filter" dynprm="1" gainprm="5"/>
    <position name="pos" joint="h2"/>
  </actuator>
  <sensor>
    <framepos name="fp" objtype="site" objname="s"/>
    <jointpos name="jp" joint="h"/>
    <framequat name="fq" objtype="site" objname="s"/>
  </sensor>
  <custom>
    <numeric name="n" data="1 2"/><text name="tx" data="hi"/>
    <tuple name="tu"><element objtype="body" objname="a" prm="1"/></tuple>
  </custom>
  <keyframe>
    <key name="k" time="2" qpos="0 0 3 1 0 0 0 0.5 0.25 1 0 0 0" ctrl="1 2 3" act="0.5"/>
    <key time="4" ctrl="4 5 6"/>
  </keyframe>
</mujoco>
"""


@pytest.fixture
def model() -> RootElement:
    return mjcf.from_xml_string(EVERYTHING)


@pytest.fixture
def physics(model: RootElement) -> Physics:
    physics = model.compile_model()
    physics.data.qvel[:] = [0.1 * row for row in range(physics.model.nv)]
    physics.data.ctrl[:] = [0.2, 0.3, 0.4]
    physics.step(3)
    return physics

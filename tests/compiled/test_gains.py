from __future__ import annotations

import mujoco
import pytest

from composer.compiled.gains import same_dampratio

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

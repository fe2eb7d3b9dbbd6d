"""What is predicted for a time step is what MuJoCo does with it."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.controls import moment_arms
from mjcompose.mujoco.servos import Servos

ARM = """<mujoco><option integrator="{}" timestep="{}" gravity="0 0 0"/><worldbody><body>
  <joint name="shoulder" axis="0 1 0" damping="{}"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
  <body pos=".3 0 0"><joint name="elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .2 0 0" size=".02"/></body>
</body></worldbody><actuator><position joint="shoulder" kp="300" kv="{}"/><position joint="elbow" kp="80" kv=".05"/>
</actuator></mujoco>"""
CASES = [
    (integrator, damping, kv)
    for integrator in ("Euler", "RK4", "implicit", "implicitfast")
    for damping, kv in ((0.0, 0.1), (2.0, 0.1), (0.1, 3.0))
]


def servos(integrator: str, timestep: float, damping: float, kv: float) -> Servos:
    model = mujoco.MjModel.from_xml_string(ARM.format(integrator, timestep, damping, kv))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Servos(mujoco, model, data)


def grows(found: Servos) -> bool:
    data = mujoco.MjData(found.model)
    data.qpos[:] = 1e-7, -2e-7
    largest = 0.0
    for _ in range(800):
        mujoco.mj_step(found.model, data)  # which resets a state that has become huge
        largest = max(largest, float(np.abs(data.qpos).max()))
    return largest > 1e-5


@pytest.mark.parametrize(("integrator", "damping", "kv"), CASES)
def test_motions_grow_above_the_longest_step_and_not_below(integrator: str, damping: float, kv: float) -> None:
    modes = list(servos(integrator, 0.2, damping, kv).unstable())
    assert modes
    assert modes[0].factor > 1
    longest = modes[0].timestep
    assert longest is not None
    below, above = (servos(integrator, factor * longest, damping, kv) for factor in (0.95, 1.05))
    assert not list(below.unstable())
    assert list(above.unstable())
    assert not grows(below)
    assert grows(above)


def test_the_strongest_force_is_that_of_all_actuators_within_the_limit_of_the_joint() -> None:
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><body>
      <joint name="a" actuatorfrcrange="-5 5"/><geom size="1"/></body></worldbody><actuator>
      <motor joint="a" gear="2" ctrlrange="-1 2"/><position joint="a" gear="-1" forcerange="-3 1"/></actuator></mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert Servos(mujoco, model, data).strongest(0) == (-3, 5)


TREES = """<mujoco><worldbody>{bodies}</worldbody><tendon><fixed name="t">{ends}</fixed></tendon><actuator>
  <position tendon="t" kp="7" kv="2"/>{servos}<motor joint="a0"/></actuator></mujoco>"""


def test_each_tree_has_the_block_of_the_whole_matrix() -> None:
    bodies = "".join(
        f'<body pos="{at} 0 0"><joint name="a{at}" axis="0 1 0" stiffness="{at}"/><geom size=".1"/>'
        f'<body pos="0 0 1"><joint name="b{at}" type="slide" stiffness="3"/><geom size=".1"/></body></body>'
        for at in range(4)
    )
    ends = '<joint joint="a1" coef="2"/><joint joint="b1" coef="-1"/><joint joint="b3" coef="3"/>'
    springs = "".join(
        f'<position joint="{name}" kp="{kp}" kv="1" gear="2"/>' for kp, name in enumerate(("a0", "b0", "b3"))
    )
    model = mujoco.MjModel.from_xml_string(TREES.format(bodies=bodies, ends=ends, servos=springs))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found = Servos(mujoco, model, data)
    moment = moment_arms(mujoco, model, data)
    gains = np.array([found.gains(actuator) for actuator in range(model.nu)])
    mass = np.zeros((model.nv, model.nv))
    for dof, row in enumerate(mass):
        mujoco.mj_mulM(model, data, row, np.eye(model.nv)[dof])
    for dofs in (slice(0, 8), slice(0, 2), slice(2, 4), slice(6, 8), slice(3, 4)):
        expected = moment.T @ (gains[:, :1] * moment) + np.diag(model.jnt_stiffness.ravel()[:8])
        assert np.allclose(found.stiffness(dofs), expected[dofs, dofs])
        assert np.allclose(found.damping(dofs), (moment.T @ (gains[:, 1:] * moment))[dofs, dofs])
        assert np.allclose(found.inertia(dofs), mass[dofs, dofs])
    for dof in range(model.nv):
        assert found.of_dof(dof) == np.flatnonzero(moment[:, dof]).tolist()

"""Facts of a model as MJX reads it."""

import copy
from importlib.metadata import version

import jax
import jax.numpy as jp
import mujoco
import numpy as np
from facts import of_mujoco, without_forces
from mujoco import mjx


def read(file):
    jax.config.update("jax_enable_x64", True)
    model = mujoco.MjModel.from_xml_path(file)
    on_device = mjx.put_model(model)
    data = mjx.make_data(model)

    def placed(rows):
        moved = jax.jit(jax.vmap(lambda q: mjx.kinematics(on_device, data.replace(qpos=q))))(jp.array(rows))
        return moved.xpos, moved.xmat

    def moved(start, steps):
        without = without_forces(mujoco, copy.copy(model))
        free = mjx.put_model(without)
        step = jax.jit(mjx.step)
        at = mjx.make_data(without).replace(qpos=jp.array(start))
        for _ in range(steps):
            at = step(free, at)
        return at.qpos

    def driven(only, start, full, eased, steps):
        put = mjx.put_model(only)
        still = mjx.make_data(only).replace(qpos=jp.array(start))
        step = jax.jit(mjx.step)
        at = still.replace(ctrl=jp.array(eased))
        # A step has the forces of its start.
        forces = step(put, still.replace(ctrl=jp.array(full))).qfrc_actuator
        for _ in range(steps):
            at = step(put, at)
        return forces, at.qpos

    def array(name):
        return np.array(getattr(on_device, name))

    return of_mujoco(version("mujoco-mjx"), model, array, placed=placed, moved=moved, driven=driven)

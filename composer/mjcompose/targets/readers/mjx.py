"""Facts of a model as MJX reads it: `python mjx.py MODEL POSES.json FACTS.json`."""

import sys
from importlib.metadata import version
from pathlib import Path

import jax
import jax.numpy as jp
import mujoco
import numpy as np
from mujoco import mjx

# Not this folder: its `warp.py` and others would stand for the packages of these names.
sys.path.append(str(Path(__file__).with_name("shared")))
from mujoco_facts import without_forces, write_facts

jax.config.update("jax_enable_x64", True)
model = mujoco.MjModel.from_xml_path(sys.argv[1])
on_device = mjx.put_model(model)
data = mjx.make_data(model)


def placed(rows):
    moved = jax.jit(jax.vmap(lambda q: mjx.kinematics(on_device, data.replace(qpos=q))))(jp.array(rows))
    return moved.xpos, moved.xmat


def moved(start, steps):
    free = mjx.put_model(without_forces(mujoco, model))
    step, at = jax.jit(mjx.step), mjx.make_data(model).replace(qpos=jp.array(start))
    for _ in range(steps):
        at = step(free, at)
    return at.qpos


write_facts(version("mujoco-mjx"), model, lambda name: np.array(getattr(on_device, name)), placed, moved)

"""Facts of a model as MuJoCo Warp reads it: `python warp.py MODEL POSES.json FACTS.json`."""

import sys
from importlib.metadata import version
from pathlib import Path

import mujoco
import mujoco_warp as mjw
import warp as wp

# Not this folder: its `warp.py` and others would stand for the packages of these names.
sys.path.append(str(Path(__file__).with_name("shared")))
from mujoco_facts import without_forces, write_facts

model = mujoco.MjModel.from_xml_path(sys.argv[1])
with wp.ScopedDevice("cpu"):
    on_device = mjw.put_model(model)


def array(name):
    """The values of a field for the first world; MuJoCo Warp has no force range of joints by itself."""
    found = getattr(on_device, name, None)
    if found is None:
        return getattr(model, name)
    found = found.numpy()
    return (
        found[0]
        if (found.ndim and len(found) == 1 and len(getattr(model, name)) != 1) or found.ndim > getattr(model, name).ndim
        else found
    )


def placed(rows):
    with wp.ScopedDevice("cpu"):
        data = mjw.make_data(model, nworld=len(rows))
        data.qpos = wp.array(rows, dtype=float)
        mjw.kinematics(on_device, data)
    return data.xpos.numpy(), data.xmat.numpy()


def moved(start, steps):
    with wp.ScopedDevice("cpu"):
        free, data = mjw.put_model(without_forces(mujoco, model)), mjw.make_data(model)
        data.qpos = wp.array(start[None], dtype=float)
        for _ in range(steps):
            mjw.step(free, data)
    return data.qpos.numpy()[0]


write_facts(version("mujoco-warp"), model, array, placed, moved)

"""Facts of a model as MuJoCo Warp reads it: `python warp.py MODEL POSES.json FACTS.json`."""

import sys
from pathlib import Path

import mujoco
import mujoco_warp as mjw
import warp as wp

# Not this folder: its `warp.py` and others would stand for the packages of these names.
sys.path.append(str(Path(__file__).with_name("shared")))
from mujoco_facts import write_facts

model = mujoco.MjModel.from_xml_path(sys.argv[1])
with wp.ScopedDevice("cpu"):
    on_device = mjw.put_model(model)


def array(name):
    """What a field has for the first world."""
    found = getattr(on_device, name).numpy()
    return found[0] if found.ndim and len(found) == 1 else found


def placed(rows):
    with wp.ScopedDevice("cpu"):
        data = mjw.make_data(model, nworld=len(rows))
        data.qpos = wp.array(rows, dtype=float)
        mjw.kinematics(on_device, data)
    return data.xpos.numpy(), data.xmat.numpy()


write_facts("mujoco-warp", model, array, placed)

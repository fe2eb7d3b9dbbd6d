"""Facts of a model as MuJoCo Warp reads it."""

import copy
from importlib.metadata import version

import mujoco
import mujoco_warp as mjw
import warp as wp
from facts import of_mujoco, without_forces


def read(file):
    wp.set_device("cpu")
    model = mujoco.MjModel.from_xml_path(file)
    on_device = mjw.put_model(model)

    def array(name):
        """Return a field for the first world; MuJoCo Warp has no force range of joints by itself."""
        mine = getattr(model, name)
        found = getattr(on_device, name, None)
        if found is None:
            return mine
        found = found.numpy()
        has_worlds = found.ndim > mine.ndim or (found.ndim and len(found) == 1 and len(mine) != 1)
        return found[0] if has_worlds else found

    def placed(rows):
        data = mjw.make_data(model, nworld=len(rows))
        data.qpos = wp.array(rows, dtype=float)
        mjw.kinematics(on_device, data)
        return data.xpos.numpy(), data.xmat.numpy()

    def moved(start, steps):
        without = without_forces(mujoco, copy.copy(model))
        free = mjw.put_model(without)
        data = mjw.make_data(without)
        data.qpos = wp.array(start[None], dtype=float)
        for _ in range(steps):
            mjw.step(free, data)
        return data.qpos.numpy()[0]

    def driven(only, start, full, eased, steps):
        put = mjw.put_model(only)

        def at_start(controls):
            data = mjw.make_data(only)
            data.qpos = wp.array(start[None], dtype=float)
            data.ctrl = wp.array(controls[None], dtype=float)
            return data

        still = at_start(full)
        data = at_start(eased)
        mjw.forward(put, still)
        for _ in range(steps):
            mjw.step(put, data)
        return still.qfrc_actuator.numpy()[0], data.qpos.numpy()[0]

    return of_mujoco(version("mujoco-warp"), model, array, placed=placed, moved=moved, driven=driven)

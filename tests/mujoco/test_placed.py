from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.attributes import place

MANY = "".join(f'<body pos="{n} 0 0"><geom size="0.1"/></body>' for n in range(3000))


@pytest.mark.skipif(int(mujoco.__version__.split(".")[0]) < 4, reason="needs an error that can be caught")
def test_a_model_without_room_for_contacts_has_places() -> None:
    text = f'<mujoco><worldbody>{MANY}<body name="end" pos="0 1 0"><joint/><geom size="1"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[0] = np.pi / 2
    with pytest.raises(mujoco.FatalError):
        mujoco.mj_forward(model, mujoco.MjData(model))
    place(mujoco, model, data)
    assert np.allclose(data.body("end").xquat, [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    assert data.ncon == 0 and model.opt.disableflags == 0

from __future__ import annotations

import mujoco

from composer.compiled.joints import BALL, FREE, HINGE, JOINT_TYPES, SLIDE
from composer.compiled.kinds import HOLDERS, KINDS


def test_every_name_in_the_table_is_of_mujoco() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    arrays = [kind.addresses for kind in KINDS.values()] + list(HOLDERS.values())
    sizes = [kind.size for kind in KINDS.values() if kind.size != "nactuator"]  # that is new in MuJoCo 4
    assert [name for name in arrays + sizes if not hasattr(compiled, name)] == []
    for word, kind in KINDS.items():
        assert kind.object_type == int(getattr(mujoco.mjtObj, f"mjOBJ_{word.upper()}"))


def test_joints_are_mujocos() -> None:
    types = mujoco.mjtJoint
    ours = (FREE, BALL, SLIDE, HINGE)
    assert ours == tuple(map(int, (types.mjJNT_FREE, types.mjJNT_BALL, types.mjJNT_SLIDE, types.mjJNT_HINGE)))
    for number, kind in zip(ours, JOINT_TYPES, strict=True):
        assert types(number).name == f"mjJNT_{kind.word.upper()}"
        one = "<freejoint/>" if kind.word == "free" else f'<joint type="{kind.word}"/>'
        text = f'<mujoco><worldbody><body>{one}<geom size="1"/></body></worldbody></mujoco>'
        compiled = mujoco.MjModel.from_xml_string(text)
        assert (kind.positions, kind.velocities) == (compiled.nq, compiled.nv)

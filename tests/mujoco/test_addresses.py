from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf.binding import fields
from mjcompose.mujoco.addresses import RUNS
from mjcompose.mujoco.attributes import KINDS

FLEXES = """
<mujoco><option integrator="Euler"/><worldbody>
  <flexcomp name="cloth" type="grid" count="3 4 1" spacing="0.1 0.1 0.1" pos="0 0 2" radius="0.01"/>
  <flexcomp name="rope" type="grid" dim="1" count="5 1 1" spacing="0.1 0.1 0.1" pos="0 1 2" radius="0.01"/>
</worldbody></mujoco>
"""


def test_grids_have_their_shape() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><asset><hfield name="h" nrow="3" ncol="2" size="1 1 1 1"/>'
        '<texture name="t" type="2d" builtin="flat" rgb1="1 0 0" width="4" height="2"/>'
        '<texture name="u" type="2d" builtin="flat" rgb1="0 1 0" width="4" height="3"/></asset></mujoco>'
    )
    physics = model.compile_model()
    field = physics.bind(model.find("hfield", "h"))
    assert field.data.shape == (3, 2)
    field.data[2, 1] = 0.5
    assert physics.model.hfield_data[5] == 0.5
    assert physics.bind(model.find("texture", "u")).data.shape == (3, 4, 3)
    assert physics.bind(model.find("texture", "u")).data[0, 0].tolist() == [0, 255, 0]
    assert physics.bind(model.find_all("texture")).data.shape == ((2 + 3) * 4 * 3,)


def test_meshes() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><asset><mesh name="a" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>'
        '<mesh name="b" vertex="0 0 0 2 0 0 0 2 0 0 0 2 2 2 2"/></asset></mujoco>'
    )
    physics = model.compile_model()
    mesh = physics.bind(model.find("mesh", "b"))
    theirs = physics.model.mesh("b")
    first = int(theirs.vertadr[0])
    assert np.array_equal(mesh.vert, physics.model.mesh_vert[first : first + 5])
    assert mesh.face.shape == (int(theirs.facenum[0]), 3)
    assert mesh.texcoord.shape == (0, 2)


def test_flexes() -> None:
    model = mjcf.from_xml_string(FLEXES)
    physics = model.compile_model()
    cloth, rope = (physics.bind(model.find("flex", name)) for name in ("cloth", "rope"))
    assert cloth.flexvert_xpos.shape == cloth.xpos.shape == (12, 3)
    assert rope.xpos.shape == (5, 3)
    assert rope.xpos[:, 1] == pytest.approx(1)
    assert rope.edge.shape == (4, 2)
    assert rope.elem.tolist() == physics.model.flex_elem[-8:].tolist()
    assert cloth.elem.shape == (3 * 2 * 3 * 2,)
    assert rope.flexedge_length == pytest.approx([0.1] * 4)


def test_tuples_and_numbers() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><worldbody><body name="b"/></worldbody><custom><numeric name="n" data="1 2 3"/>'
        '<numeric name="m" size="2" data="7"/>'
        '<tuple name="t"><element objtype="body" objname="b" prm="5"/></tuple></custom></mujoco>'
    )
    physics = model.compile_model()
    assert physics.bind(model.find("numeric", "m")).data.tolist() == [7, 0]
    assert physics.bind(model.find("tuple", "t")).objprm.tolist() == [5]


def test_every_run_is_of_arrays_that_mujoco_has() -> None:
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    for kind, runs in RUNS.items():
        assert kind in KINDS
        for size, run in runs.items():
            if not hasattr(model, size):
                assert size == "nplastic", "new in 4.0"
                continue
            assert hasattr(model, run.first), run
            assert any(field.size == size for field in fields(kind).values()), size


def test_what_stands_packed_without_a_count() -> None:
    """MuJoCo's own views of the state of what has yielded agree; they are new in 4.0."""
    if "plastic" not in fields("joint"):
        pytest.skip("this MuJoCo has no plastic joints")
    model = mjcf.from_xml_string(
        '<mujoco><asset><mesh name="a" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>'
        '<mesh name="b" vertex="0 0 0 2 0 0 0 2 0 0 0 2 2 2 2"/></asset><worldbody>'
        '<body><joint name="j" springyield="0.1"/><joint name="k"/><geom size="1"/><geom type="mesh" mesh="a"/>'
        '<body><joint name="l" type="ball" springyield="0.2"/><geom type="mesh" mesh="b"/></body></body>'
        '</worldbody><tendon><fixed name="t" springyield="0.1"><joint joint="j" coef="1"/></fixed></tendon></mujoco>'
    )
    physics = model.compile_model()
    for name, size in (("j", 1), ("k", 0), ("l", 4)):
        bound = physics.bind(model.find("joint", name))
        assert bound.plastic.shape == (size,)
        assert not size or bound.plastic.tolist() == physics.data.joint(name).plastic.tolist()
    tendon = physics.bind(model.find("tendon", "t"))
    assert tendon.plastic.shape == physics.data.tendon("t").plastic.shape
    first, second = (physics.bind(model.find("mesh", name)) for name in "ab")
    assert [*first.graph, *second.graph] == physics.model.mesh_graph.tolist()
    assert first.graph[0] == 4 and second.graph[0] == 5  # it begins with the number of vertices

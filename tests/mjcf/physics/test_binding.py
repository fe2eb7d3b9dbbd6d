from __future__ import annotations

import numpy as np
import pytest
from mjcompose.mjcf import MjcfAttributeError, MjcfError, Physics, RootElement


def test_what_is_read_is_mujocos_memory_and_follows_it(model: RootElement, physics: Physics) -> None:
    hinge = physics.bind(model.find("joint", "h"))
    qpos = hinge.qpos
    physics.data.qpos[7] = 0.75
    assert qpos[0] == hinge.qpos[0] == 0.75
    assert np.shares_memory(hinge.range, physics.model.jnt_range)


def test_what_is_assigned_is_written_there(model: RootElement, physics: Physics) -> None:
    hinge = physics.bind(model.find("joint", "h"))
    hinge.qpos = 0.5
    hinge.qpos += 1
    hinge.qpos[0] *= 2
    assert physics.data.qpos[7] == 3.0
    hinge.damping = 4
    assert physics.model.dof_damping[6] == 4
    geom = physics.bind(model.find("geom", "g2"))
    geom.size[0] = 0.3
    geom.rgba = [1, 0, 0, 0.5]
    assert physics.model.geom_size[1, 0] == 0.3
    assert physics.model.geom_rgba[1].tolist() == [1, 0, 0, 0.5]
    equality = physics.bind(model.find("equality", "w"))
    equality.active = True
    assert physics.data.eq_active[1] == 1


def test_shapes_of_one(model: RootElement, physics: Physics) -> None:
    def shape(tag: str, name: str, field: str) -> tuple[int, ...]:
        return getattr(physics.bind(model.find(tag, name)), field).shape  # type: ignore[no-any-return]

    assert shape("joint", "f", "qpos") == (7,)
    assert shape("joint", "f", "qvel") == (6,)
    assert shape("joint", "ball", "qpos") == (4,)
    assert shape("joint", "h", "qpos") == (1,)
    assert shape("joint", "h", "range") == (2,)
    assert shape("joint", "h", "stiffness") == ()
    assert shape("joint", "f", "cdof") == (6, 6)
    assert shape("body", "a", "mass") == ()
    assert shape("body", "a", "xmat") == (9,)
    assert shape("sensor", "fp", "sensordata") == (3,)
    assert shape("sensor", "jp", "sensordata") == (1,)
    assert shape("actuator", "mot", "ctrl") == ()
    assert shape("actuator", "mot", "gear") == (6,)
    assert shape("actuator", "mot", "act") == (0,)
    assert shape("actuator", "state", "act") == ()
    assert shape("body", "mo", "mocap_pos") == (3,)
    assert shape("key", "k", "qpos") == (13,)


def test_a_number_works_as_one(model: RootElement, physics: Physics) -> None:
    motor = physics.bind(model.find("actuator", "mot"))
    motor.ctrl = 0.25
    assert float(motor.ctrl) == motor.ctrl == 0.25
    assert f"{motor.ctrl:.1f}" == "0.2"
    motor.ctrl += 1
    before = motor.ctrl  # as in dm_control: a number that was read stays as it was
    motor.ctrl *= 2
    assert before == 1.25 and physics.data.ctrl[0] == 2.5
    assert physics.data.qpos[physics.bind(model.find("joint", "h")).qposadr] == physics.data.qpos[7]


def test_a_sequence_is_in_its_order(model: RootElement, physics: Physics) -> None:
    joints = [model.find("joint", name) for name in ("h2", "f", "h")]
    bound = physics.bind(joints)
    q = physics.data.qpos
    assert bound.qpos.tolist() == [q[8], *q[:7], q[7]]
    assert bound.stiffness.shape == (3,)
    assert bound.range.tolist() == physics.model.jnt_range[[2, 0, 1]].tolist()
    assert bound.element_id.tolist() == bound.id.tolist() == [2, 0, 1]
    assert physics.bind(model.find_all("sensor")).sensordata.tolist() == physics.data.sensordata.tolist()
    assert physics.bind(model.find_all("actuator")).act.tolist() == physics.data.act.tolist()


@pytest.mark.parametrize("names", [("h", "h2"), ("h2", "h"), ("ball", "f"), ("h2", "f", "h")])
def test_a_sequence_is_written_in_place(names: tuple[str, ...], model: RootElement, physics: Physics) -> None:
    bound = physics.bind([model.find("joint", name) for name in names])
    width = len(bound.qpos)
    bound.qpos = np.arange(width, dtype=float)
    assert bound.qpos.tolist() == list(range(width))
    bound.qpos = 0.5
    assert bound.qpos.tolist() == [0.5] * width
    bound.qpos[1] = 7
    assert bound.qpos[1] == 7
    bound.qpos[:] = 1
    bound.qpos += 1
    assert bound.qpos.tolist() == [2] * width
    bound.axis[0, 1] = 9
    assert physics.model.jnt_axis[bound.element_id[0], 1] == 9
    bound.axis = [0, 0, 1]
    assert physics.model.jnt_axis[bound.element_id].tolist() == [[0, 0, 1]] * len(names)


def test_regular_rows_are_views_and_others_copies(model: RootElement, physics: Physics) -> None:
    def shares(*names: str) -> bool:
        bound = physics.bind([model.find("geom", name) for name in names])
        bound.size, bound.size  # noqa: B018
        return np.shares_memory(bound.size, physics.model.geom_size)

    assert shares("g", "g2", "g3") and shares("g3", "g2", "g") and shares("g", "g3")
    assert not shares("g", "g3", "g2")


def test_mocap_bodies(model: RootElement, physics: Physics) -> None:
    assert physics.bind(model.find("body", "mo2")).mocap_pos.tolist() == [4, 5, 6]
    both = physics.bind([model.find("body", "mo2"), model.find("body", "mo")])
    both.mocap_pos = [[1, 1, 1], [2, 2, 2]]
    assert physics.data.mocap_pos.tolist() == [[2, 2, 2], [1, 1, 1]]
    with pytest.raises(MjcfAttributeError, match=r"`<body>` `a` is not a mocap body and has no `mocap_pos`"):
        physics.bind(model.find("body", "a")).mocap_pos  # noqa: B018
    with pytest.raises(MjcfAttributeError, match="`a` is not a mocap body"):
        physics.bind(model.find_all("body")).mocap_pos = 0


def test_a_field_that_does_not_exist_is_told_with_those_that_do(model: RootElement, physics: Physics) -> None:
    hinge = physics.bind(model.find("joint", "h"))
    with pytest.raises(MjcfError, match="a compiled joint has no field `qposs`") as caught:
        hinge.qposs  # noqa: B018
    note = caught.value.diagnostics[0].notes[0].message
    assert {"qpos", "qvel", "range", "xanchor", "armature"} <= set(note.removeprefix("fields that exist: ").split(", "))
    assert caught.value.diagnostics[0].help == "did you mean `qpos`?"
    with pytest.raises(MjcfError, match="no field `sensordata`"):
        hinge.sensordata = 1
    with pytest.raises(MjcfError, match="`id` is the number that MuJoCo has given and cannot be set"):
        hinge.id = 1
    assert not hasattr(hinge, "xpos")
    assert {"qpos", "jnt_range", "range"} <= set(dir(hinge))


def test_nothing_is_bound_to_nothing(physics: Physics) -> None:
    nothing = physics.bind([])
    assert nothing.qpos.shape == (0,)
    nothing.ctrl = []
    assert nothing["xpos", "z"].shape == (0,)
    for value, shape in (([1, 2], r"\(2,\)"), (5, r"\(\)")):
        with pytest.raises(MjcfError, match=rf"`ctrl` of nothing has the shape \(0,\), got {shape}"):
            nothing.ctrl = value
        with pytest.raises(MjcfError, match="`ctrl` of nothing"):
            nothing["ctrl", 0] = value


def test_a_wrong_shape_is_told_and_nothing_is_written(model: RootElement, physics: Physics) -> None:
    bound = physics.bind([model.find("joint", name) for name in ("h2", "f", "h")])
    one = physics.bind(model.find("joint", "h"))
    before = physics.data.qpos.copy()
    for value, said in (
        ([1, 2], r"has the shape \(9,\), got \(2,\)"),
        ("up", "`qpos` of `<joint>` `h2`, `<freejoint>` `f`, `<joint>` `h` expects numbers, got `'up'`"),
        (1j, "expects numbers, got `1j`"),
    ):
        with pytest.raises(MjcfError, match=said):
            bound.qpos = value
    for value, said in (
        ([1, 2], r"`qpos` of `<joint>` `h` has the shape \(1,\), got \(2,\)"),
        (None, "expects numbers, got `None`"),
        ({}, "expects numbers, got `{}`"),
    ):
        with pytest.raises(MjcfError, match=said) as caught:
            one.qpos = value
        span = caught.value.diagnostics[0].span
        assert span is not None and span.file == __file__
    assert physics.data.qpos.tolist() == before.tolist()


def test_it_says_what_it_is_of(model: RootElement, physics: Physics) -> None:
    assert repr(physics.bind(model.find("joint", "h"))) == "<Binding of `<joint>` `h`>"
    assert repr(physics.bind(model.find_all("geom"))).endswith("`g3`, …>")

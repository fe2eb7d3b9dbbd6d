"""MuJoCo's forward kinematics judges: what was written to a pose is where the thing is."""

from __future__ import annotations

import pickle

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, Physics, RootElement

UP = np.array([0, 0, 0.5])
TURNED = [0.5, 0.5, 0.5, 0.5]


@pytest.fixture
def pair() -> RootElement:
    """Two bodies whose geoms and sites stand where the body does; the geom of a third where its inertia does."""
    root = RootElement()
    for name in ("a", "b"):
        body = root.worldbody.add("body", name=name, pos=[0, 0, 1])
        body.add("geom", name=name, type="ellipsoid", size=[0.1, 0.2, 0.3])
        body.add("site", name=name)
    off = root.worldbody.add("body", name="off", simple="false")
    off.add("freejoint")
    off.add("geom", name="off", type="ellipsoid", size=[0.1, 0.2, 0.3], pos=[1, 0, 0], quat=TURNED)
    off.add("site", name="off", pos=[1, 0, 0])
    return root


@pytest.fixture
def physics(pair: RootElement) -> Physics:
    return pair.compile_model()


def test_mujoco_does_compile_poses_away(physics: Physics) -> None:
    """Otherwise these tests test nothing."""
    assert physics.model.geom_sameframe.tolist() == [1, 1, 2]
    assert physics.model.site_sameframe.tolist()[:2] == [1, 1]
    physics.model.geom_pos[0] = [5, 5, 5]
    physics.forward()
    assert physics.data.geom_xpos[0].tolist() == [0, 0, 1]


@pytest.mark.parametrize("kind", ["geom", "site"])
@pytest.mark.parametrize("names", [("a",), ("a", "off"), ("off", "a", "b")])
def test_a_pose_that_is_written_is_read(kind: str, names: tuple[str, ...], pair: RootElement, physics: Physics) -> None:
    found = [pair.find(kind, name) for name in names]
    bound = physics.bind(found[0] if len(found) == 1 else found)
    bound.pos = [0, 0, 0.5]
    bound.quat = TURNED
    physics.forward()
    body = physics.bind([each.parent for each in found]).xpos  # type: ignore[union-attr]
    assert np.allclose(bound.xpos, body + UP)
    assert np.allclose(bound.xmat, np.reshape([[0, 0, 1, 1, 0, 0, 0, 1, 0]] * len(names), bound.xmat.shape))
    assert (bound.sameframe == 0).all()


@pytest.mark.parametrize(
    "write",
    [
        lambda geom: geom.pos.__setitem__(2, 0.5),
        lambda geom: geom.pos.__iadd__([0, 0, 0.5]),
        lambda geom: setattr(geom, "pos", geom.pos + UP),
        lambda geom: geom.pos[1:].__setitem__(1, 0.5),
        lambda geom: geom.pos.reshape(1, 3)[:, 2:].__setitem__(..., 0.5),
        lambda geom: geom.__setitem__(("pos", "z"), 0.5),
    ],
)
def test_every_way_of_writing_counts(write: object, pair: RootElement, physics: Physics) -> None:
    first, second = (physics.bind(pair.find("geom", name)) for name in ("a", "b"))
    write(first)  # type: ignore[operator]
    physics.forward()
    assert first.xpos.tolist() == [0, 0, 1.5]
    assert (first.sameframe, second.sameframe) == (0, 1)


@pytest.mark.parametrize("names", [("a", "b", "off"), ("b", "off", "a"), ("off", "b", "a"), ("b", "a")])
def test_of_several_only_those_that_are_written_are_released(
    names: tuple[str, ...], pair: RootElement, physics: Physics
) -> None:
    bound = physics.bind([pair.find("site", name) for name in names])
    bound.pos[names.index("b"), 0] = 0.25
    assert physics.model.site_sameframe[:2].tolist() == [1, 0]
    assert physics.model.site_pos[1].tolist() == [0.25, 0, 0]


def test_reading_and_computing_release_nothing(pair: RootElement, physics: Physics) -> None:
    bound = physics.bind(pair.find_all("geom"))
    moved = bound.pos + 1
    moved[0] = 5
    moved += 1
    bound.pos.copy()[0] = 7
    bound.pos.copy()[1:][0] = 7
    pickle.loads(pickle.dumps(bound.pos))[0] = 7
    assert type(moved) is np.ndarray and repr(bound.pos[0]) == "array([0., 0., 0.])"
    assert physics.model.geom_sameframe.tolist() == [1, 1, 2]
    assert physics.model.geom_pos[0].tolist() == [0, 0, 0]
    assert np.shares_memory(bound.pos, physics.model.geom_pos)


def test_a_value_that_does_not_fit_releases_nothing(pair: RootElement, physics: Physics) -> None:
    one = physics.bind(pair.find("geom", "a"))
    scattered = physics.bind([pair.find("geom", name) for name in ("off", "a", "b")])
    for bound in (one, scattered):
        with pytest.raises(MjcfError, match="has the shape"):
            bound.pos = [1, 2]
        with pytest.raises(ValueError):
            bound.pos[...] = [1, 2]
    assert physics.model.geom_sameframe.tolist() == [1, 1, 2]


@pytest.mark.parametrize("field", ["ipos", "iquat"])
@pytest.mark.parametrize("one", [True, False])
def test_an_inertia_leaves_alone(field: str, one: bool, pair: RootElement, physics: Physics) -> None:
    """What stood where it was stays there: MuJoCo would take it along."""
    names = ["off"] if one else ["off", "b", "a"]
    bodies = [pair.find("body", name) for name in names]
    bound = physics.bind(bodies[0] if one else bodies)
    physics.forward()
    before = physics.data.geom_xpos.copy(), physics.data.geom_xmat.copy()
    setattr(bound, field, [0.1, 0.2, 0.3] if field == "ipos" else [1, 0, 0, 0])
    physics.forward()
    assert np.allclose(physics.data.geom_xpos, before[0], atol=1e-12)
    assert np.allclose(physics.data.geom_xmat, before[1], atol=1e-12)
    place = physics.bind(bodies).xpos + np.array([0.1, 0.2, 0.3])
    assert np.allclose(*((bound.xipos, place) if field == "ipos" else (bound.ximat, np.eye(3).ravel())))


def free_body(ipos: str, simple: str) -> str:
    return (
        f'<mujoco><worldbody><body name="box" simple="{simple}"><freejoint/>'
        f'<inertial mass="1" pos="{ipos}" diaginertia="1 2 2.5"/><geom size="0.1" mass="0"/></body></worldbody></mujoco>'
    )


def test_the_dynamics_are_those_of_the_inertia_that_was_written() -> None:
    def accelerations(physics: Physics) -> np.ndarray:
        physics.data.qvel[:] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
        physics.forward()
        return physics.data.qacc.copy()

    root = mjcf.from_xml_string(free_body("0 0 0", "false"))
    physics = root.compile_model()
    physics.bind(root.find("body", "box")).ipos = [0.1, 0.2, 0.3]
    expected = accelerations(Physics.from_xml_string(free_body("0.1 0.2 0.3", "false")))
    assert np.allclose(accelerations(physics), expected, atol=1e-12)


def test_the_inertia_of_a_simple_body_cannot_be_moved() -> None:
    """MuJoCo has no room in the mass matrix for what is off its diagonal then."""
    root = mjcf.from_xml_string(free_body("0 0 0", "auto"))
    physics = root.compile_model()
    assert physics.model.body_simple[1] == 1
    body = physics.bind(root.find("body", "box"))
    for write in (
        lambda: setattr(body, "ipos", [0.1, 0.2, 0.3]),
        lambda: body.ipos.__setitem__(0, 1),
        lambda: body.ipos.__iadd__(1),
        lambda: body.__setitem__(("iquat", "qx"), 1),
    ):
        with pytest.raises(MjcfError, match="`(ipos|iquat)` of the body `box` cannot be changed") as caught:
            write()
        assert caught.value.diagnostics[0].help == "compile it with `simple='false'` on the body"
    assert physics.model.body_ipos[1].tolist() == [0, 0, 0]
    assert physics.model.body_sameframe[1] == mujoco.mjtSameFrame.mjSAMEFRAME_BODY

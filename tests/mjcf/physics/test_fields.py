from __future__ import annotations

import contextlib
import os
import random
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import Binding, Element, MjcfError, Physics, RootElement
from mjcompose.mjcf.binding import fields
from mjcompose.mujoco.attributes import KINDS

# of 3.12 have rows of others for the rest.
_OTHERWISE = {
    ("joint", "bodyid"),
    ("actuator", "moment"),
    ("joint", "cdof"),
    ("joint", "cdof_dot"),
    ("joint", "dampingpoly"),
    ("tendon", "J_colind"),
}
_VIEWED = (
    "body joint geom site camera light mesh hfield texture material pair exclude equality tendon actuator sensor "
    "numeric tuple key"
).split()
_OF_A_KIND = 6
FOLDER = os.environ.get("MJCOMPOSE_CORPUS")


def numbers_for(array: np.ndarray) -> np.ndarray:
    """Of its shape; not computed from what is there, which MuJoCo may not have set."""
    return np.arange(1, array.size + 1, dtype=array.dtype).reshape(array.shape)


def is_refused(physics: Physics, kind: str, bound: Binding, name: str) -> bool:
    """Whether the field is the pose of the inertia of a body that MuJoCo compiled as a simple one."""
    if kind != "body" or name.removeprefix("body_") not in ("ipos", "iquat"):
        return False
    ids = np.atleast_1d(bound.element_id)
    return bool(((physics.model.body_simple[ids] != 0) & (physics.model.body_dofnum[ids] > 0)).any())


def compare_one(physics: Physics, kind: str, element: Element) -> int:
    """Every field that MuJoCo's own views have is there, with the same numbers, and is written to the same place."""
    bound = physics.bind(element)
    compared = 0
    for owner in (physics.model, physics.data):
        if not hasattr(owner, kind):
            continue
        theirs = getattr(owner, kind)(int(bound.element_id))
        assert theirs.name == (element.full_identifier or "")
        for name in dir(theirs):
            if name.startswith("_") or name in ("id", "name") or (kind, name) in _OTHERWISE:
                continue
            ours = getattr(bound, name)
            expected = getattr(theirs, name)
            assert ours.shape == expected.shape or (ours.shape, expected.shape) == ((), (1,)), (element, name)
            np.testing.assert_array_equal(ours, np.reshape(expected, ours.shape), f"{element} {name}")
            if is_refused(physics, kind, bound, name):
                with pytest.raises(MjcfError, match="cannot be changed after compiling"):
                    setattr(bound, name, numbers_for(ours))
                np.testing.assert_array_equal(ours, np.reshape(getattr(theirs, name), ours.shape))
            elif ours.dtype.kind == "f":
                before = ours.copy()
                new = numbers_for(ours)
                setattr(bound, name, new)
                np.testing.assert_array_equal(np.ravel(getattr(theirs, name)), np.ravel(new))
                setattr(bound, name, before)
            compared += 1
    return compared


def compare_several(physics: Physics, kind: str, elements: list[Element]) -> int:
    """Every field of a sequence has the numbers of its elements in their order, and is written to them."""
    together = physics.bind(elements)
    alone = list(map(physics.bind, elements))
    compared = 0
    for name in fields(kind):
        try:
            each = [getattr(bound, name) for bound in alone]
        except MjcfError:
            with pytest.raises(MjcfError):
                getattr(together, name)
            continue
        numbers = np.concatenate([np.ravel(one) for one in each])
        found = getattr(together, name)
        assert found.dtype == each[0].dtype, name
        np.testing.assert_array_equal(np.ravel(found), numbers, name)
        if is_refused(physics, kind, together, name):
            with pytest.raises(MjcfError, match="cannot be changed after compiling"):
                setattr(together, name, numbers_for(found))
            np.testing.assert_array_equal(np.ravel(found), numbers, name)
        elif found.dtype.kind == "f":
            before = found.copy()
            new = numbers_for(found)
            setattr(together, name, new)
            after = np.concatenate([np.ravel(getattr(bound, name)) for bound in alone])
            np.testing.assert_array_equal(after, np.ravel(new), name)
            setattr(together, name, before)
        compared += 1
    return compared


def compare(physics: Physics, root: RootElement, kind: str) -> int:
    elements = []
    for element in root.find_all(kind):
        with contextlib.suppress(MjcfError):  # what MuJoCo makes several of
            physics.bind(element)
            elements.append(element)
    some = random.Random(len(elements)).sample(elements, min(len(elements), _OF_A_KIND))
    compared = sum(compare_one(physics, kind, element) for element in some)
    in_order = [element for element in elements if element in some]
    return compared + sum(compare_several(physics, kind, each) for each in (some, in_order, some[:1]) if each)


@pytest.mark.parametrize("kind", _VIEWED)
def test_whatever_mujocos_own_views_have_is_there_and_equal(kind: str, model: RootElement, physics: Physics) -> None:
    assert compare(physics, model, kind) > len(model.find_all(kind)) > 0


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")
def test_the_same_of_real_models() -> None:
    corpus = Path(FOLDER or "")
    one_of_each = [min(folder.glob("*.xml"), default=None) for folder in (corpus / "models").iterdir()]
    compared = 0
    for path in [path for path in one_of_each if path] + sorted((corpus / "feature-cases").glob("*/*.xml")):
        try:
            root = mjcf.from_path(path)
            physics = root.compile_model()
        except MjcfError:
            continue
        physics.step(2)
        with np.errstate(all="ignore"):  # not all that is there is a number
            compared += sum(compare(physics, root, kind) for kind in _VIEWED)
    assert compared > 10_000


def test_a_field_has_mujocos_full_name_too(model: RootElement, physics: Physics) -> None:
    geom = physics.bind(model.find("geom", "g"))
    tendon = physics.bind(model.find("tendon", "te"))
    assert np.shares_memory(geom.geom_xpos, physics.data.geom_xpos)
    assert np.shares_memory(geom.xpos, geom.geom_xpos)
    assert tendon.length == tendon.ten_length == physics.data.ten_length[0]
    assert physics.bind(model.find("equality", "w")).eq_active == 0


def test_every_array_with_a_row_for_each_element_is_a_field(physics: Physics) -> None:
    """But for lists of indices: the sizes of this model are all different enough to tell."""
    own = {"body": "nbody", "geom": "ngeom", "tendon": "ntendon", "equality": "neq", "sensor": "nsensor"}
    for kind, size in own.items():
        begin = f"{KINDS[kind].arrays}_"
        count = getattr(physics.model, size)
        arrays = [name for name in dir(physics.model) if name.startswith(begin)]
        found = {name for name in arrays if getattr(physics.model, name).shape[:1] == (count,)}
        assert found and found <= fields(kind).keys()


def test_the_joints_own_array_keeps_the_short_name() -> None:
    assert fields("joint")["solref"].array == "jnt_solref"
    assert fields("joint")["armature"].array == "dof_armature"
    assert fields("joint")["dof_solref"].array == "dof_solref"


def test_lists_of_indices_and_what_is_made_anew_in_every_step_are_no_fields() -> None:
    names = {name for kind in KINDS for name in fields(kind)}
    assert not names & {"body_awake_ind", "dof_awake_ind", "wrap_xpos", "efc_force", "contact", "dof_island"}
    assert hasattr(mujoco.MjData, "efc_force")


def test_rows_of_degrees_of_freedom_and_of_a_jacobian(model: RootElement, physics: Physics) -> None:
    assert physics.bind(model.find("joint", "h")).cdof.tolist() == physics.data.cdof[6:7].tolist()
    assert physics.bind(model.find("joint", "ball")).cdof_dot.tolist() == physics.data.cdof_dot[8:11].tolist()
    assert physics.bind(model.find("tendon", "te")).ten_J_colind.tolist() == [6, 7]
    assert physics.bind(model.find("tendon", "te")).J.tolist() == [1, 2]

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from composer.mjcf import Physics, RootElement
from composer.mjcf.physics.fields import fields
from composer.verify.roster import KINDS

# MuJoCo's own views give the body of each degree of freedom, and a moment that is no memory of its own; those
# of 3.12 have rows of others for the last three.
_OTHERWISE = {
    ("joint", "bodyid"),
    ("actuator", "moment"),
    ("joint", "cdof"),
    ("joint", "cdof_dot"),
    ("tendon", "J_colind"),
}
_VIEWED = (
    "body joint geom site camera light mesh hfield texture material pair exclude equality tendon actuator sensor "
    "numeric tuple key"
).split()


@pytest.mark.parametrize("kind", _VIEWED)
def test_whatever_mujocos_own_views_have_is_there_and_equal(
    kind: str, model: RootElement, physics: Physics
) -> None:
    elements = model.find_all(kind)
    assert elements
    compared = 0
    for element in elements:
        bound = physics.bind(element)
        for owner in (physics.model, physics.data):
            by_number = getattr(owner, kind, None)
            if by_number is None:
                continue
            theirs = by_number(int(bound.element_id))
            assert theirs.name == (element.name or "")
            for name in dir(theirs):
                if name.startswith("_") or name in ("id", "name") or (kind, name) in _OTHERWISE:
                    continue
                np.testing.assert_array_equal(
                    np.ravel(getattr(bound, name)), np.ravel(getattr(theirs, name)), f"{element} {name}"
                )
                compared += 1
    assert compared >= len(elements)


def test_a_field_has_mujocos_full_name_too(model: RootElement, physics: Physics) -> None:
    geom, tendon = physics.bind(model.find("geom", "g")), physics.bind(model.find("tendon", "te"))
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

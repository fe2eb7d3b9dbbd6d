from __future__ import annotations

import numpy as np
import pytest
from mjcompose.mjcf import MjcfError, Physics, RootElement
from mjcompose.mjcf.binding import column_names


@pytest.mark.parametrize(
    ("array", "width", "expected"),
    [
        ("geom_pos", 3, "x y z"),
        ("xipos", 3, "x y z"),
        ("jnt_axis", 3, "x y z"),
        ("body_inertia", 3, "x y z"),
        ("body_iquat", 4, "qw qx qy qz"),
        ("mat_rgba", 4, "r g b a"),
        ("geom_xmat", 9, "xx xy xz yx yy yz zx zy zz"),
        ("geom_friction", 3, ""),
        ("qpos", 7, ""),
        ("geom_solimp", 5, ""),
    ],
)
def test_columns_have_the_names_that_are_usual(array: str, width: int, expected: str) -> None:
    assert column_names(array, width) == tuple(expected.split())


@pytest.mark.parametrize("tags", [("g",), ("g", "g2", "g3"), ("g3", "g", "g2")])
def test_a_binding_is_indexed_by_field_and_column(tags: tuple[str, ...], model: RootElement, physics: Physics) -> None:
    found = [model.find("geom", name) for name in tags]
    bound = physics.bind(found[0] if len(found) == 1 else found)
    rows = bound.element_id
    sizes = physics.model.geom_size
    assert bound["size"].tolist() == bound["geom_size"].tolist() == sizes[rows].tolist()
    assert bound["size", "x"].tolist() == bound["size", 0].tolist() == sizes[rows, 0].tolist()
    assert bound["size", ["z", "x"]].tolist() == sizes[rows][..., [2, 0]].tolist()
    assert bound["size", slice(0, None, 2)].tolist() == sizes[rows][..., ::2].tolist()
    bound["size", "y"] = 5
    assert np.all(sizes[rows, 1] == 5)
    bound["size", ["x", "z"]] = [6, 7]
    assert np.all(sizes[rows] == [6, 5, 7])
    bound["size"] = 1
    assert np.all(sizes[rows] == 1)
    bound["rgba", "a"] *= 0.5
    assert np.all(physics.model.geom_rgba[rows, 3] == 0.5)


def test_what_a_binding_cannot_be_indexed_by_is_reported(model: RootElement, physics: Physics) -> None:
    geom = physics.bind(model.find("geom", "g"))
    joints = physics.bind(model.find_all("joint"))
    for bound, key, said in (
        (geom, "poss", "a compiled geom has no field `poss`"),
        (geom, ("pos", "w"), "`pos` has no column `w`"),
        (geom, ("pos", 3), "`pos` has no column `3`"),
        (geom, ("friction", "x"), "`friction` has no column `x`"),
        (geom, 0, "indexed by the name of a field, got `0`"),
        (geom, ("pos", 0, 0), "indexed by the name of a field"),
        (geom, ("type", 0), "has one number per element, and no columns"),
        (joints, ("qpos", 0), "has one number per element, and no columns"),
    ):
        with pytest.raises(MjcfError, match=said):
            bound[key]
        with pytest.raises(MjcfError, match=said):
            bound[key] = 0
    with pytest.raises(MjcfError, match=r"`pos` of `<geom>` `g` has the shape \(2,\), got \(3,\)"):
        geom["pos", [0, 1]] = [1, 2, 3]


def test_a_free_joint_by_column(model: RootElement, physics: Physics) -> None:
    free = physics.bind(model.find("joint", "f"))
    free["qpos", 2] = 4
    assert physics.data.qpos[2] == 4

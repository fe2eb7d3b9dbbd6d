from __future__ import annotations

import re
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco import arrays
from mjcompose.mujoco.addresses import data_of
from mjcompose.mujoco.arrays import ARRAYS, ENUMS, about, unit, words
from mjcompose.mujoco.attributes import KINDS
from mjcompose.tree.grammar import GRAMMAR


def test_every_array_has_the_words_of_an_enumeration() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    for array in ENUMS:
        assert hasattr(compiled, array) and words(mujoco, array)
    assert words(mujoco, "jnt_type") == {0: "free", 1: "ball", 2: "slide", 3: "hinge"}


def test_sensors_have_their_tags() -> None:
    tags = set(GRAMMAR.section("sensor").children)
    unknown = set(words(mujoco, "sensor_type").values()) - tags
    assert unknown <= {"plugin"}


# what is told of settings, keys and servos, and no array
_OWN = {"kp", "kv", "gain", "timestep", "gravity", "wind", "density", "viscosity"} | {
    "integrator",
    "cone",
    "jacobian",
    "solver",
}
_STATISTICS = {"meaninertia", "meanmass", "meansize", "extent", "center"}


@pytest.fixture(scope="module")
def model() -> Any:
    return mujoco.MjModel.from_xml_string("<mujoco/>")


def test_every_array_has_a_row(model: Any) -> None:
    """An array that a new MuJoCo brings is given a row, which says how it is compared."""
    names = (name for name in dir(model) if not name.startswith("_") and name not in ADDRESSES)
    assert [name for name in names if isinstance(getattr(model, name), np.ndarray) and name not in ARRAYS] == []


ADDRESSES = {kind.addresses for kind in KINDS.values()}
OLD = set(
    """
    cam_orthographic flex_bandwidth flex_evpair flex_evpairadr flex_evpairnum flex_internal flex_vertedge
    flex_vertedgeadr flex_vertedgenum flex_vertmetric flex_xvert0 flexvert_J_colind flexvert_J_rowadr
    flexvert_J_rownnz light_directional tex_rgb tree_sleep
    """.split()
)
"""Arrays of earlier versions, and forms into which `migrate` brings those of all versions."""


def test_every_row_is_for_an_array_that_there_is(model: Any) -> None:
    ours = _OWN | _STATISTICS | {name for name in ARRAYS if "." in name}
    if tuple(map(int, mujoco.__version__.split(".")[:2])) >= (4, 0):  # in MuJoCo 3.12 some are not there yet
        assert {name for name in ARRAYS.keys() - ours if not hasattr(model, name)} == OLD
    assert not _STATISTICS - set(dir(model.stat))


def test_every_trait_says_something() -> None:
    known = {*arrays._BEHAVIOURS, *arrays._BETWEEN_VERSIONS, arrays.SWITCH, arrays.COMPUTED, arrays.HULL}
    known |= {arrays.MEASURED, arrays.PLACED, arrays.REWRITTEN, arrays.UNSAID}
    for name in ARRAYS:
        other = about(name).traits - known
        assert all(re.fullmatch(r"rows .+|mjt\w+|[-.e\d ]+", each) for each in other), (name, other)
        assert len(about(name).traits & arrays._BEHAVIOURS.keys()) <= 1, name


def test_the_rows_of_data_are_those_that_mujoco_says() -> None:
    structs = pytest.importorskip("mujoco.introspect.structs")
    fields = structs.STRUCTS["mjModel"].fields
    sizes = {each.name: str(each.array_extent[0]) for each in fields if getattr(each, "array_extent", None)}
    ours = {name: rows for name in ARRAYS if (rows := about(name).rows).startswith("n") and " " not in rows}
    assert len(ours) > 30
    assert {name: rows for name, rows in ours.items() if name in sizes and rows != sizes[name]} == {}


def test_every_array_of_data_is_of_a_kind() -> None:
    read = {name for kind in KINDS for name, *_ in data_of(kind)}
    assert read == {name for name in ARRAYS if about(name).rows}


def test_units_by_the_type_of_the_joint() -> None:
    assert unit("jnt_stiffness", "hinge") == "N·m/rad" and unit("jnt_stiffness", "slide") == "N/m"
    assert unit("key_qpos", "free") == "" and unit("jnt_range", "ball") == "rad"
    assert unit("body_mass", "") == "kg"


def test_an_array_without_words_has_its_own() -> None:
    known = about("geom_solmix")
    assert (known.words, known.attributes) == ("solmix", ("solmix",))
    assert about("geom_solimp[2]").attributes == ("solimp",)


def test_what_is_computed() -> None:
    assert about("mesh_extrema[3]").is_computed and not about("body_mass").is_computed
    assert about("geom_rbound").is_computed and about("body_invweight0").is_computed

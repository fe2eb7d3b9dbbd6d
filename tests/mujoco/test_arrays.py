from __future__ import annotations

from typing import Any

import mujoco
import pytest
from mjcompose.model.grammar import GRAMMAR
from mjcompose.mujoco import arrays as quantities
from mjcompose.mujoco.arrays import ENUMS, follows, quantity, unit, words


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
_OWN = {"kp", "kv", "gain", "timestep", "gravity", "wind", "density", "viscosity"}
_STATISTICS = {"meaninertia", "meanmass", "meansize", "extent", "center"}


@pytest.fixture(scope="module")
def model() -> Any:
    return mujoco.MjModel.from_xml_string("<mujoco/>")


def test_every_word_is_for_an_array_that_there_is(model: Any) -> None:
    arrays = set(quantities._QUANTITIES) | set(quantities._FOLLOWING)
    unknown = {name for name in arrays - _OWN - _STATISTICS if not hasattr(model, name)}
    # in MuJoCo 3.12 some are not there yet
    if tuple(map(int, mujoco.__version__.split(".")[:2])) >= (4, 0):
        assert unknown <= {"mesh_octnum"}
    assert not _STATISTICS - set(dir(model.stat))


def test_units_by_the_type_of_the_joint() -> None:
    assert unit("jnt_stiffness", "hinge") == "N·m/rad" and unit("jnt_stiffness", "slide") == "N/m"
    assert unit("key_qpos", "free") == "" and unit("jnt_range", "ball") == "rad"
    assert unit("body_mass", "") == "kg"


def test_an_array_without_words_has_its_own() -> None:
    known = quantity("geom_solmix")
    assert (known.words, known.attributes) == ("solmix", ("solmix",))
    assert quantity("geom_solimp[2]").attributes == ("solimp",)


def test_what_follows() -> None:
    assert follows("mesh_extrema[3]")
    assert follows("geom_rbound") and follows("body_invweight0") and not follows("body_mass")

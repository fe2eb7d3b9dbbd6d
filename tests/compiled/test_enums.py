from __future__ import annotations

import mujoco

from composer.compiled.enums import ENUMS, words
from composer.grammar import GRAMMAR


def test_every_array_has_the_words_of_an_enumeration() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    for array in ENUMS:
        assert hasattr(compiled, array) and words(mujoco, array)
    assert words(mujoco, "jnt_type") == {0: "free", 1: "ball", 2: "slide", 3: "hinge"}


def test_sensors_have_their_tags() -> None:
    tags = set(GRAMMAR.section("sensor").children)
    unknown = set(words(mujoco, "sensor_type").values()) - tags
    assert unknown <= {"plugin"}

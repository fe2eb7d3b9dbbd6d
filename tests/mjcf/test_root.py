from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest
from mjcompose import mjcf
from mjcompose.tree.grammar import GRAMMAR


def test_every_section_is_an_attribute() -> None:
    model = mjcf.RootElement()
    for tag in GRAMMAR.root.children:
        section = getattr(model, tag)
        assert section.tag == tag and getattr(model, tag) is section
    assert [each.tag for each in model.all_children()] == list(GRAMMAR.root.children)
    assert model.to_xml_string() == "<mujoco/>\n"


def test_the_name_of_a_model(arm: mjcf.RootElement, folder: object) -> None:
    assert mjcf.RootElement("robot").model == "robot"
    assert mjcf.RootElement().model == "unnamed_model"
    assert arm.model == "arm"
    arm.model = "robot"
    assert arm.to_xml_string().startswith('<mujoco model="robot">')
    with pytest.raises(mjcf.MjcfError, match="`model` of `<mujoco>` expects"):
        arm.model = 3  # type: ignore[assignment]
    arm.model = None
    assert arm.model == "arm", "the stem of its file"


def test_a_model_by_itself_is_at_the_top(arm: mjcf.RootElement) -> None:
    assert arm.parent_model is None and arm.root_model is arm and arm.root is arm and arm.tag == "mujoco"


def test_sections_may_be_added_with_attributes() -> None:
    model = mjcf.RootElement()
    option = model.add("option", timestep=0.001)
    assert option is model.option and option.timestep == 0.001
    with pytest.raises(mjcf.MjcfError, match="can have one only"):
        model.add("option", timestep=0.002)
    with pytest.raises(mjcf.MjcfError, match="did you mean `worldbody`"):
        model.add("wordbody")


def test_a_section_that_is_misspelled_is_told() -> None:
    with pytest.raises(mjcf.MjcfError, match="did you mean `actuator`"):
        _ = mjcf.RootElement().actuators


def test_a_model_is_read_from_several_threads(arm: mjcf.RootElement) -> None:
    def look(_: int) -> list[int]:
        found = [*arm.find_all("geom"), *arm.find_all("body"), arm.visual.headlight, arm.statistic, arm.size]
        return [id(each) for each in found]

    with ThreadPoolExecutor(8) as pool:
        seen = list(pool.map(look, range(64)))
    assert all(each == seen[0] for each in seen)

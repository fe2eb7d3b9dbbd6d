from __future__ import annotations

import pytest
from mjcompose import mjcf
from mjcompose.mjcf.model import ReferencedNode
from mjcompose.mjcf.traversal import is_below


def test_a_family_is_found_by_its_name() -> None:
    model = mjcf.RootElement()
    free = model.worldbody.add("body", name="a").add("freejoint", name="f")
    hinge = model.worldbody.add("body", name="b").add("joint", name="h")
    motor = model.actuator.add("motor", name="m", joint=hinge)
    servo = model.actuator.add("position", name="p", joint=hinge)
    assert model.find_all("joint") == [free, hinge]
    assert model.find_all("freejoint") == [free] and model.find("freejoint", "h") is None
    assert model.find_all("actuator") == [motor, servo] and model.find_all("position") == [servo]
    assert model.find("joint", "f") is free and model.find("actuator", "p") is servo
    assert model.find("motor", "p") is None


def test_find_without_a_name_is_the_first_in_document_order(arm: mjcf.RootElement) -> None:
    assert arm.find("body") is arm.find("body", "base")
    assert arm.find("material") is arm.asset.material[0]
    assert arm.find("camera") is None and arm.find("camera", "x") is None


def test_elements_of_default_classes_are_no_elements_of_the_model(arm: mjcf.RootElement) -> None:
    assert [joint.name for joint in arm.find_all("joint")] == ["shoulder", "elbow_joint"]
    assert len(arm.default.find_all("joint")) == 1
    assert [each.name for each in arm.default.find_all("default")] == ["visual"]


def test_the_same_tag_in_another_section_is_another_thing(gripper: mjcf.RootElement) -> None:
    assert [joint.name for joint in gripper.find_all("joint")] == ["left", "right"]
    assert gripper.equality.find_all("joint") == [gripper.find("equality", "mirror")]
    assert len(gripper.find("tendon", "split").find_all("joint")) == 2  # type: ignore[union-attr]


def test_only_what_is_below_is_found(arm: mjcf.RootElement) -> None:
    fore = arm.find("body", "fore")
    upper = arm.find("body", "upper")
    assert fore is not None and upper is not None
    assert fore.find("joint", "shoulder") is None and upper.find("joint", "elbow_joint") is fore.joint[0]
    assert fore.find("body", "fore") is None
    assert [each.name for each in upper.find_all("geom")] == [None, "upper", "fore"]
    assert [each.name for each in upper.find_all("geom", immediate_children_only=True)] == [None, "upper"]
    assert fore.find_all("actuator") == []


def test_sections_are_found_too(arm: mjcf.RootElement) -> None:
    assert arm.find("worldbody") is arm.worldbody and arm.find_all("compiler") == [arm.compiler]
    assert arm.find_all("asset", immediate_children_only=True) == [arm.asset]


def test_a_tag_that_mjcf_does_not_have_is_told(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError, match="did you mean `joint`"):
        arm.find("jiont")
    with pytest.raises(mjcf.MjcfError, match="expects a name"):
        arm.find("joint", 3)  # type: ignore[arg-type]
    with pytest.raises(mjcf.MjcfError, match="MJCF has no element"):
        arm.find_all(None)  # type: ignore[arg-type]


def test_a_model_may_be_edited_while_going_through_it(arm: mjcf.RootElement) -> None:
    for body in arm.find_all("body"):
        body.add("body", name=f"{body.name}_more")
    assert len(arm.find_all("body")) == 6


@pytest.fixture
def chain() -> list[mjcf.RootElement]:
    """Four models, each with two bodies of which the first carries the next one, in its site."""
    models = [mjcf.RootElement(name) for name in "abcd"]
    for number, model in enumerate(models):
        first = model.worldbody.add("body", name="1")
        first.add("body", name="1.1").add("geom", name="g", size=[1])
        model.worldbody.add("body", name="2")
        model.actuator.add("motor", name="m")
        if number:
            carrier = models[number - 1].find("body", "1")
            assert carrier is not None
            carrier.add("site", name="s").attach(model)
    return models


def test_attached_bodies_stand_after_the_children_of_what_carries_them(chain: list[mjcf.RootElement]) -> None:
    found = [body.full_identifier for body in chain[0].find_all("body")]
    assert found == [
        "1",
        "1.1",
        "b/1",
        "b/1.1",
        "b/c/1",
        "b/c/1.1",
        "b/c/d/1",
        "b/c/d/1.1",
        "b/c/d/2",
        "b/c/2",
        "b/2",
        "2",
    ]
    written = chain[0].to_xml_string()
    places = [written.index(f'name="{name}"') for name in found]
    assert places == sorted(places)


def test_sections_follow_one_another(chain: list[mjcf.RootElement]) -> None:
    assert [each.full_identifier for each in chain[0].find_all("motor")] == ["m", "b/m", "b/c/m", "b/c/d/m"]
    assert [each.full_identifier for each in chain[1].actuator.find_all("motor")] == ["b/m", "b/c/m", "b/c/d/m"]
    assert [each.root.model for each in chain[2].find_all("actuator", True)] == []
    assert len(chain[2].actuator.find_all("actuator", True)) == 2
    assert [each.root.model for each in chain[2].find_all("worldbody")] == ["c"]


def test_a_section_that_only_a_child_has_is_looked_through(chain: list[mjcf.RootElement]) -> None:
    clock = chain[3].sensor.add("clock", name="t")
    assert chain[0].find_all("sensor") == [clock] and chain[0].find("sensor", "b/c/d/t") is clock


def test_what_is_below_what(chain: list[mjcf.RootElement]) -> None:
    def target(element: mjcf.Element | None) -> ReferencedNode:
        assert element is not None
        return ReferencedNode(element._model, element._node)

    a, b, _, d = chain
    deep = target(d.find("geom", "g"))
    for outer in (a.worldbody, a.find("body", "1"), b.find("body", "1"), d.find("body", "1.1"), b):
        assert is_below(target(outer), deep)
    for outer in (a.find("body", "2"), a.find("body", "1.1"), d.find("body", "2"), a.actuator, d.find("geom")):
        assert not is_below(target(outer), deep)
    motor = target(d.find("actuator", "m"))
    assert is_below(target(a.actuator), motor) and not is_below(target(a.find("body", "1")), motor)


def test_a_frame_that_is_a_body_stands_between(chain: list[mjcf.RootElement]) -> None:
    a, b, *_ = chain
    frame = mjcf.get_attachment_frame(b)
    assert frame is not None
    joint = frame.add("joint")
    body = a.find("body", "1")
    assert body is not None
    assert [each.full_identifier for each in body.find_all("body", True)] == ["1.1", "b/"]
    assert [each.full_identifier for each in frame.find_all("body", True)] == ["b/1", "b/2"]
    assert body.find("joint", "b/") is joint is frame.find("joint", "b/")
    assert frame.find("geom", "b/g") is b.find("geom", "g") and frame.find("body", "2") is None

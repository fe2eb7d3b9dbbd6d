from __future__ import annotations

import copy
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from mjcompose import mjcf


@pytest.fixture
def body() -> mjcf.Element:
    return mjcf.RootElement("m").worldbody.add("body", name="b")


def test_tag_name_and_attributes(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "shoulder")
    assert joint is not None
    assert (joint.tag, joint.name, joint.full_identifier) == ("joint", "shoulder", "shoulder")
    np.testing.assert_array_equal(joint.range, [-1.5, 1.5])
    assert joint.damping is None and joint.get("damping", 3) == 3
    assert joint.get_attributes().keys() == {"name", "axis", "range"}


def test_a_failed_add_adds_nothing(body: mjcf.Element) -> None:
    for tag, attributes in (
        ("goem", {}),
        ("geom", {"siz": 1}),
        ("geom", {"size": [1, 2, 3, 4]}),
        ("geom", {"name": "x", "quat": [1, 0, 0, 0], "euler": [0, 0, 0]}),
    ):
        with pytest.raises(mjcf.MjcfError):
            body.add(tag, **attributes)
    assert body.all_children() == [] and body.root.find("geom", "x") is None


@pytest.mark.parametrize(
    ("tag", "attributes", "code", "said"),
    [
        ("goem", {}, "unknown-element", "did you mean `geom`?"),
        ("motor", {}, "unknown-element", "`<body>` cannot have a `motor`"),
        ("geom", {"frictoin": [1]}, "unknown-attribute", "did you mean `friction`?"),
        ("geom", {"size": [1, 2, 3, 4]}, "wrong-length", "1 to 3 numbers, got 4"),
        ("geom", {"type": "spere"}, "wrong-keyword", "did you mean `sphere`?"),
        ("geom", {"mass": "heavy"}, "wrong-type", "got `heavy`"),
        ("geom", {"name": "taken"}, "name-clash", "`<geom>` `taken` is here"),
        ("body", {"name": "world"}, "name-clash", "`world`"),
    ],
)
def test_what_is_wrong_is_told_with_what_is_there(
    body: mjcf.Element, tag: str, attributes: dict[str, object], code: str, said: str
) -> None:
    body.add("geom", name="taken")
    with pytest.raises(mjcf.MjcfError) as caught:
        body.add(tag, **attributes)
    (fault,) = caught.value.diagnostics
    assert fault.code == code and said in str(caught.value)
    assert fault.span is not None and fault.span.file == __file__


def test_a_clash_names_both_places(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        arm.worldbody.add("body", name="fore")
    (fault,) = caught.value.diagnostics
    assert fault.span is not None and fault.span.file == __file__
    place = fault.notes[0].span
    assert place is not None and place.file.endswith("arm.xml") and place.line == 17


def test_names_are_unique_in_a_namespace_only(body: mjcf.Element) -> None:
    body.add("geom", name="b")
    body.add("joint", name="b")
    with pytest.raises(mjcf.MjcfError):
        body.add("freejoint", name="b")


def test_insert_puts_a_child_before_another(body: mjcf.Element) -> None:
    first = body.add("geom", name="1")
    last = body.insert("geom", 99, name="3")
    middle = body.insert("site", position=1)
    zeroth = body.insert("geom", position=-3)
    assert body.all_children() == [zeroth, first, middle, last]
    assert body.insert("geom", -1, name="2") is body.all_children()[3]
    assert first.add("plugin") is not None and body.insert("body", 0).insert("geom", -1).parent is body.body[0]
    with pytest.raises(mjcf.MjcfError):
        body.insert("geom", "first")  # type: ignore[arg-type]


def test_renaming_renames_what_refers_to_it(arm: mjcf.RootElement) -> None:
    fore = arm.find("body", "upper")
    flange = arm.find("site", "flange")
    visual = arm.find("default", "visual")
    assert fore is not None and flange is not None and visual is not None
    fore.name = "arm1"
    flange.name = "tool"
    visual.name = "looks"
    text = arm.to_xml_string()
    assert 'body2="arm1"' in text and 'objname="tool"' in text and '<geom class="looks"' in text
    assert arm.find("body", "upper") is None and arm.find("body", "arm1") is fore


def test_renaming_an_asset_without_a_name_gives_it_one(gripper: mjcf.RootElement) -> None:
    mesh = gripper.find("mesh", "shell")
    assert mesh is not None and mesh.name == "shell"
    mesh.name = "half"
    assert 'name="half"' in repr(mesh) and gripper.find_all("geom")[1].mesh is mesh


def test_a_name_can_be_taken_away(arm: mjcf.RootElement) -> None:
    site = arm.find("site", "flange")
    assert site is not None
    del site.name
    assert site.name is None and site.full_identifier is None
    with pytest.raises(mjcf.MjcfError, match="`flange`, which does not exist"):
        arm.to_xml_string()


def test_default_classes_are_elements() -> None:
    model = mjcf.RootElement()
    red = model.default.add("default", dclass="red")
    red.geom.rgba = [1, 0, 0, 1]
    geom = model.worldbody.add("geom", size=[1], dclass=red)
    assert red.name == "red" and geom.dclass is red and red.geom.tag == "geom"
    geom.dclass = model.default
    assert geom.dclass is model.default and 'class="main"' in repr(geom)
    with pytest.raises(mjcf.MjcfError, match="default class is already called `red`"):
        model.default.add("default", dclass="red")


def test_the_origin_is_a_place_in_a_file_or_a_line_of_the_program(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "shoulder")
    assert joint is not None and (joint.origin.file.endswith("arm.xml"), joint.origin.line) == (True, 14)
    added = arm.worldbody.add("geom", size=[1])
    assert added.origin.file == __file__


def test_scopes_lead_to_attached_models(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    cell = mjcf.RootElement("cell")
    cell.attach(arm)
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    assert cell.enter_scope("arm/gripper") is cell.enter_scope("arm/gripper/") is gripper
    assert cell.worldbody.enter_scope("arm").enter_scope("gripper") is gripper  # type: ignore[union-attr]
    assert cell.enter_scope("gripper") is arm.enter_scope("arm") is None
    assert (gripper.full_identifier, cell.full_identifier) == ("arm/gripper/", "")
    turn = frame.add("joint", name="turn")
    own = arm.find_all("joint", exclude_attachments=True)
    assert turn in own and len(own) == 3 and len(cell.find_all("joint")) == 5
    assert cell.find_all("joint", exclude_attachments=True) == []


def test_a_removed_element_is_of_no_use(body: mjcf.Element) -> None:
    geom = body.add("geom", name="g", size=[1])
    body.remove()
    assert body.tag == "body" and repr(geom) == '<geom name="g" size="1"/>'
    for attempt in (
        lambda: body.add("geom"),
        lambda: geom.parent,
        lambda: geom.size,
        lambda: geom.get("size"),
        geom.get_attributes,
        lambda: setattr(geom, "size", [2]),
        lambda: geom.find("plugin"),
        lambda: body.attach(mjcf.RootElement("x")),
        body.remove,
    ):
        with pytest.raises(mjcf.MjcfError, match="was removed"):
            attempt()


def test_an_element_is_not_copied_alone_and_pickled_with_its_model(body: mjcf.Element) -> None:
    for copied in (copy.copy, copy.deepcopy):
        with pytest.raises(mjcf.MjcfError, match="without its model"):
            copied(body)
    assert pickle.loads(pickle.dumps(body)).root.to_xml_string() == body.root.to_xml_string()


def test_attributes_and_children_are_completed(body: mjcf.Element) -> None:
    assert {"pos", "childclass", "geom", "add"} <= set(dir(body))
    assert "dclass" in dir(body.add("geom"))


def test_the_top_class_keeps_its_name() -> None:
    model = mjcf.RootElement()
    model.default.geom.rgba = [1, 0, 0, 1]
    with pytest.raises(mjcf.MjcfError, match="the top default class is called `main`"):
        model.default.dclass = "top"
    model.default.dclass = "main"
    assert model.find("default", "main") is model.default


@pytest.mark.parametrize(
    "clash",
    [
        lambda asset: asset.add("mesh", file="other/shell.obj"),
        lambda asset: asset.add("mesh", name="shell", file="cube.stl"),
        lambda asset: setattr(asset.mesh["cube"], "file", "other/shell.obj"),
        lambda asset: setattr(asset.mesh["cup"], "name", None),
    ],
)
def test_a_name_taken_from_a_file_is_a_name(clash: Callable[[mjcf.Element], None]) -> None:
    model = mjcf.RootElement()
    model.asset.add("mesh", file="shell.stl")
    model.asset.add("mesh", file="cube.stl")
    model.asset.add("mesh", name="cup", file="third/shell.stl")
    before = str(model)
    with pytest.raises(mjcf.MjcfError, match="another mesh is already called `shell`"):
        clash(model.asset)
    assert str(model) == before


def test_a_skin_is_named_after_its_file_in_both_sections() -> None:
    model = mjcf.RootElement()
    skin = model.deformable.add("skin", file="coat.skn")
    assert model.find("skin", "coat") is skin
    with pytest.raises(mjcf.MjcfError, match="another skin is already called `coat`"):
        model.asset.add("skin", file="old/coat.skn")


@pytest.fixture
def world() -> mjcf.Element:
    world = mjcf.RootElement().worldbody
    for name in ("a", "b", "c"):
        world.add("geom", name=name, size=[1])
    return world


def test_it_is_a_list_and_takes_names(world: mjcf.Element) -> None:
    geoms = world.geom
    assert len(geoms) == 3 and geoms["b"] is geoms[1] is geoms[-2]
    assert [geom.name for geom in geoms[1:]] == ["b", "c"] and geoms["a"] in geoms
    assert geoms == world.find_all("geom") and geoms == world.geom and geoms != [geoms[0]]
    assert repr(geoms).startswith('[<geom name="a" size="1"/>, <geom name="b"')


def test_a_name_that_is_not_there_is_told_with_those_that_are(world: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="the geom `d` does not exist here\n.*geoms that exist: a, b, c") as caught:
        world.geom["d"]
    assert isinstance(caught.value, KeyError) and caught.value.diagnostics[0].span.file == __file__  # type: ignore[union-attr]
    unnamed = world.add("body").add("site").parent
    with pytest.raises(mjcf.MjcfError, match="none of the 1 elements here has a name"):
        unnamed.site["d"]  # type: ignore[union-attr]
    assert world.geom._ipython_key_completions_() == ["a", "b", "c"]
    with pytest.raises(IndexError):
        world.geom[3]


def test_what_is_deleted_from_it_leaves_the_model(world: mjcf.Element) -> None:
    del world.geom["b"]
    del world.geom[0]
    assert [geom.name for geom in world.geom] == ["c"]
    world.geom.clear()
    assert world.geom == [] and world.root.find_all("geom") == []


def test_it_stays_as_it_was_while_the_model_changes(world: mjcf.Element) -> None:
    for geom in world.geom:
        geom.remove()
    assert len(world.geom) == 0
    assert not hasattr(world.geom, "append")


def test_what_is_in_a_list_is_told_by_name_and_by_element() -> None:
    world = mjcf.RootElement().worldbody
    ball = world.add("geom", name="ball", size=[1])
    other = mjcf.RootElement().worldbody.add("geom", size=[1])
    assert ball in world.geom and "ball" in world.geom
    assert other not in world.geom and "bal" not in world.geom and None not in world.geom


def test_reading_one_element_of_a_long_list_creates_no_other() -> None:
    model = mjcf.RootElement()
    for number in range(50):
        model.worldbody.add("body", name=f"b{number}")
    model = mjcf.from_xml_string(str(model))
    before = len(model._model.views)
    assert model.worldbody.body["b30"].name == "b30"
    assert model.worldbody.body[-1].name == "b49"
    assert len(model._model.views) <= before + 3

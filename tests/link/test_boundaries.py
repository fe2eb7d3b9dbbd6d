"""Elements across the boundary of a `<replicate>`: copies of what a recipe writes, errors for what a source writes."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from link.workshop import Workshop
from mjcompose import mjcf
from mjcompose.mujoco.attributes import names
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context

WORLD = """<worldbody><body name="rail" pos="0 0 2"><joint name="swing" axis="1 0 0"/><geom name="beam" size=".1"/>
  <site name="hook"/></body>
<replicate count="2" sep="_"><replicate count="2" offset="0 .5 0"><body name="lamp"><joint name="turn"/>
  <geom name="bulb" size=".05"/><site name="ring"/></body></replicate></replicate></worldbody>"""
LAMPS = f'<mujoco model="lamps">{WORLD}</mujoco>'
COPIES = [f"{number}_{row}" for row in (0, 1) for number in (0, 1)]
SECTIONS = {
    "weld": ("equality", "{type: weld, body1: lamp, body2: rail}", "eq"),
    "weld backwards": ("equality", "{type: weld, body1: rail, body2: lamp}", "eq"),
    "weld with the world": ("equality", "{type: weld, body1: world, body2: lamp}", "eq"),
    "connect of sites": ("equality", "{type: connect, site1: hook, site2: ring}", "eq"),
    "joint": ("equality", "{type: joint, joint1: turn, joint2: swing}", "eq"),
    "refsite": ("actuator", "{type: motor, site: hook, refsite: ring}", "actuator"),
    "slidersite": ("actuator", "{type: motor, cranksite: ring, slidersite: hook, cranklength: 1}", "actuator"),
}


def built(folder: Path, recipe: str, **files: str) -> tuple[Built | None, Context]:
    for name, text in files.items():
        (folder / f"{name}.xml").write_text(text)
    path = folder / "recipe.yaml"
    path.write_text(f"recipe: 1\nallow: [license-missing]\n{recipe}")
    context = Context(environment={}, folder=folder)
    return build(ModelRequest(path), context), context


def compiled(found: Built | None) -> mujoco.MjModel:
    assert found is not None
    return mujoco.MjModel.from_xml_string(found.bundle.files[found.bundle.model].decode())


@pytest.mark.parametrize(("section", "element", "kind"), SECTIONS.values(), ids=SECTIONS.keys())
def test_the_recipe_gets_one_for_each_copy(tmp_path: Path, section: str, element: str, kind: str) -> None:
    found, context = built(tmp_path, f"base: ./lamps.xml\n{section}: {{link: {element}}}\n", lamps=LAMPS)
    assert not context.sink.has_errors
    model = compiled(found)
    named = names(model, "equality" if kind == "eq" else kind)
    assert sorted(named) == sorted(f"link{end}" for end in COPIES)


def test_each_copy_is_held_where_it_is(tmp_path: Path) -> None:
    element = "{type: weld, body1: lamp, body2: rail}"
    found, _ = built(tmp_path, f"base: ./lamps.xml\nequality: {{link: {element}}}\n", lamps=LAMPS)
    model = compiled(found)
    pairs = [
        (model.body(int(model.eq_obj1id[at])).name, model.body(int(model.eq_obj2id[at])).name)
        for at in range(model.neq)
    ]
    assert sorted(pairs) == sorted((f"lamp{end}", "rail") for end in COPIES)


@pytest.mark.parametrize(
    "element", ['<weld name="w" body1="lamp" body2="rail"/>', '<joint joint1="swing" joint2="turn"/>']
)
def test_a_source_that_loses_it_alone_is_refused(workshop: Workshop, element: str) -> None:
    base = LAMPS.replace("</mujoco>", f"<equality>{element}</equality></mujoco>")
    alone = mujoco.MjModel.from_xml_string(base)
    assert alone.neq == 0
    assert workshop.link(base).fault.code == "not-as-written"


def test_a_source_that_keeps_it_alone_keeps_it_on_a_body(tmp_path: Path) -> None:
    """The world of the part becomes a body outside of the replicate."""
    part = LAMPS.replace("</mujoco>", '<equality><weld name="w" body1="lamp"/></equality></mujoco>')
    arm = '<mujoco><worldbody><body name="arm"><joint/><geom size=".1"/></body></worldbody></mujoco>'
    found, context = built(
        tmp_path, "base: ./arm.xml\nattach: {p: {model: ./lamps.xml, body: arm}}\n", arm=arm, lamps=part
    )
    assert not context.sink.has_errors
    model = compiled(found)
    assert sorted(names(model, "equality")) == sorted(f"p/w{end}" for end in COPIES)
    assert {model.body(int(each)).name for each in model.eq_obj2id} == {"arm"}


def test_a_nested_recipe_brings_its_copies(tmp_path: Path) -> None:
    inner = "recipe: 1\nbase: ./lamps.xml\nequality: {link: {type: weld, body1: lamp, body2: rail}}\n"
    (tmp_path / "inner.yaml").write_text(inner)
    found, context = built(
        tmp_path, "attach: {a: {model: ./inner.yaml}, b: {model: ./inner.yaml, pos: [1, 0, 0]}}\n", lamps=LAMPS
    )
    assert not context.sink.has_errors
    model = compiled(found)
    assert sorted(names(model, "equality")) == sorted(f"{part}/link{end}" for part in "ab" for end in COPIES)


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_keys_and_the_interface_name_the_copies(tmp_path: Path) -> None:
    recipe = """base: ./lamps.xml
actuator: {pull: {type: motor, site: ring, refsite: hook}, swing: {type: motor, joint: swing}}
interface: {actuator: [swing, pull0_0, pull1_0, pull0_1, pull1_1]}
keyframe: {on: {ctrl: {pull1_0: 3, swing: 2}}}
"""
    found, context = built(tmp_path, recipe, lamps=LAMPS)
    assert not context.sink.has_errors
    model = compiled(found)
    assert names(model, "actuator") == ["swing", "pull0_0", "pull1_0", "pull0_1", "pull1_1"]
    assert model.key_ctrl[0].tolist() == [2, 0, 3, 0, 0]


def test_python_writes_the_copies() -> None:
    model = mjcf.from_xml_string(LAMPS)
    model.equality.add("weld", name="link", body1="lamp", body2="rail")
    compiled = model.compile_model().model
    assert sorted(names(compiled, "equality")) == sorted(f"link{end}" for end in COPIES)
    assert mujoco.MjModel.from_xml_string(model.to_xml_string()).neq == len(COPIES)


def test_python_refuses_what_a_file_loses() -> None:
    text = LAMPS.replace("</mujoco>", '<equality><weld body1="lamp" body2="rail"/></equality></mujoco>')
    model = mjcf.from_xml_string(text)
    with pytest.raises(mjcf.MjcfError, match="not-as-written"):
        model.compile_model()


SENSORS = {
    "framepos": '<framepos name="s" objtype="site" objname="ring" reftype="body" refname="rail"/>',
    "distance": '<distance name="s" geom1="beam" geom2="bulb"/>',
    "contact": '<contact name="s" geom1="bulb" body2="rail"/>',
    "jointpos": '<jointpos name="s" joint="turn"/>',
}


@pytest.mark.parametrize("sensor", SENSORS.values(), ids=SENSORS.keys())
def test_the_interface_lists_the_copies_of_a_sensor(tmp_path: Path, sensor: str) -> None:
    """However the sensor refers to something inside: by an attribute, or by a type and a name."""
    text = LAMPS.replace("</mujoco>", f'<sensor>{sensor}<jointvel name="own" joint="swing"/></sensor></mujoco>')
    listed = ", ".join(["own", *(f"s{end}" for end in COPIES)])
    found, context = built(tmp_path, f"base: ./lamps.xml\ninterface: {{sensor: [{listed}]}}\n", lamps=text)
    assert not context.sink.has_errors, context.sink.errors
    assert names(compiled(found), "sensor") == listed.split(", ")
    _, context = built(tmp_path, "base: ./lamps.xml\ninterface: {sensor: [own, s]}\n", lamps=text)
    assert [(each.code, each.message) for each in context.sink.errors] == [
        ("unknown-name", "the sensor `s` does not exist")
    ]


def test_python_writes_the_copies_of_an_attached_model() -> None:
    """The world of an attached model becomes a body, which is outside of its replicates."""
    outer = mjcf.from_xml_string(
        '<mujoco model="o"><worldbody><body name="bar"><joint name="j"/><geom size=".1"/><site name="s"/></body></worldbody></mujoco>'
    )
    inner = mjcf.from_xml_string(LAMPS)
    outer.find("site", "s").attach(inner)
    outer.equality.add("weld", name="across", body1=inner.find("body", "lamp"), body2=outer.find("body", "bar"))
    inner.equality.add("weld", name="within", body1="lamp", body2="rail")
    inner.equality.add("connect", name="world", body1="lamp", anchor=[0, 0, 0])
    model = outer.compile_model().model
    expected = [f"{name}{end}" for name in ("across", "lamps/within", "lamps/world") for end in COPIES]
    assert sorted(names(model, "equality")) == sorted(expected)
    holders = {model.equality(at).name[:12]: model.body(int(model.eq_obj2id[at])).name for at in range(model.neq)}
    assert set(holders.values()) == {"bar", "lamps/rail"}

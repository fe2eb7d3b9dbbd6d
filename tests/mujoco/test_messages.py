from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.mujoco.messages import (
    EngineMessage,
    Topic,
    instead_of_old,
    kind_of,
    of_other_version,
    parse,
    read_sentence,
    translate,
    unknown_attribute,
    version_of,
)
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def test_an_attribute_that_is_written_nowhere_is_reported_at_the_element(tmp_path: Path) -> None:
    """A texture that is neither a skybox nor named: MuJoCo asks for `name`, which has no default."""
    texture = '<texture type="2d" builtin="flat" width="8" height="8"/>'
    model = f"<mujoco>\n<asset>{texture}</asset>\n<worldbody><geom size='1'/></worldbody>\n</mujoco>"
    (tmp_path / "a.xml").write_text(model)
    (tmp_path / "a.yaml").write_text("recipe: 1\nbase: ./a.xml\n")
    context = Context(folder=tmp_path)
    assert build(ModelRequest(tmp_path / "a.yaml"), context) is None
    (fault,) = context.sink.errors
    assert fault.span is not None and (fault.span.file, fault.span.line) == ("a.xml", 2)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (
            "Error: size 0 must be positive in geom\nElement name 'left/X', id 0, line 38",
            EngineMessage("size 0 must be positive in geom", 38, None, None, "left/X"),
        ),
        (
            "XML Error: Schema violation: unrecognized attribute: 'foo'\nElement 'geom', line 3, column 7\n",
            EngineMessage("Schema violation: unrecognized attribute: 'foo'", 3, 7, "geom"),
        ),
        (
            "XML Error: Error: repeated name 'a' in body\nElement 'body', line 1\n",
            EngineMessage("repeated name 'a' in body", 1, None, "body"),
        ),
        (
            "XML Error: Error: GMSH decoder: no\nElement name '', id -1\nElement 'flexcomp', line 3\n",
            EngineMessage("GMSH decoder: no", 3, None, "flexcomp"),
        ),
        ("Error: Error opening file 'nope.stl'", EngineMessage("Error opening file 'nope.stl'")),
        ("ParseXML: empty file 'model.xml'", EngineMessage("empty file 'model.xml'")),
        ("Error: free joint\nElement name '', id 2, line -1", EngineMessage("free joint")),
        ("Error: x\nElement name 'it's, id 4, line 5', id 2, line 7", EngineMessage("x", 7, name="it's, id 4, line 5")),
        ("Error: x\nElement name 'a\nb', id 2", EngineMessage("x", name="a\nb")),
        (
            "timestep: parent has 1\nintegrator: parent has 2",
            EngineMessage("timestep: parent has 1\nintegrator: parent has 2"),
        ),
        (
            "XML parse error 6:\nError=XML_ERROR_PARSING_ELEMENT ID=6 Line number=4: XMLElement name=geom\n",
            EngineMessage("not well-formed XML: parsing element", 4, element="geom"),
        ),
        (
            "XML parse error 14:\nError=XML_ERROR_MISMATCHED_ELEMENT ID=14 Line number=2: odd  it\n",
            EngineMessage("not well-formed XML: mismatched element: odd it", 2),
        ),
        ("", EngineMessage("")),
    ],
)
def test_a_message_is_taken_apart(text: str, fault: EngineMessage) -> None:
    assert parse(text) == fault


@pytest.mark.parametrize(
    ("message", "topic"),
    [
        ("mass and inertia of moving bodies must be larger than mjMINVAL", Topic.MASS),
        ("size 0 must be positive in geom", Topic.GEOM_SIZE),
        ("size 1 must be positive in site", Topic.SIZE),
        ("inertia must satisfy A + B >= C; use 'balanceinertia' to fix", Topic.INERTIA),
        ("an OpenGL platform library has not been loaded into this process, this most likely", Topic.OPENGL),
        ("URDF body not found", Topic.URDF_RING),
        ("URDF body not found here", None),
        ("it is odd", None),
    ],
)
def test_what_it_is_about(message: str, topic: Topic | None) -> None:
    assert read_sentence(message).topic is topic


def test_what_it_names() -> None:
    said = read_sentence("Schema violation: unrecognized attribute: 'color'")
    assert (said.unknown_attribute, said.attribute, said.names) == ("color", None, ("color",))
    assert read_sentence("required attribute missing: 'pos'").missing_attribute == "pos"
    assert read_sentence("URDF missing element: 'inertial'").missing_element == "inertial"
    assert read_sentence("size 2 must be positive in geom").size_index == 2
    assert read_sentence("mj_init failed for plugin id 3").plugin == 3
    assert read_sentence("could not allocate arena memory").section == "size"


def element(inside: str) -> etree._Element:
    return etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")[0][0]


def test_what_it_speaks_of_is_named() -> None:
    assert translate("it is odd", None).diagnostic.message == "MuJoCo rejects the model: it is odd"
    assert translate("it is odd", element("<geom/>")).diagnostic.message == "MuJoCo rejects this geom: it is odd"
    assert (
        translate("it is odd", element('<geom name="a/b"/>')).diagnostic.message
        == "MuJoCo rejects the geom `a/b`: it is odd"
    )


def test_the_attribute_that_it_lies_in() -> None:
    geom = element('<geom name="x" size="a" type="bx" material="m"/>')
    assert translate("bad format in attribute 'size'", geom).attribute == "size"
    assert translate("invalid keyword: 'bx'", geom).attribute == "type"
    assert translate("unknown material 'm' in geom 'x'", geom).attribute == "material"
    assert translate("required attribute missing: 'pos'", geom).attribute is None, "it is not there"
    assert translate("something about 'x'", geom).attribute is None
    assert translate("'a' or 'm'", geom).attribute is None, "it may be either"


def test_keywords_that_exist() -> None:
    (note,) = translate("invalid keyword: 'bx'", element('<geom type="bx"/>')).diagnostic.notes
    assert note.message.startswith("keywords that exist: box, ")


def test_advice() -> None:
    said = translate("mass and inertia of moving bodies must be larger than mjMINVAL", element("<body/>"))
    assert said.diagnostic.help == "give the body a geom that has mass, or an `inertial`"
    assert translate("something never heard of", None).diagnostic.help is None


def test_unknown_words_of_mjcf() -> None:
    said = translate("Schema violation: unrecognized attribute: 'color'", element('<geom color="1"/>'))
    assert (said.diagnostic.code, said.attribute, said.key) == ("unknown-attribute", "color", True)
    assert said == unknown_attribute(element("<geom/>"), "color")
    said = translate("Schema violation: unrecognized element", element("<gem/>"))
    assert (said.diagnostic.code, said.diagnostic.message, said.diagnostic.help) == (
        "unknown-element",
        "`<gem>` cannot be in `<worldbody>`",
        "did you mean `<geom>`?",
    )


def test_kinds() -> None:
    geom = kind_of(element("<frame><body><geom/></body></frame>")[0][0])
    assert geom is not None and geom.path == "geom"
    joint = kind_of(etree.fromstring("<mujoco><equality><joint/></equality></mujoco>")[0][0])
    assert joint is not None and joint.path == "equality/joint"
    assert kind_of(element("<what><geom/></what>")[0]) is None


def test_what_another_mujoco_reads() -> None:
    model = etree.fromstring(
        "<mujoco><option mpr_iterations='1'/><compiler convexhull='true' saveinertial='true'/></mujoco>"
    )
    option, compiler = model
    found = of_other_version(option, "mpr_iterations", "old.xml", "3.1.6")
    assert found is not None and found.fix is None, "`ls_iterations` is near, and something else"
    assert found.help == "`mjcompose migrate old.xml --from 3.1.6 -o NEW` writes the model for this MuJoCo"
    in_recipe = of_other_version(option, "mpr_iterations", "cell.yaml")
    assert in_recipe is not None and in_recipe.help is None
    assert of_other_version(option, "color", "old.xml") is None
    assert version_of([(compiler, "convexhull"), (option, "mpr_iterations")]) == "3.2.2"
    new = etree.fromstring("<mujoco><worldbody><replicate/><body><joint springyield='1'/></body></worldbody></mujoco>")
    assert version_of([(new[0][0], None), (new[0][1][0], "springyield")]) == "4.0.0"
    assert version_of([(option, "color")]) is None


DYNAMIC = ("ball", "floor")
BY_PAIR = ("box", "floor")


@pytest.mark.parametrize(
    ("value", "colliding"), [("all", {DYNAMIC, BY_PAIR}), ("dynamic", {DYNAMIC}), ("predefined", {BY_PAIR})]
)
def test_the_advice_for_an_old_model_keeps_what_collides(value: str, colliding: set[tuple[str, str]]) -> None:
    help = instead_of_old("option", "collision", value)
    assert help is not None
    pair = "" if "every `<pair>`" in help else '<contact><pair geom1="floor" geom2="box"/></contact>'
    bits = "" if "every `contype`" in help else 'contype="2" conaffinity="4"'
    added = help.partition("\n")[2]
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco>{added}<worldbody><geom name="floor" type="plane" size="1 1 1"/>
        <body pos="0 0 0.05"><freejoint/><geom name="ball" size="0.1"/></body>
        <body pos="0.1 0 0.05"><freejoint/><geom name="box" size="0.1" {bits}/></body></worldbody>{pair}</mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert {tuple(sorted(model.geom(int(each)).name for each in contact.geom)) for contact in data.contact} == colliding

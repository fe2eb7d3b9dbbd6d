from __future__ import annotations

from lxml import etree

from composer.mujoco_errors.translation import kind_of, translate, unknown_attribute


def element(inside: str) -> etree._Element:
    return etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")[0][0]


def test_what_it_speaks_of_is_named() -> None:
    assert translate("it is odd", None).diagnostic.message == "MuJoCo rejects the model: it is odd"
    assert (
        translate("it is odd", element("<geom/>")).diagnostic.message == "MuJoCo rejects this geom: it is odd"
    )
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
    said = translate("Schema violation: unrecognized attribute: 'colour'", element('<geom colour="1"/>'))
    assert (said.diagnostic.code, said.attribute, said.key) == ("unknown-attribute", "colour", True)
    assert said == unknown_attribute(element("<geom/>"), "colour")
    said = translate("Schema violation: unrecognized element", element("<gem/>"))
    assert (said.diagnostic.code, said.diagnostic.message, said.diagnostic.help) == (
        "unknown-element", "`<gem>` cannot stand in `<worldbody>`", "did you mean `<geom>`?",
    )  # fmt: skip


def test_kinds() -> None:
    geom = kind_of(element("<frame><body><geom/></body></frame>")[0][0])
    assert geom is not None and geom.path == "geom"
    joint = kind_of(etree.fromstring("<mujoco><equality><joint/></equality></mujoco>")[0][0])
    assert joint is not None and joint.path == "equality/joint"
    assert kind_of(element("<what><geom/></what>")[0]) is None

from __future__ import annotations

from lxml import etree

from composer.mujoco_errors.other_version import of_other_version, version_of
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
    assert of_other_version(option, "colour", "old.xml") is None
    assert version_of([(compiler, "convexhull"), (option, "mpr_iterations")]) == "3.2.2"
    new = etree.fromstring(
        "<mujoco><worldbody><replicate/><body><joint springyield='1'/></body></worldbody></mujoco>"
    )
    assert version_of([(new[0][0], None), (new[0][1][0], "springyield")]) == "4.0.0"
    assert version_of([(option, "colour")]) is None

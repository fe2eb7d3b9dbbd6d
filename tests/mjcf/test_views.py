from __future__ import annotations

import inspect
import pydoc

import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf.attributed import of_attribute, of_element
from mjcompose.tree.grammar import GRAMMAR


@pytest.fixture
def geom() -> mjcf.Element:
    return mjcf.RootElement().worldbody.add("body", name="b").add("geom", name="g", size=[1])


def test_elements_of_a_kind_share_a_class(geom: mjcf.Element) -> None:
    other = geom.parent.add("geom")  # type: ignore[union-attr]
    assert type(geom) is type(other) and type(geom).__name__ == "Geom" and isinstance(geom, mjcf.Element)
    model = geom.root
    connect = model.equality.add("connect", body1="b", anchor=[0, 0, 0])
    assert type(connect).__name__ == "EqualityConnect"


def test_help_says_what_an_element_and_its_attributes_are(geom: mjcf.Element) -> None:
    told = pydoc.render_doc(type(geom), renderer=pydoc.plaintext)
    assert "`<geom>`: a shape that collides" in told
    assert "friction: sliding, spinning (m) and rolling (m) friction [1 to 3 numbers]" in told
    friction = inspect.getdoc(type(geom).friction)
    assert friction is not None and "1 0.005 0.0001 if it is not set anywhere" in friction
    assert "add('geom', …)" in (inspect.getdoc(type(geom.parent).geom) or "")


@pytest.mark.parametrize(
    ("path", "name", "said"),
    [
        ("geom", "type", "'plane', 'hfield', 'sphere'"),
        ("geom", "material", "a material, or its name"),
        ("geom", "class", "a default class, or its name"),
        ("sensor/framepos", "objname", "of the kind in `objtype`, or its name; it must be set"),
        ("mesh", "file", "a file name, or an `Asset`"),
        ("geom", "shellinertia", "True or False; false if"),
        ("flex", "body", "elements of the kind body, or their names"),
    ],
)
def test_what_an_attribute_takes(path: str, name: str, said: str) -> None:
    assert said in of_attribute(GRAMMAR.element(path).attributes[name])


def test_every_kind_has_a_text_with_all_it_has() -> None:
    for section in GRAMMAR.root.children:
        for kind in [GRAMMAR.section(section), *GRAMMAR.within(section).values()]:
            told = of_element(kind)
            assert told.startswith(f"`<{kind.tag}>`") and told.count("\n    ") == len(kind.attributes)


def test_a_property_reads_writes_and_deletes(geom: mjcf.Element) -> None:
    geom.friction = np.array([1, 2, 3])
    assert geom.friction.tolist() == [1, 2, 3]
    del geom.friction
    assert geom.friction is None
    with pytest.raises(mjcf.MjcfError, match="is an element and cannot be set"):
        del geom.parent.geom  # type: ignore[union-attr]


def test_words_that_python_keeps_end_in_an_underscore() -> None:
    visual = mjcf.RootElement().visual
    assert "global_" in dir(visual) and "global" not in dir(visual)
    visual.global_.fovy = 50
    assert repr(visual.global_) == '<global fovy="50"/>'


def test_what_cannot_be_attached_to_does_not_offer_it(geom: mjcf.Element) -> None:
    assert "attach" in dir(geom.parent) and "attach" not in dir(geom)


def test_an_element_keeps_its_identity(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "elbow_joint")
    assert joint is not None
    assert arm.find("joint", "elbow_joint") is joint
    assert joint.parent is arm.find("body", "fore") and joint.parent.joint[0] is joint
    assert joint.root is arm and arm.worldbody.parent is arm and arm.parent is None
    assert any(each is joint for each in arm.find_all("joint"))


def test_a_kind_of_element_has_one_class(arm: mjcf.RootElement) -> None:
    shoulder, elbow = arm.find_all("joint")
    assert type(shoulder) is type(elbow) is not type(arm.default.joint)
    assert type(shoulder).__name__ == "Joint" and isinstance(shoulder, mjcf.Element)

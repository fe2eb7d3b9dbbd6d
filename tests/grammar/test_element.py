from __future__ import annotations

from composer.grammar import GRAMMAR


def test_cardinality() -> None:
    assert (GRAMMAR.root.min_count, GRAMMAR.root.max_count) == (1, 1)
    assert GRAMMAR.element("inertial").max_count == 1
    assert GRAMMAR.element("geom").max_count is None


def test_path_and_tag() -> None:
    joint = GRAMMAR.element("equality/joint")
    assert (joint.path, joint.tag) == ("equality/joint", "joint")
    assert repr(joint) == "ElementType(equality/joint)"


def test_default_row() -> None:
    assert GRAMMAR.element("tendon/fixed").default == "default/tendon"
    assert GRAMMAR.element("equality/weld").default == "default/equality"
    assert GRAMMAR.element("geom").default == "default/geom"
    assert GRAMMAR.element("default/geom").rows_of == "geom"
    assert GRAMMAR.element("freejoint").default is None


def test_exists_in() -> None:
    assert not GRAMMAR.element("composite").exists_in("4.0.0")
    assert GRAMMAR.element("composite").exists_in("3.17.0")
    assert GRAMMAR.element("geom").exists_in("4.0.0")


def test_class() -> None:
    assert GRAMMAR.element("geom").takes_class
    assert not GRAMMAR.element("default").takes_class  # it declares one
    assert not GRAMMAR.element("freejoint").takes_class
    assert GRAMMAR.element("frame").takes_childclass


def test_children_behave_as_a_mapping() -> None:
    children = GRAMMAR.element("option").children
    assert dict(children) == {"flag": GRAMMAR.element("option/flag")}
    assert repr(children) == "Children(flag)"

"""The grammar as an interface: paths, sections, families, laziness."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from mjcompose.base.words import number_text
from mjcompose.tree.grammar import GRAMMAR, ElementType, Grammar, exists_in, read_data, to_text, version_key
from tree.keywords import keywords_in


@pytest.mark.parametrize(
    ("path", "name", "separated"),
    [
        ("geom", "size", True),
        ("geom", "mass", False),
        ("geom", "material", False),
        ("flex", "body", True),
        ("camera", "output", True),
        ("keyframe/key", "qpos", True),
        ("compiler", "eulerseq", False),
    ],
)
def test_separated(path: str, name: str, separated: bool) -> None:
    assert GRAMMAR.element(path).attributes[name].separated is separated


def test_lengths() -> None:
    geom = GRAMMAR.element("geom").attributes
    assert (geom["size"].min_length, geom["size"].max_length) == (1, 3)
    assert (geom["rgba"].min_length, geom["rgba"].max_length) == (4, 4)
    assert (geom["mass"].min_length, geom["mass"].max_length) == (1, 1)
    assert (geom["user"].min_length, geom["user"].max_length) == (1, None)
    assert (geom["name"].min_length, geom["name"].max_length) == (None, None)
    assert GRAMMAR.element("frame").attributes["scale"].lengths == (1, 3)
    assert GRAMMAR.element("compiler").attributes["eulerseq"].max_length == 3


def test_keywords_by_version() -> None:
    integrator = GRAMMAR.element("option").attributes["integrator"]
    assert "discrete" in keywords_in(integrator, "3.13.0")
    assert "discrete" not in keywords_in(integrator, "3.12.0")
    equality = GRAMMAR.element("flexcomp/edge").attributes["equality"]
    assert "vert" in keywords_in(equality, "3.17.0")
    assert "vert" not in keywords_in(equality, "4.0.0")
    cone = GRAMMAR.element("option").attributes["cone"]
    assert keywords_in(cone, "3.12.0") == cone.keywords == ("pyramidal", "elliptic")


def test_exists_in() -> None:
    springyield = GRAMMAR.element("joint").attributes["springyield"]
    assert springyield.exists_in("4.0.0")
    assert not springyield.exists_in("3.17.0")


def test_files_have_a_folder() -> None:
    texture = GRAMMAR.element("texture").attributes
    files = {name for name, attribute in texture.items() if attribute.type == "file"}
    assert len(files) == 7
    assert {texture[name].folder for name in files} == {"texture"}


def test_defaults_are_plain_values() -> None:
    geom = GRAMMAR.element("geom").attributes
    assert geom["friction"].default == (1, 0.005, 0.0001)
    assert geom["density"].default == 1000
    assert geom["type"].default == "sphere"
    assert geom["castshadow"].default is True
    assert geom["mass"].default is None


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


def test_exists_in_element() -> None:
    assert not GRAMMAR.element("composite").exists_in("4.0.0")
    assert GRAMMAR.element("composite").exists_in("3.17.0")
    assert GRAMMAR.element("geom").exists_in("4.0.0")


def test_class() -> None:
    assert GRAMMAR.element("geom").takes_class
    assert not GRAMMAR.element("default").takes_class  # it declares one
    assert not GRAMMAR.element("freejoint").takes_class


def test_children_behave_as_a_mapping() -> None:
    children = GRAMMAR.element("option").children
    assert dict(children) == {"flag": GRAMMAR.element("option/flag")}


GEOM = GRAMMAR.element("geom").attributes


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("pos", [0, 0.5, -0.0], "0 0.5 -0"),
        ("pos", np.array([1.0, 0.1, 1e-7]), "1 0.1 1e-07"),
        ("mass", 2.0, "2"),
        ("mass", 1e22, "1e+22"),
        ("mass", np.float64(0.1), "0.1"),
        ("mass", math.inf, "inf"),
        ("mass", -math.inf, "-inf"),
        ("mass", -math.nan, "nan"),
        ("mass", "0x10", "0x10"),
        ("group", 3, "3"),
        ("group", 3.0, "3"),
        ("group", np.int32(3), "3"),
        ("shellinertia", True, "true"),
        ("shellinertia", np.bool_(False), "false"),
        ("type", "box", "box"),
    ],
)
def test_to_text(name: str, value: object, text: str) -> None:
    assert to_text(GEOM[name], value) == text


def test_lists_of_words() -> None:
    assert to_text(GRAMMAR.element("sensor/contact").attributes["data"], ["found", "force"]) == "found force"
    assert to_text(GRAMMAR.element("flex").attributes["body"], ("a", "b")) == "a b"
    assert to_text(GRAMMAR.element("visual/headlight").attributes["active"], 1) == "1"
    assert to_text(GRAMMAR.element("joint").attributes["limited"], False) == "false"


def test_what_has_no_text() -> None:
    with pytest.raises(TypeError, match="mass cannot hold NoneType"):
        to_text(GEOM["mass"], None)


@given(st.floats(allow_nan=False))
def test_numbers_are_re_read_exactly(value: float) -> None:
    again = float(number_text(value))
    assert again == value
    assert math.copysign(1, again) == math.copysign(1, value)


@given(st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_mujoco_re_reads_exactly(values: list[float]) -> None:
    xml = f'<mujoco><worldbody><geom pos="{to_text(GEOM["pos"], values)}"/></worldbody></mujoco>'
    assert mujoco.MjSpec.from_string(xml).geoms[0].pos.tolist() == values


def test_canonical_paths_resolve_to_themselves() -> None:
    assert GRAMMAR.paths[0] == "mujoco"
    for path in GRAMMAR.paths:
        assert GRAMMAR.element(path).path == path


@pytest.mark.parametrize(
    ("path", "canonical"),
    [
        ("geom", "geom"),
        ("worldbody/geom", "geom"),
        ("worldbody/body/frame/replicate/geom", "geom"),
        ("mujoco/asset/mesh", "mesh"),
        ("asset/skin", "skin"),
        ("deformable/skin", "skin"),
        ("flexcomp/contact", "flex/contact"),
        ("framepos", "sensor/framepos"),
        ("fixed", "tendon/fixed"),
        ("key", "keyframe/key"),
        ("fixed/joint", "fixed/joint"),
        ("equality/joint", "equality/joint"),
        ("default/joint", "default/joint"),
        ("default/material/layer", "material/layer"),
    ],
)
def test_other_ways_to_say_a_path(path: str, canonical: str) -> None:
    assert GRAMMAR.element(path) is GRAMMAR.element(canonical)


@pytest.mark.parametrize("path", ["", "gem", "worldbody/mesh", "geom/", "mujoco/geom", "edge", "default/body"])
def test_unknown_or_ambiguous_path(path: str) -> None:
    with pytest.raises(KeyError):
        GRAMMAR.element(path)


def test_sections_are_the_children_of_the_root() -> None:
    assert GRAMMAR.section("sensor").children["force"].path == "sensor/force"
    assert set(GRAMMAR.root.children) >= {"worldbody", "asset", "option", "keyframe", "extension"}
    with pytest.raises(KeyError):
        GRAMMAR.section("geom")


def test_children_are_paths_that_exist() -> None:
    for path in GRAMMAR.paths:
        for tag, child in GRAMMAR.element(path).children.items():
            assert child.tag == tag
            assert child is GRAMMAR.element(child.path)


def test_every_element_can_be_reached() -> None:
    reached: set[str] = set()

    def walk(element: ElementType) -> None:
        if element.path not in reached:
            reached.add(element.path)
            for child in element.children.values():
                walk(child)

    walk(GRAMMAR.root)
    assert set(GRAMMAR.paths) - reached == {"include"}


def test_bodies_are_recursive() -> None:
    body = GRAMMAR.element("body")
    assert body.children["body"] is body
    assert body.children["frame"].children["replicate"].children["body"] is body
    assert "joint" not in GRAMMAR.section("worldbody").children
    assert "nothing" not in body.children
    assert len(body.children) == len(list(body.children)) > 10


def test_within_takes_the_nearest_meaning() -> None:
    world = GRAMMAR.within("worldbody")
    assert world["geom"] is GRAMMAR.element("geom")
    assert world["joint"] is GRAMMAR.element("joint")
    assert world["site"] is GRAMMAR.element("site")
    assert world["edge"].path == "flexcomp/edge"
    assert GRAMMAR.within("tendon")["joint"].path == "fixed/joint"
    assert GRAMMAR.within("equality")["joint"].path == "equality/joint"
    assert GRAMMAR.within("actuator")["plugin"].path == "actuator/plugin"
    assert GRAMMAR.within("default")["layer"].path == "material/layer"
    assert GRAMMAR.within("option")["flag"].path == "option/flag"
    assert "worldbody" not in world


def test_families() -> None:
    assert GRAMMAR.families["joint"] == ("joint", "freejoint")
    assert set(GRAMMAR.families["tendon"]) == {"tendon/fixed", "tendon/spatial"}
    assert set(GRAMMAR.families["flex"]) == {"flex", "flexcomp"}
    assert len(GRAMMAR.families["actuator"]) == len(GRAMMAR.section("actuator").children)
    assert len(GRAMMAR.families["sensor"]) == len(GRAMMAR.section("sensor").children)
    for family, paths in GRAMMAR.families.items():
        for path in paths:
            assert GRAMMAR.element(path).family == family


def test_references_are_to_namespaces_that_exist() -> None:
    for path in GRAMMAR.paths:
        attributes = GRAMMAR.element(path).attributes
        for attribute in attributes.values():
            if attribute.refers is not None:
                assert attribute.refers.removeprefix("attached:") in GRAMMAR.namespaces, (path, attribute.name)
            if attribute.refers_by is not None:
                kinds = attributes[attribute.refers_by]
                assert {GRAMMAR.objtypes[word] for word in kinds.keywords} <= GRAMMAR.namespaces
            assert attribute.is_reference == (attribute.refers is not None or attribute.refers_by is not None)
            assert (attribute.declares is not None) == (attribute.type == "name")


def test_objtypes() -> None:
    assert GRAMMAR.objtypes["xbody"] == "body"
    assert GRAMMAR.objtypes["plugin"] == "instance"
    assert set(GRAMMAR.objtypes.values()) <= GRAMMAR.namespaces


def test_rows_of_default_classes() -> None:
    for path in GRAMMAR.paths:
        element = GRAMMAR.element(path)
        if element.rows_of is not None:
            assert all(attribute.in_default for attribute in element.attributes.values()), path
            continue
        if element.default is None:
            assert not any(attribute.in_default for attribute in element.attributes.values()), path
            continue
        row = GRAMMAR.element(element.default)
        settable = {name for name, attribute in element.attributes.items() if attribute.in_default}
        if row.rows_of == path:
            assert settable == set(row.attributes)
        else:
            assert settable <= set(row.attributes)
        assert element.takes_class
        assert "class" not in row.attributes
    assert GRAMMAR.element("default/tendon").attributes["range"].in_default
    assert not GRAMMAR.element("mesh").attributes["file"].in_default


def test_who_takes_a_class() -> None:
    taking = {path for path in GRAMMAR.paths if GRAMMAR.element(path).takes_class}
    assert taking == {path for path in GRAMMAR.paths if GRAMMAR.element(path).default is not None} | {"actuator/plugin"}
    childclass = {path for path in GRAMMAR.paths if "childclass" in GRAMMAR.element(path).attributes}
    assert childclass == {"body", "frame", "replicate"}


def test_constraints_are_over_attributes_that_exist() -> None:
    count = 0
    for path in GRAMMAR.paths:
        element = GRAMMAR.element(path)
        for rule in element.constraints:
            count += 1
            assert rule.kind in ("exclusive", "together", "requires", "oneof")
            for bundle in rule.bundles:
                assert set(bundle) <= set(element.attributes), path
    assert count > 20
    (orientation,) = GRAMMAR.element("body").constraints
    assert orientation.bundles == (("quat",), ("axisangle",), ("xyaxes",), ("zaxis",), ("euler",))


def test_defaults_fit_their_attributes() -> None:
    for path in GRAMMAR.paths:
        for attribute in GRAMMAR.element(path).attributes.values():
            default = attribute.default
            if default is None:
                continue
            assert isinstance(default, tuple) == attribute.separated, (path, attribute.name)
            if attribute.type == "keyword":
                assert default in attribute.keywords


def test_nothing_is_read_before_use() -> None:
    calls: list[str] = []

    def read() -> str:
        calls.append("read")
        return read_data()

    grammar = Grammar(read)
    assert calls == []
    assert grammar.element("geom") is grammar.element("geom")
    assert grammar.within("asset") is grammar.within("asset")
    assert calls == ["read"]


def test_import_is_light() -> None:
    heavy = "lxml yaml pydantic numpy mujoco click".split()
    code = (
        "import sys; from mjcompose.tree.grammar import GRAMMAR; GRAMMAR.within('worldbody');"
        f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    root = str(Path(__file__).parents[2])
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_data_file_is_one_attribute_a_line() -> None:
    """Kept by hand: a row is on one line, so that a change is one line of a diff."""
    text = read_data()
    data = json.loads(text)
    lines = set(map(str.strip, text.splitlines()))
    for table in (data["groups"], data["elements"]):
        for entry in table.values():
            for name, row in entry.get("attributes", {}).items():
                line = f'"{name}": {json.dumps(row, ensure_ascii=False)}'
                assert line in lines or f"{line}," in lines
                assert set(row) <= {
                    "type",
                    "length",
                    "lengths",
                    "keywords",
                    "default",
                    "required",
                    "declares",
                    "refers",
                    "refers_by",
                    "folder",
                    "angle",
                    "in_default",
                    "since",
                    "until",
                }


def test_every_group_and_list_of_keywords_is_used() -> None:
    data = json.loads(read_data())
    tables = [*data["groups"].values(), *data["elements"].values()]
    rows = [row for entry in tables for row in entry.get("attributes", {}).values()]
    assert {row["keywords"] for row in rows if "keywords" in row} == set(data["keywords"])
    assert {group for entry in data["elements"].values() for group in entry.get("groups", ())} == set(data["groups"])


def test_everything_is_explained_in_a_line() -> None:
    for path in GRAMMAR.paths:
        element = GRAMMAR.element(path)
        for what, doc in [(path, element.doc), *((f"{path}/{a.name}", a.doc) for a in element.attributes.values())]:
            assert 0 < len(doc) <= 110, what
            assert "\n" not in doc, what
            assert not doc.endswith("."), what


def test_no_explanation_is_stray() -> None:
    data = json.loads(read_data())
    assert set(data["docs"]["elements"]) == set(data["elements"])
    rows = {
        f"{place}/{name}"
        for table in (data["groups"], data["elements"])
        for place, entry in table.items()
        for name in entry.get("attributes", {})
    }
    names = {row.rpartition("/")[2] for row in rows}
    for key in data["docs"]["attributes"]:
        assert key in (rows if "/" in key else names), key


def test_explanation_of_one_place_wins() -> None:
    assert "bodies that carry" in GRAMMAR.element("flex").attributes["body"].doc
    assert GRAMMAR.element("default/geom").attributes["pos"].doc == GRAMMAR.element("geom").attributes["pos"].doc
    assert GRAMMAR.element("default/tendon").attributes["armature"].doc


@pytest.mark.parametrize(
    ("version", "since", "until", "expected"),
    [
        ("3.12.0", None, None, True),
        ("3.9.1", "3.12.0", None, False),
        ("3.12.0", "3.12.0", "3.12.0", True),
        ("3.17.1", None, "3.17.0", False),
        ("4.0.0", "3.16.0", "3.17.0", False),
        ("10.0.0", "9.0.0", None, True),
    ],
)
def test_exists_in_version(version: str, since: str | None, until: str | None, expected: bool) -> None:
    assert exists_in(version, since, until) is expected


def test_suffix_is_left_out() -> None:
    assert version_key("4.0.0rc1") == (4, 0, 0)
    assert version_key("4.1.dev3") == (4, 1)

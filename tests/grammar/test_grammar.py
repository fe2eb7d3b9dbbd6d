"""The grammar as an interface: paths, sections, families, laziness."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from composer.grammar import GRAMMAR, ElementType, Grammar
from composer.grammar.grammar import read_data


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


@pytest.mark.parametrize(
    "path", ["", "gem", "worldbody/mesh", "geom/", "mujoco/geom", "edge", "default/body"]
)
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
                assert attribute.refers.removeprefix("attached:") in GRAMMAR.namespaces, (
                    path,
                    attribute.name,
                )
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
    assert taking == {path for path in GRAMMAR.paths if GRAMMAR.element(path).default is not None} | {
        "actuator/plugin"
    }
    childclass = {path for path in GRAMMAR.paths if GRAMMAR.element(path).takes_childclass}
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
        "import sys; from composer.grammar import GRAMMAR; GRAMMAR.within('worldbody');"
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
                    "type", "length", "lengths", "keywords", "default", "required", "declares", "refers",
                    "refers_by", "folder", "angle", "in_default", "since", "until",
                }  # fmt: skip


def test_every_group_and_list_of_keywords_is_used() -> None:
    data = json.loads(read_data())
    tables = [*data["groups"].values(), *data["elements"].values()]
    rows = [row for entry in tables for row in entry.get("attributes", {}).values()]
    assert {row["keywords"] for row in rows if "keywords" in row} == set(data["keywords"])
    assert {group for entry in data["elements"].values() for group in entry.get("groups", ())} == set(
        data["groups"]
    )


def test_everything_is_explained_in_a_line() -> None:
    for path in GRAMMAR.paths:
        element = GRAMMAR.element(path)
        for what, doc in [
            (path, element.doc),
            *((f"{path}/{a.name}", a.doc) for a in element.attributes.values()),
        ]:
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
    assert (
        GRAMMAR.element("default/geom").attributes["pos"].doc == GRAMMAR.element("geom").attributes["pos"].doc
    )
    assert GRAMMAR.element("default/tendon").attributes["armature"].doc

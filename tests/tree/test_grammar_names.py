"""The names in the grammar against those MuJoCo prints."""

from __future__ import annotations

import re

import mujoco
import pytest
from mjcompose.tree.grammar import GRAMMAR, ElementType

VERSION = mujoco.__version__
ROW = re.compile(r"^( *)(\(world\))?(\w+) \(([!?*R])\)(.*)$")

Schema = dict[tuple[str, ...], tuple[str, set[str]]]


def printed() -> Schema:
    """Cardinality and attributes by path of tags, as `mj_printSchema` has them."""
    schema: Schema = {}
    path: list[str] = []
    for line in mujoco.mj_printSchema(False, True).splitlines():
        row = ROW.match(line)
        if row is None:
            schema[tuple(path)][1].update(line.split())
            continue
        path = [*path[: len(row[1]) // 3], row[3]]
        schema[tuple(path)] = (row[4], set(row[5].split()))
    return schema


def ours(version: str) -> Schema:
    """The same from the grammar. The printed row `body` stands for the world, frames and replicates too."""
    schema: Schema = {}

    def walk(element: ElementType, path: tuple[str, ...]) -> None:
        if element.tag == "worldbody":
            walk(element.children["body"], (*path[:-1], "body"))
            return
        names = {name for name, attribute in element.attributes.items() if attribute.exists_in(version)}
        count = {(1, 1): "!", (0, 1): "?", (0, None): "*"}[element.min_count, element.max_count]
        schema[path] = (count, names)
        for tag, child in element.children.items():
            if tag in ("frame", "replicate") or child is element or not child.exists_in(version):
                continue
            walk(child, (*path, tag))

    walk(GRAMMAR.root, ("mujoco",))
    return schema


def test_printed_schema_is_read_at_all() -> None:
    schema = printed()
    assert len(schema) > 150
    assert schema["mujoco", "body", "geom"][0] == "*"
    assert {"childclass", "mocap"} <= schema["mujoco", "body"][1]


def test_same_elements_and_attributes() -> None:
    theirs = printed()
    mine = ours(VERSION)
    assert set(mine) - set(theirs) == set()
    assert set(theirs) - set(mine) == set()
    for path, (_, names) in theirs.items():
        assert mine[path][1] == names, path


def test_same_cardinality() -> None:
    theirs = printed()
    for path, (count, _) in ours(VERSION).items():
        expected = theirs[path][0]
        assert count == ("*" if expected == "R" else expected), path


@pytest.mark.parametrize(
    ("version", "elements", "pairs"), [("3.12.0", 178, 1911), ("3.17.0", 179, 1944), ("4.0.0", 171, 1894)]
)
def test_known_sizes(version: str, elements: int, pairs: int) -> None:
    """What MuJoCo prints in those versions: how many rows, how many attributes of rows."""
    schema = ours(version)
    assert len(schema) == elements
    assert sum(len(names) for _, names in schema.values()) == pairs


@pytest.mark.parametrize(
    ("path", "name", "since", "until"),
    [
        ("joint", "springyield", "4.0.0", None),
        ("default/joint", "springyield", "4.0.0", None),
        ("default/tendon", "armature", "4.0.0", None),
        ("tendon/fixed", "armature", None, None),
        ("flex/contact", "internal", None, "3.14.0"),
        ("texture", "class", "3.17.0", None),
        ("frame", "massscale", "3.16.0", None),
    ],
)
def test_versions_of_attributes(path: str, name: str, since: str | None, until: str | None) -> None:
    attribute = GRAMMAR.element(path).attributes[name]
    assert (attribute.since, attribute.until) == (since, until)


def test_versions_of_elements() -> None:
    assert GRAMMAR.element("composite").until == "3.17.0"
    assert GRAMMAR.element("equality/flexvert").until == "3.17.0"
    assert GRAMMAR.element("default/texture").since == "3.17.0"


def test_versions_lie_in_what_the_grammar_covers() -> None:
    first, last = GRAMMAR.versions
    for path in GRAMMAR.paths:
        element = GRAMMAR.element(path)
        for item in (element, *element.attributes.values()):
            assert item.exists_in(first) or item.since is not None, path
            assert item.exists_in(last) or item.until is not None, path

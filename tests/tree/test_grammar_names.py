"""The names in the grammar against those MuJoCo prints."""

from __future__ import annotations

import json
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import pytest
from mjcompose.language.value import is_angular
from mjcompose.link import angles
from mjcompose.mjcf import mounting
from mjcompose.tools.importing.elements import plain
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.grammar import GRAMMAR, read_data

pytestmark = pytest.mark.since("3.12", "`schemas/mjcf.json` begins with 3.12")

PROGRAM = runpy.run_path(str(Path(__file__).parents[2] / ".ci" / "grammar_rows.py"))
VERSION = mujoco.__version__
TEXT = mujoco.mj_printSchema(False, True)
NEXT = "99.0.0"


def test_printed_schema_is_read_at_all() -> None:
    schema = PROGRAM["printed"](TEXT)
    assert len(schema) > 150
    assert schema["mujoco", "body", "geom"].occurs == "any"
    assert {"childclass", "mocap"} <= schema["mujoco", "body"].attributes


def test_the_grammar_has_what_the_installed_mujoco_reads() -> None:
    """If it fails, it lists the rows to add; `docs/contributing/new_mujoco.md` says what else to do."""
    assert PROGRAM["needed"]() == []


def needed(text: str, version: str = NEXT, grammar: Any = None) -> list[str]:
    """The rows for a version, without the first, which names the version."""
    first, *rows = PROGRAM["rows"](version, text, read_data() if grammar is None else json.dumps(grammar))
    assert first.startswith("`mujoco`: the grammar covers") and first.endswith(f'and not "{version}"')
    return rows


GEOM = "fluidcoef"
"""An attribute of geoms alone, which MuJoCo prints twice: in a class, then in a body."""


@pytest.mark.parametrize(
    ("before", "after", "rows"),
    [
        (f" {GEOM} ", f" {GEOM} glow ", ['`geom`: add "glow": {"type": "…", "since": "99.0.0"}']),
        (f" {GEOM} ", " ", [f'`geom`: add "until": "LAST" to the row of `{GEOM}`']),
        ("      flag (?) ", "      flag (*) ", ['`option/flag`: set "occurs": "any"']),
        (
            "   size (*) ",
            "   glow (*)                 red\n      ember (?)              heat\n   size (*) ",
            [
                (
                    '`elements`: add "glow": {"occurs": "any", "since": "99.0.0", "attributes": {"red": {"type": "…"}}}, '
                    'and "glow" to the children of `mujoco`'
                ),
                (
                    '`elements`: add "glow/ember": {"occurs": "optional", "since": "99.0.0", "attributes": {"heat": '
                    '{"type": "…"}}}, and "glow/ember" to the children of `glow`'
                ),
            ],
        ),
    ],
    ids=["attribute", "gone", "occurs", "elements"],
)
def test_rows_for_a_new_version(before: str, after: str, rows: list[str]) -> None:
    assert before in TEXT
    assert needed(TEXT.replace(before, after)) == [row.replace("LAST", GRAMMAR.versions[1]) for row in rows]


def test_a_row_says_where_a_class_differs() -> None:
    in_class, in_body, after = TEXT.split(f" {GEOM} ")
    new = f"{in_class} {GEOM} {in_body} {GEOM} glow {after}"
    assert needed(new) == ['`geom`: add "glow": {"type": "…", "since": "99.0.0", "in_default": false}']
    gone = f"{in_class} {in_body} {GEOM} {after}"
    assert needed(gone) == [f'`geom`: add "in_default": false to the row of `{GEOM}`']
    assert needed(TEXT) == []


def older(data: Any, version: str, before: str) -> Any:
    """The grammar as it was when the version `before` was the last one."""
    grammar = json.loads(json.dumps(data))
    grammar["mujoco"][1] = before
    elements = grammar["elements"]
    later = [path for path, element in elements.items() if element.get("since") == version]
    for path in later:
        del elements[path]
    for holder in (*elements.values(), *grammar["groups"].values()):
        attributes = holder.get("attributes", {})
        for name in [name for name, row in attributes.items() if row.get("since") == version]:
            del attributes[name]
        for row in (holder, *attributes.values()):
            if row.get("until") == before:
                del row["until"]
            if row.get("in_default") == version:
                row["in_default"] = False
        if "children" in holder:
            holder["children"] = [child for child in holder["children"] if child not in later]
    return grammar


def versions_in(data: Any) -> Iterator[str]:
    """What the rows of a grammar say of versions, a line each."""
    for kind in ("elements", "groups"):
        place = "group `{}`" if kind == "groups" else "`{}`"
        for path, holder in data[kind].items():
            at = place.format(path)
            if "until" in holder:
                yield f'{at}: "until": "{holder["until"]}"'
            for name, row in holder.get("attributes", {}).items():
                for key in ("since", "until", "in_default"):
                    if isinstance(row.get(key), str):
                        yield f'{at}: {name}: "{key}": "{row[key]}"'


@pytest.mark.mujoco4("4.0.0 is the last version")
def test_rows_bring_back_a_version_that_was_removed() -> None:
    """They are those that people wrote for 4.0.0."""
    data = json.loads(read_data())
    grammar = older(data, "4.0.0", "3.17.0")
    rows = needed(TEXT, "4.0.0", grammar)
    lost = set(versions_in(data)) - set(versions_in(grammar))
    assert len(rows) == len(lost) > 10
    for row in rows:
        place, _, change = row.partition(": add ")
        _, _, name = change.partition(" to the row of `")
        attribute = f": {name.rstrip('`')}" if name else ""
        if change.startswith('"') and '": {' in change:
            attribute = f": {change.split(chr(34))[1]}"
        assert any(line.startswith(f"{place}{attribute}: ") for line in lost), row


@pytest.mark.parametrize(
    ("version", "elements", "pairs"), [("3.12.0", 178, 1911), ("3.17.0", 179, 1944), ("4.0.0", 171, 1894)]
)
def test_known_sizes(version: str, elements: int, pairs: int) -> None:
    """What MuJoCo prints in those versions: how many rows, how many attributes of rows."""
    schema = PROGRAM["covered"](GRAMMAR, version)
    assert len(schema) == elements
    attributes = [attribute for element in schema.values() for attribute in element.attributes.values()]
    assert sum(attribute.exists_in(version) for attribute in attributes) == pairs


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


def test_the_lists_of_angles_agree() -> None:
    """`link/angles.py`, `mjcf/mounting.py` and `tools/importing/elements.py` have the angles that the grammar has."""
    attributes = GRAMMAR.element("joint").attributes.values()
    of_hinges = {attribute.name for attribute in attributes if is_angular(attribute, "hinge")}
    of_balls = {attribute.name for attribute in attributes if is_angular(attribute, "ball")}
    assert of_hinges == {attribute.name for attribute in attributes if attribute.angle == "joint"}
    assert set(angles._ANGULAR) == of_hinges and set(angles._OF_BALLS) == of_balls
    assert {kind: set(names) for kind, names in mounting._ANGULAR.items()} == {"hinge": of_hinges, "ball": of_balls}
    converted = plain(dict.fromkeys(of_hinges, "1"), "joint", SourceSettings(), degrees=False)
    assert {name for name, text in converted.items() if text != "1"} == of_hinges

"""What each version can read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree
from mjcompose.tools.migrate.changes import ORDERED
from mjcompose.tools.migrate.editing import later
from mjcompose.tools.migrate.migrate import bounds
from mjcompose.tree.history import RELEASED, place, release, spans, unread
from tools.migrate.survey import extended, history


def model(text: str) -> etree._Element:
    return etree.fromstring(f"<mujoco>{text}</mujoco>")


@pytest.mark.parametrize(
    ("text", "first", "last"),
    [
        ("<option mpr_iterations='1'/>", "3.0.0", "3.2.2"),
        ("<worldbody><frame/></worldbody>", "3.1.0", "4.0.0"),
        ("<worldbody><replicate count='2'/></worldbody>", "3.1.5", "4.0.0"),
        ("<worldbody><frame><body><camera orthographic='true'/></body></frame></worldbody>", "3.2.0", "3.4.0"),
        ("<worldbody><body><joint stiffness='1 2'/></body></worldbody>", "3.7.0", "4.0.0"),
        ("<worldbody><body><joint springyield='1'/></body></worldbody>", "4.0.0", "4.0.0"),
        ("<default><default class='a'><tendon armature='1'/></default></default>", "4.0.0", "4.0.0"),
        ("<option integrator='discrete'/>", "3.13.0", "4.0.0"),
        ("<worldbody><composite type='rope'/></worldbody>", "3.0.0", "3.2.5"),
    ],
)
def test_bounds(text: str, first: str, last: str) -> None:
    assert bounds(model(text)) == (first, last)


def test_a_model_of_no_version() -> None:
    assert bounds(model("<option mpr_iterations='1'><flag nativeccd='enable'/></option>")) == (None, None)


def test_places() -> None:
    root = model(
        "<worldbody><body><frame><geom/><body><site/></body></frame></body></worldbody>"
        "<default><default class='a'><geom/></default></default><option><flag/></option>"
    )
    found = [place(node) for node in root.iter("geom", "site", "flag", "frame")]
    assert found == ["frame", "body/geom", "body/site", "default/geom", "option/flag"]


def test_what_is_unread_is_told_with_its_versions() -> None:
    (found,) = unread(model("<worldbody><composite/></worldbody>"), "4.0.0")
    assert (found.called, found.when()) == ("`<composite>`", "MuJoCo had it up to 3.17.0")


def test_the_history_knows_the_releases() -> None:
    versions = {each for span in spans().values() for each in span if each is not None}
    assert versions <= set(RELEASED)
    assert release("3") == "3.17.0" and release("4.1") is None and release("x") is None
    assert later("3.10.0", "3.9.0")


def test_a_new_version_needs_the_schemas_of_the_last_two_alone() -> None:
    earlier = {"geom": {"size", "old"}, "lamp": {"glow"}}
    later = {"geom": {"size", "new"}, "sun": {"glow", "heat"}}
    known = {"geom@old": ["3.5.0", None], "lamp": ["3.2.0", None], "geom@older": [None, "3.1.0"]}
    assert extended(known, {"3.9.0": earlier, "3.10.0": later})["spans"] == {
        "geom@new": ["3.10.0", None],
        "geom@old": ["3.5.0", "3.9.0"],
        "geom@older": [None, "3.1.0"],
        "lamp": ["3.2.0", "3.9.0"],
        "sun": ["3.10.0", None],
    }
    whole = history({"3.4.0": {"geom": {"size"}}, "3.9.0": earlier, "3.10.0": later})["spans"]
    first = history({"3.4.0": {"geom": {"size"}}, "3.9.0": earlier})["spans"]
    assert extended(first, {"3.9.0": earlier, "3.10.0": later})["spans"] == whole
    with pytest.raises(AssertionError, match=r"\['geom@older'\] came back"):
        extended(known, {"3.9.0": earlier, "3.10.0": {**later, "geom": {"size", "older"}}})


def test_the_page_describes_every_change() -> None:
    text = (Path(__file__).parents[3] / "docs" / "how-to" / "upgrade_mujoco.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([\d.]+) \| `([a-z0-9-]+)` \|.*\| (yes|–) \|$", text, re.MULTILINE)
    expected = [(each.version.removesuffix(".0"), each.name, "yes" if each.acts[1] else "–") for each in ORDERED]
    assert rows == expected

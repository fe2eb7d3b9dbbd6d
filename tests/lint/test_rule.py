from __future__ import annotations

import json
import runpy
from dataclasses import asdict
from pathlib import Path

import pytest
from lxml import etree
from mjcompose.base.codes import BY_TOPIC, page
from mjcompose.lint.rule import FAMILIES, ElementEdit, Finding, PlacedFinding, UnknownRuleError, chosen, rules

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "rules"


@pytest.mark.parametrize("code", sorted(rules()))
def test_every_rule_has_a_page(code: str) -> None:
    each = rules()[code]
    text = page(code)
    assert text.startswith(f"# {code}\n\n{each.summary}.\n")
    assert len(each.summary) < 100
    assert len(text.split()) > 25, "say why it matters and what to write"
    assert all(f"Profile `{name}`: {source}" in text for name, source in each.profiles.items())
    assert not any(code in codes for codes in BY_TOPIC.values())


def test_rules_are_chosen_by_code_family_and_profile() -> None:
    assert [each.code for each in chosen(["unused-class"])] == ["unused-class"]
    assert {each.family for each in chosen(["dead"])} == {"dead"}
    assert {each.code for each in chosen(["all"])} == set(rules())
    assert "unused-class" not in {each.code for each in chosen((), ["unused-class"])}
    with pytest.raises(UnknownRuleError, match="unused-clas"):
        chosen(["unused-clas"])


def test_families_are_those_of_the_rules() -> None:
    assert {each.family for each in rules().values()} <= set(FAMILIES)


def test_the_index_is_current() -> None:
    index = runpy.run_path(str(ROOT / ".ci" / "rule_index.py"))["index"]
    assert (PAGES / "index.md").read_text(encoding="utf-8") == index(), "run `make schemas`"
    assert {each.stem for each in PAGES.glob("*.md")} == {"index", *rules()}


def test_a_finding_of_the_child_process_comes_back_whole() -> None:
    root = etree.fromstring('<mujoco><worldbody><geom name="g"/></worldbody></mujoco>')
    edit = ElementEdit((("mass", None), ("name", "h")))
    sent = PlacedFinding("code", 2, "a message", "mass", help="help", edit=edit)
    received = PlacedFinding.of(json.loads(json.dumps(asdict(sent))))
    assert received == sent
    finding = received.finding(list(root.iter("*")))
    assert finding == Finding(root[0][0], "a message", "mass", help="help", edit=edit)

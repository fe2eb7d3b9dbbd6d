from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.base.codes import BY_TOPIC, page
from mjcompose.build.lint.pages import pages
from mjcompose.build.lint.rule import FAMILIES, UnknownRuleError, chosen, rules

PAGES = Path(__file__).parents[3] / "docs" / "rules"


@pytest.mark.parametrize("code", sorted(rules()))
def test_every_rule_has_a_page(code: str) -> None:
    each = rules()[code]
    assert each.summary and len(each.summary) < 100
    assert len(each.page.split()) > 25, "say why it matters and what to write"
    assert page(code).startswith(f"# {code}\n")
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


def test_the_pages_are_those_of_the_rules() -> None:
    written = {each.name: each.read_text(encoding="utf-8") for each in PAGES.glob("*.md")}
    assert written == pages(), "run `make schemas`"

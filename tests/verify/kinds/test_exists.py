from __future__ import annotations

import pytest


@pytest.mark.parametrize(
    ("selectors", "prefix"),
    [
        ('[{site: "**/tcp"}]', ""),
        ('[{site: "**/tcp"}, {key: home}, {actuator: "left/*"}]', ""),
        ('[{site: tcp}, {site: "**/tcp"}]', "left/"),
        ('[{body: "*/base", expect: 2}]', ""),
        ('[{geom: "**", expect: 6}, {geom: "*/*", expect: 2}]', ""),
        ('[{geom: "**", expect: 3}]', "left/"),
        ("[{mesh: any, expect: 0}]", ""),
        ('[{site: "**", in: {body: "*/base"}, expect: 1}, {geom: "**", in: {body: world}, expect: 6}]', ""),
        (
            '[{body: "**", parent: {body: base}, expect: 1}, {site: "**", in: {body: base}, expect: 1}]',
            "left/",
        ),
        ('[{joint: "**", parent: {body: "*/base"}, expect: 0}]', ""),
    ],
)
def test_holds(ask, arm: str, selectors: str, prefix: str) -> None:
    assert ask(arm, f"exists: {selectors}", prefix=prefix) == []


def test_keyframes_of_a_nested_recipe_are_called_as_its_policy_says(ask, arm: str) -> None:
    assert ask(arm, "exists: [{key: home}]", prefix="left/") == []
    assert ask(arm, "exists: [{key: low}]", prefix="left/", keys="left/") == []
    assert len(ask(arm, "exists: [{key: home}]", prefix="left/", keys=None)) == 1


def test_nothing_of_that_name(ask, arm: str) -> None:
    (finding,) = ask(arm, "exists: [{site: left/tcp}, {site: lft/tcp}]")
    assert finding.at == (1, "site")
    assert finding.message == "there is no site `lft/tcp`"
    assert finding.notes == ("expected: at least one", "actual: 0", "sites that exist: left/tcp")
    assert finding.help == "did you mean `left/tcp`?"


def test_another_number(ask, arm: str) -> None:
    (finding,) = ask(arm, 'exists: [{body: "*/base", expect: 3}]')
    assert finding.message == "`*/base` names 2 elements `body`, not 3"
    assert finding.notes == ("expected: 3", "actual: 2", "they are: left/base, right/base")


def test_what_is_of_another_part_is_not_found(ask, arm: str) -> None:
    (finding,) = ask(arm, "exists: [{body: base}, {site: tcp}]", prefix="right/")
    assert finding.at == (1, "site")


def test_nothing_of_that_name_there(ask, arm: str) -> None:
    (finding,) = ask(arm, 'exists: [{site: "**/tcp", in: {body: right/base}}]')
    assert finding.message == "there is no site `**/tcp` in a body `right/base`"

from __future__ import annotations

from collections.abc import Callable

import pytest

from composer.diagnostics import Diagnostic
from composer.recipe import Element, Recipe


def test_targets(recipe: Callable[[str], Recipe]) -> None:
    add = recipe(
        """
        add:
          - {to: world, body: {name: a}}
          - {to: a, site: {}}
          - {to: {frame: f}, geom: {size: 1}}
        """
    ).add
    assert [(each.to_kind, each.to, each.element.tag, each.at) for each in add] == [
        ("world", "world", "body", ("add", 0)),
        ("body", "a", "site", ("add", 1)),
        ("frame", "f", "geom", ("add", 2)),
    ]


def test_children_keep_the_order_of_the_file(recipe: Callable[[str], Recipe]) -> None:
    (added,) = recipe(
        """
        add:
          - to: world
            body:
              geom: [{name: a, size: 1}, {name: b, size: 1}]
              inertial: {pos: [0, 0, 0], mass: 1}
              body: [{name: inner, freejoint: {}}]
        """
    ).add
    assert [child.tag for child in added.element.children] == ["geom", "geom", "inertial", "body"]
    assert added.element.children[1].at == ("add", 0, "body", "geom", 1)
    assert added.element.children[3].children == (
        Element("freejoint", at=("add", 0, "body", "body", 0, "freejoint")),
    )


def test_fragment(recipe: Callable[[str], Recipe]) -> None:
    (added,) = recipe("add: [{to: hand, xml: '<site name=\"tcp\"/>'}]").add
    assert added.element == Element("site", xml='<site name="tcp"/>', at=("add", 0))


def test_plugin_with_settings(recipe: Callable[[str], Recipe]) -> None:
    text = "add: [{to: a, plugin: {plugin: p, config: {n: 3, on: true, v: [1, 2.5], t: x}}}]"
    (added,) = recipe(text).add
    settings = {child.attributes["key"]: child.attributes["value"] for child in added.element.children}
    assert settings == {"n": "3", "on": "true", "v": "1 2.5", "t": "x"}


@pytest.mark.parametrize(
    ("entry", "code"),
    [
        ("{to: hand}", "missing-key"),
        ("{site: {}}", "missing-key"),
        ("{to: 3, site: {}}", "wrong-type"),
        ("{to: {site: a}, site: {}}", "wrong-type"),
        ("{to: world, freejoint: {}}", "unknown-element"),
        ("{to: hand, sensor: {}}", "unknown-element"),
        ("{to: hand, site: {}, geom: {}}", "wrong-type"),
        ("{to: hand, site: [{}, {}]}", "wrong-type"),
        ("{to: hand, site: tcp}", "wrong-type"),
        ("{to: hand, inertial: {}}", "missing-key"),
        (
            "{to: hand, body: {inertial: [{mass: 1, pos: [0, 0, 0]}, {mass: 1, pos: [0, 0, 0]}]}}",
            "wrong-length",
        ),
        ("hand", "wrong-type"),
    ],
)
def test_wrong_entry(faults: Callable[[str], list[Diagnostic]], entry: str, code: str) -> None:
    assert " ".join(sorted(fault.code for fault in faults(f"add: [{entry}]"))) == code

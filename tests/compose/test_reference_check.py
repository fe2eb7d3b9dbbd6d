from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

Compose = Callable[..., Any]
HEAD = "recipe: 1\nbase: ./robot.xml\n"


def test_elements_may_refer_to_later_ones(compose: Compose) -> None:
    model = compose(
        f"{HEAD}sensor: {{s: {{type: tendonpos, tendon: t}}}}\nactuator: {{a: {{type: motor, tendon: t}}}}\n"
        "tendon: {t: {type: fixed, path: [{joint: hinge, coef: 1}]}}\nadd: [{to: base, geom: {size: [1], material: m}}]\n"
        "asset: {material: {m: {rgba: [1, 1, 1, 1]}}}\n"
    )
    assert not isinstance(model, list)


@pytest.mark.parametrize(
    ("section", "place"),
    [
        ("sensor: {s: {type: jointpos, joint: x}}", "3:37"),
        ("sensor: {s: {type: framepos, objtype: site, objname: flange, reftype: body, refname: x}}", "3:86"),
        ("contact: {exclude: [{body1: base, body2: x}]}", "3:42"),
        ("default: {c: {geom: {material: x}}}", "3:32"),
        ("default: {c: {parent: x}}", "3:23"),
        ("asset: {material: {m: {texture: x}}}", "3:33"),
        ("equality: {e: {type: joint, joint1: x}}", "3:37"),
        ("add: [{to: base, light: {mode: targetbody, target: x}}]", "3:52"),
        ("add: [{to: base, body: {childclass: x}}]", "3:37"),
    ],
)
def test_every_reference_is_looked_up(compose: Compose, section: str, place: str) -> None:
    assert compose(f"{HEAD}{section}\n") == [f"{place} unknown-name"]


def test_a_class_that_is_there_is_checked_too(compose: Compose) -> None:
    classes = (
        '<mujoco><default><default class="c"><geom rgba="1 1 1 1"/></default></default>'
        '<worldbody><geom size="1"/></worldbody></mujoco>'
    )
    text = "recipe: 1\nbase: ./classes.xml\ndefault: {c: {geom: {material: x}}}\n"
    assert compose(text, classes__xml=classes) == ["3:32 unknown-name"]


def test_the_world_and_the_top_class_are_always_there(compose: Compose) -> None:
    model = compose(
        f"{HEAD}contact: {{exclude: [{{body1: world, body2: base}}]}}\n"
        "sensor: {s: {type: framepos, objtype: body, objname: world}}\nadd: [{to: base, geom: {size: [1], class: main}}]\n"
    )
    assert not isinstance(model, list)


def test_names_of_what_mujoco_makes_are_let_through(compose: Compose) -> None:
    add = "add: [{to: base, replicate: {count: 3, offset: [1, 0, 0], site: {name: s}}}]\n"
    sensor = "sensor: {{s: {{type: touch, site: {}}}}}\n"
    assert not isinstance(compose(HEAD + add + sensor.format("s2")), list)
    assert compose(HEAD + add + sensor.format("x")) == ["4:33 unknown-name"]


def test_a_lost_place_is_one_fault(compose: Compose) -> None:
    """What would have been added counts as there."""
    assert compose(
        f"{HEAD}add: [{{to: bass, site: {{name: s}}}}]\nsensor: {{s: {{type: touch, site: s}}}}\n"
    ) == ["3:12 unknown-name"]
    assert compose(
        f"{HEAD}default: {{c: {{parent: d}}}}\nadd: [{{to: base, geom: {{size: [1], class: c}}}}]\n"
    ) == ["3:23 unknown-name"]


def test_one_name_in_two_namespaces_is_no_clash(compose: Compose) -> None:
    assert not isinstance(
        compose(f"{HEAD}add: [{{to: base, site: {{name: base}}}}, {{to: base, site: {{name: geom}}}}]\n"),
        list,
    )
    assert compose(f"{HEAD}add: [{{to: base, site: {{name: flange}}}}]\n") == ["3:31 name-clash"]
    assert compose(
        f"{HEAD}add: [{{to: world, frame: {{name: f}}}}, {{to: world, frame: {{name: f}}}}]\n"
    ) == ["3:64 name-clash"]

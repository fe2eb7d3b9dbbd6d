from __future__ import annotations

from typing import Any

import pytest
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.merge import Path, is_appended, is_edits, is_of_elements, merge
from mjcompose.text.node import Mapping, locate, to_python


def tree(text: str, file: str) -> Mapping:
    node = load(text, file, Sink())
    assert isinstance(node, Mapping)
    return node


def merged(lower: str, upper: str) -> Any:
    sink = Sink()
    found = to_python(merge(tree(lower, "lower.yaml"), tree(upper, "upper.yaml"), sink))
    assert not sink.has_errors
    return found


@pytest.mark.parametrize(
    ("lower", "upper", "expected"),
    [
        ("{a: 1, b: {c: 2}}", "{b: {d: 3}}", {"a": 1, "b": {"c": 2, "d": 3}}),
        ("{a: [1, 2]}", "{a: [3]}", {"a": [3]}),
        ("{a: 1, b: 2}", "{a: null}", {"b": 2}),
        ("add: [{to: world}]", "add: [{to: hand}]", {"add": [{"to": "world"}, {"to": "hand"}]}),
        (
            "edit: [{id: x, set: 1}, {id: y, set: 2}]",
            "edit: [{id: x, set: 3}, {id: z, set: 4}]",
            {"edit": [{"id": "x", "set": 3}, {"id": "y", "set": 2}, {"id": "z", "set": 4}]},
        ),
        ("attach: {a: {edit: [1]}}", "attach: {a: {edit: [2]}}", {"attach": {"a": {"edit": [1, 2]}}}),
        ("sensor: {add: {type: a, b: [1]}}", "sensor: {add: {b: [2]}}", {"sensor": {"add": {"type": "a", "b": [2]}}}),
        (
            "attach: {a: {model: m, site: s, euler: [1, 2, 3]}}",
            "attach: {a: {body: b, quat: [1, 0, 0, 0]}}",
            {"attach": {"a": {"model": "m", "body": "b", "quat": [1, 0, 0, 0]}}},
        ),
        (
            "attach: {a: {model: m, mate: t, with: {x: 1}, edit: [1], site: s}}",
            "attach: {a: {model: n, edit: [2]}}",
            {"attach": {"a": {"model": "n", "edit": [2], "site": "s"}}},
        ),
        ("attach: {a: {model: m, mate: t}}", "attach: {a: {model: m}}", {"attach": {"a": {"model": "m", "mate": "t"}}}),
        ("sensor: {s: {type: touch, site: a}}", "sensor: {s: {type: gyro}}", {"sensor": {"s": {"type": "gyro"}}}),
        (
            "sensor: {s: {type: touch, site: a}}",
            "sensor: {s: {type: touch, noise: 1}}",
            {"sensor": {"s": {"type": "touch", "site": "a", "noise": 1}}},
        ),
        (
            "actuator: {m: {type: motor, site: a, refsite: b}}",
            "actuator: {m: {joint: j}}",
            {"actuator": {"m": {"type": "motor", "joint": "j"}}},
        ),
        ("params: {x: {default: 1, min: 0}}", "params: {x: 2}", {"params": {"x": {"default": 2, "min": 0}}}),
        ("params: {x: 1}", "params: {x: {max: 3}}", {"params": {"x": {"default": 1, "max": 3}}}),
        ("base: m", "base: {drop: [key]}", {"base": {"model": "m", "drop": ["key"]}}),
        (
            "variants: {g: {a: {add: [1]}}}",
            "variants: {g: {a: {add: [2]}, b: {}}}",
            {"variants": {"g": {"a": {"add": [1, 2]}, "b": {}}}},
        ),
        (
            "randomize: {fields: {f: {select: {geom: g}, attr: mass, scale: {uniform: [1, 2]}}}}",
            "randomize: {fields: {f: {uniform: [3, 4]}}}",
            {"randomize": {"fields": {"f": {"select": {"geom": "g"}, "attr": "mass", "uniform": [3, 4]}}}},
        ),
    ],
)
def test_merge(lower: str, upper: str, expected: Any) -> None:
    assert merged(lower, upper) == expected


@pytest.mark.parametrize("place", ["params: {t: {default: {a: ROW}}}", "attach: {p: {with: {t: {a: ROW}}}}"])
def test_a_row_of_a_table_keeps_columns_that_are_called_like_alternatives(place: str) -> None:
    lower, upper = (place.replace("ROW", row) for row in ("{euler: [0, 0, 1], x: 1}", "{quat: [1, 0, 0, 0]}"))
    assert "{'euler': [0, 0, 1], 'x': 1, 'quat': [1, 0, 0, 0]}" in repr(merged(lower, upper))


def test_every_value_keeps_its_place() -> None:
    found = merge(
        tree("option:\n  timestep: 1\n  cone: elliptic\n", "lower.yaml"),
        tree("option: {timestep: 2}\n", "upper.yaml"),
        Sink(),
    )
    assert str(locate(found, ("option", "cone"))) == "lower.yaml:3:9"
    assert str(locate(found, ("option", "timestep"))) == "upper.yaml:1:20"


def test_null_that_deletes_nothing() -> None:
    sink = Sink()
    merge(tree("{sensor: {grip: 1}}", "lower.yaml"), tree("{sensor: {gripp: null}}", "upper.yaml"), sink)
    (error,) = sink.errors
    assert (error.code, error.message) == ("unknown-key", "`gripp` does not exist and cannot be removed")
    assert str(error.span) == "upper.yaml:1:11" and error.help == "did you mean `grip: null`?"


def test_nothing_is_changed_in_place() -> None:
    lower = tree("{a: {b: 1}, add: [1]}", "lower.yaml")
    before = to_python(lower)
    merge(lower, tree("{a: {b: 2}, add: [2]}", "upper.yaml"), Sink())
    assert to_python(lower) == before


def test_an_id_that_two_items_have() -> None:
    sink = Sink()
    lower = "{add: [{id: a}]}"
    upper = "{add: [{id: a, to: b}, {id: a, to: c}, {id: b}]}"
    merge(tree(lower, "lower.yaml"), tree(upper, "upper.yaml"), sink)
    (error,) = sink.errors
    assert (error.code, str(error.span)) == ("name-clash", "upper.yaml:1:29")


def test_what_replaces_an_element_stands_where_it_is_written() -> None:
    lower = tree("sensor: {x: {type: force, site: a}, y: {type: force, site: a}}", "lower.yaml")
    upper = tree("sensor: {x: {type: torque}, y: {site: b}}", "upper.yaml")
    found = merge(lower, upper, Sink())
    assert str(locate(found, ("sensor", "x"), key=True)) == "upper.yaml:1:10"
    assert str(locate(found, ("sensor", "y"), key=True)).startswith("lower.yaml")


@pytest.mark.parametrize("path", [("edit",), ("base", "edit"), ("attach", "arm", "edit"), ("attach", "edit", "edit")])
def test_lists_of_edits(path: Path) -> None:
    assert is_edits(path) and is_appended(path) and not is_of_elements(path)
    assert is_of_elements((*path, 0, "set", "mass")) and not is_edits((*path, 0))


@pytest.mark.parametrize(
    "path",
    [
        (),
        ("base",),
        ("attach", "edit"),
        ("sensor", "edit"),
        ("sensor", "edit", "edit"),
        ("option", "edit"),
        ("base", "with", "edit"),
        ("attach", "arm", "with", "edit"),
        ("asset", "mesh", "edit"),
    ],
)
def test_what_is_only_called_so(path: Path) -> None:
    assert not is_edits(path) and not is_appended(path) and not is_of_elements(path)


@pytest.mark.parametrize(
    ("path", "is_where"),
    [
        (("base", "drop", 0, "where", "mass"), True),
        (("attach", "arm", "drop", 0, "parent", "where"), True),
        (("check", "have", "exists", 0, "where"), True),
        (("randomize", "fields", "mass", "select", "where"), True),
        (("check", "where", "mass", "range"), False),
        (("sensor", "where", "noise"), False),
        (("attach", "where", "pos"), False),
        (("attach", "arm", "with", "where"), False),
        (("randomize", "fields", "where", "uniform"), False),
    ],
)
def test_what_a_selector_compares(path: Path, is_where: bool) -> None:
    assert is_of_elements(path) is is_where

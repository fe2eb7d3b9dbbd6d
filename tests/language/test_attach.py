from __future__ import annotations

from collections.abc import Callable

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.limits import Limits
from mjcompose.language.attach import Attachment
from mjcompose.language.recipe import Recipe
from mjcompose.language.value import RecipeElement
from mjcompose.text.expression import Angle
from pydantic import ValidationError


def test_order_and_defaults(recipe: Callable[[str], Recipe]) -> None:
    read = recipe("attach: {b: {model: ./b.xml}, a: {model: ./a.xml}}")
    assert list(read.attach) == ["b", "a"]
    part = read.attach["b"]
    assert (part.model, part.site, part.joint, part.prefix, part.key_policy) == ("./b.xml", None, None, None, "merge")


def test_place_and_offset(recipe: Callable[[str], Recipe]) -> None:
    text = "attach: {a: {model: m, frame: f, mate: tip, pos: [1, 2, 3.5], euler: [0, 90deg, 1rad], prefix: ''}}"
    part = recipe(text).attach["a"]
    assert (part.frame, part.mate, part.prefix) == ("f", "tip", "")
    assert part.pos == (1, 2, 3.5)
    assert part.euler == (0, Angle(90.0, "deg"), Angle(1.0, "rad"))


@pytest.mark.parametrize("word", ["none", "free", "ball", "mocap"])
def test_joint_word(recipe: Callable[[str], Recipe], word: str) -> None:
    assert recipe(f"attach: {{a: {{model: m, joint: {word}}}}}").attach["a"].joint == word


def test_joint_without_a_name_is_one_element(recipe: Callable[[str], Recipe]) -> None:
    joint = recipe("attach: {a: {model: m, joint: {type: slide, axis: [1, 0, 0], range: [0, 2]}}}").attach["a"].joint
    assert joint == RecipeElement(
        "joint", {"type": "slide", "axis": (1, 0, 0), "range": (0, 2)}, at=("attach", "a", "joint")
    )


def test_joints_with_names_are_a_tuple(recipe: Callable[[str], Recipe]) -> None:
    for text in ("{name: x, type: slide}", "[{name: x, type: slide}]"):
        joint = recipe(f"attach: {{a: {{model: m, joint: {text}}}}}").attach["a"].joint
        assert isinstance(joint, tuple)
        assert [each.attributes["name"] for each in joint] == ["x"]


@pytest.mark.parametrize(
    ("joint", "code"),
    [
        ("fre", "wrong-keyword"),
        ("3", "wrong-type"),
        ("[]", "wrong-length"),
        ("[weld]", "wrong-type"),
        ("[{type: hinge}]", "missing-key"),
        ("{type: free}", "wrong-keyword"),
        ("{type: spin}", "wrong-keyword"),
        ("{name: ''}", "bad-name"),
        ("{range: [0, 90]}", "bare-angle"),
        ("{type: ball, range: [0, 90]}", "bare-angle"),
        ("[{name: a}, {name: a}]", "name-clash"),
    ],
)
def test_wrong_joint(faults: Callable[[str], list[Diagnostic]], joint: str, code: str) -> None:
    assert [fault.code for fault in faults(f"attach: {{a: {{model: m, joint: {joint}}}}}")] == [code]


def test_type_of_a_joint_in_a_class_is_not_guessed(recipe: Callable[[str], Recipe]) -> None:
    recipe("attach: {a: {model: m, joint: {class: axis, range: [0, 0.4]}}}")


@pytest.mark.parametrize(
    ("part", "code"),
    [
        ("{}", "missing-key"),
        ("{model: ''}", "wrong-type"),
        ("{model: m, site: a, frame: b}", "wrong-type"),
        ("{model: m, quat: [1, 0, 0, 0], zaxis: [0, 0, 1]}", "wrong-type"),
        ("{model: m, pos: 0}", "wrong-length"),
        ("{model: m, euler: [0, 0, 90]}", "bare-angle"),
        ("{model: m, axisangle: [0, 0, 1, 90]}", "bare-angle"),
        ("{model: m, prefix: base}", "reserved-prefix"),
        ("{model: m, prefix: a/b}", "bad-name"),
        ("{model: m, prefix: 3}", "wrong-type"),
        ("{model: m, keys: all}", "wrong-keyword"),
        ("{model: m, with: [reach]}", "wrong-type"),
        ("{model: m, color: red}", "unknown-key"),
    ],
)
def test_wrong_part(faults: Callable[[str], list[Diagnostic]], part: str, code: str) -> None:
    assert [fault.code for fault in faults(f"attach: {{a: {part}}}")] == [code]


def test_prefix_and_separator(recipe: Callable[[str], Recipe], faults: Callable[[str], list[Diagnostic]]) -> None:
    assert list(recipe("attach: {left_arm: {model: m}}").attach) == ["left_arm"]
    assert list(recipe("separator: _\nattach: {left_arm: {model: m}}").attach) == ["left_arm"]
    (fault,) = faults('separator: ":"\nattach: {"left:arm": {model: m}}')
    assert fault.code == "bad-name"
    assert fault.span is not None
    assert (fault.span.line, fault.span.column) == (3, 10)


MAX_COPIES = Limits().copies


def test_read() -> None:
    attachment = Attachment.model_validate(
        {"model": "m", "replicate": [{"count": 2, "offset": [1, 0, 0]}, {"count": 3, "euler": [0, "9deg", 0]}]}
    )
    axes = [(axis.count, axis.offset, axis.euler) for axis in attachment.replicate]
    assert axes == [(2, (1, 0, 0), (0, 0, 0)), (3, (0, 0, 0), (0, Angle(9.0, "deg"), 0))]


@pytest.mark.parametrize(("count", "allowed"), [(MAX_COPIES, True), (MAX_COPIES + 1, False)])
def test_not_without_end(count: int, allowed: bool) -> None:
    data = {"model": "m", "replicate": [{"count": count}]}
    if allowed:
        assert Attachment.model_validate(data).replicate[0].count == count
    else:
        with pytest.raises(ValidationError):
            Attachment.model_validate(data)

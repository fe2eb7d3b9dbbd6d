"""One mistake is one fault, with its place, what exists, and a line to paste."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

import pytest
from mjcompose.base.diagnostic import Fault
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import IT, Bars, Belongs, Exclusive, Model, Needs, OneOf
from mjcompose.language.forms.scalars import (
    Count,
    Expects,
    Hints,
    Items,
    Measure,
    Name,
    NotNegative,
    NumberUnit,
    Positive,
    Range,
)
from mjcompose.language.forms.translate import faults
from mjcompose.text.expression import Angle
from pydantic import Field, ValidationError


class Grip(Model):
    """A grip."""

    short: ClassVar = "pad"
    example: ClassVar = "{pad: …}"

    pad: Annotated[str, Name("geom")] = Field(examples=["NAME"])
    """what it touches with"""
    force: Annotated[Positive, NumberUnit("N")] = 1.0
    """how hard"""


class Arm(Model):
    """An arm of a robot."""

    rules: ClassVar = (Exclusive("mass", "range"), Belongs("tol", "mass"), Bars("rope", "grip", why="hangs on a rope"))
    instead: ClassVar = {"weight": "mass", "pay": "write `mass: …`, which is what it carries"}

    mass: Annotated[NotNegative, NumberUnit("kg")] | None = None
    """what it carries"""
    range: Annotated[Range, NumberUnit("kg")] | None = None
    """what it may carry"""
    tol: float | None = None
    """how much more"""
    turn: Annotated[float | Angle, Measure()] | None = None
    """its angle"""
    copies: Count = 1
    """how many"""
    kind: Annotated[Literal["left", "right"], Hints({"port": "left", "both": "write two arms"})] = "left"
    """which side"""
    is_on: bool = False
    """whether it runs"""
    near: Annotated[tuple[Annotated[str, Name("geom", glob=True)], ...], Items(1, single=True, unique=True)] = ()
    """what is near"""
    grip: Grip | None = None
    """what it holds with"""
    grips: dict[str, Grip] | None = None
    """more of them, by name"""
    rope: Annotated[str, Name("tendon")] | None = None
    """what it hangs on"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if self.is_on and self.copies == 0:
            yield Fault("out-of-range", f"{IT} is on and has no copy", ("copies",))


class Choice(Model):
    """One of two."""

    rules: ClassVar = (
        OneOf("arm", "leg", lacks="has no limb", advice="write `arm: {}`", unless="none", noun="limb"),
        Belongs("toe", "leg"),
        Needs({"name": "x", "size": "1"}, unless=("extends",)),
    )

    arm: Arm | None = None
    """an arm"""
    leg: int | None = None
    """a leg"""
    toe: bool | None = None
    """whether the leg has a toe"""
    none: bool | None = None
    """nothing"""
    name: str | None = None
    """its name"""
    size: float | None = None
    """its size"""
    extends: str | None = None
    """another"""


def told(model: Any, data: Any) -> list[Fault]:
    try:
        model.model_validate(data)
    except ValidationError as error:
        return list(faults(error, model, data, start=("robot",)))
    return []


@pytest.mark.parametrize(
    ("data", "code", "message", "at", "help"),
    [
        (
            {"mass": "5g"},
            "wrong-type",
            "`mass` of `robot` expects a number, got text `5g`",
            ("mass",),
            "write `0.005`: numbers have no unit but `deg` and `rad`, kilograms are usual",
        ),
        ({"mass": -1}, "out-of-range", "`mass` of `robot` is -1, and must be at least 0", ("mass",), None),
        ({"mass": True}, "wrong-type", "`mass` of `robot` expects a number, got a boolean `true`", ("mass",), None),
        (
            {"mass": float("inf")},
            "wrong-type",
            "`mass` of `robot` expects a finite number, got a number `inf`",
            ("mass",),
            None,
        ),
        ({"mas": 1}, "unknown-key", "`robot` has no key `mas`", ("mas",), "write `mass`"),
        ({"weight": 1}, "unknown-key", "`robot` has no key `weight`", ("weight",), "write `mass`"),
        ({"pay": 1}, "unknown-key", "`robot` has no key `pay`", ("pay",), "write `mass: …`, which is what it carries"),
        (
            {"mass": 1, "range": [1, 2]},
            "wrong-type",
            "`robot` has both `mass` and `range`, of which only one is allowed",
            ("range",),
            "leave `mass` or `range` out",
        ),
        (
            {"tol": 1},
            "unknown-key",
            "`tol` of `robot` belongs to `mass`",
            ("tol",),
            "write `mass` next to it, or omit `tol` out",
        ),
        (
            {"rope": "r", "grip": "p"},
            "wrong-type",
            "`robot` hangs on a rope, and has `grip` as well",
            ("grip",),
            "leave `rope` or `grip` out",
        ),
        (
            {"range": [2, 1]},
            "out-of-range",
            "`range` of `robot` starts with 2, which is more than 1",
            ("range",),
            "write `range: [1, 2]`",
        ),
        (
            {"range": [1]},
            "wrong-length",
            "`range` of `robot` expects a list of 2 numbers, got 1",
            ("range",),
            "write for instance `range: [LOW, HIGH]`",
        ),
        ({"range": [1, "a"]}, "wrong-type", "`range` of `robot` expects a number, got text `a`", ("range", 1), None),
        ({"range": ["a"]}, "wrong-type", "`range` of `robot` expects a number, got text `a`", ("range", 0), None),
        ({"turn": "90"}, "wrong-type", "`turn` of `robot` expects a number, got text `90`", ("turn",), None),
        (
            {"copies": 1.5},
            "wrong-type",
            "`copies` of `robot` expects a whole number, got a number `1.5`",
            ("copies",),
            None,
        ),
        ({"kind": "lef"}, "wrong-keyword", "`kind` of `robot` cannot be `lef`", ("kind",), "write `kind: left`"),
        ({"kind": "port"}, "wrong-keyword", "`kind` of `robot` cannot be `port`", ("kind",), "write `kind: left`"),
        ({"kind": "both"}, "wrong-keyword", "`kind` of `robot` cannot be `both`", ("kind",), "write two arms"),
        ({"kind": 1}, "wrong-type", "`kind` of `robot` expects `left` or `right`, got a number `1`", ("kind",), None),
        (
            {"is_on": 1},
            "wrong-type",
            "`is_on` of `robot` expects `true` or `false`, got a number `1`",
            ("is_on",),
            None,
        ),
        ({"near": []}, "wrong-type", "`near` of `robot` expects at least 1, got an empty list", ("near",), None),
        ({"near": ["a", "a"]}, "name-clash", "`a` is in `near` of `robot` twice", ("near", 1), "take one out"),
        (
            {"near": 3},
            "wrong-type",
            "`near` of `robot` expects a glob over names: a geom, got a number `3`",
            ("near",),
            "quote it: '3'",
        ),
        ({"near": ["a", "{b"]}, "wrong-type", None, ("near", 1), None),
        ({"grip": {}}, "missing-key", "`grip` lacks `pad`", ("grip",), "write `pad: NAME`"),
        ({"grip": 3}, "wrong-type", "`grip` expects a mapping, got a number `3`", ("grip",), "write `grip: {pad: …}`"),
        ({"grip": "pad:x"}, None, None, None, None),
        (
            {"grips": {"a": ["x"]}},
            "wrong-type",
            "`a` expects a mapping, got a list",
            ("grips", "a"),
            "write `a: {pad: …}`",
        ),
        (
            {"grips": {"a": {"pad": "x", "force": 0}}},
            "out-of-range",
            "`force` of `a` is 0, and must be more than 0",
            ("grips", "a", "force"),
            None,
        ),
        (
            {"grip": ""},
            "wrong-type",
            "`pad` of `grip` expects the name of a geom, got nothing",
            ("grip",),
            "write for instance `pad: NAME`",
        ),
        ({"mass": None}, "wrong-type", "`mass` of `robot` has no value", ("mass",), None),
        ({"is_on": True, "copies": 0}, "out-of-range", "`robot` is on and has no copy", ("copies",), None),
    ],
)
def test_one_fault(data: Any, code: str | None, message: str | None, at: Any, help: str | None) -> None:
    found = told(Arm, data)
    if code is None:
        assert not found
        return
    (fault,) = found
    assert (fault.code, fault.at) == (code, ("robot", *at))
    if message is not None:
        assert (fault.message, fault.help) == (message, help)
    assert "\ue001" not in fault.message + str(fault.help)


def test_every_mistake_is_told_at_once() -> None:
    found = told(Arm, {"mass": "x", "range": [1], "tol": "y", "kind": "lef", "gripp": 1, "near": [3]})
    assert [fault.at[1] for fault in found] == ["mass", "range", "tol", "kind", "near", "gripp", "range"]


@pytest.mark.parametrize(
    ("data", "codes"),
    [
        ({"arm": {}, "name": "n", "size": 1}, []),
        ({"none": True, "extends": "e"}, []),
        ({"extends": "e"}, ["missing-key"]),
        ({"arms": {}, "extends": "e"}, ["unknown-key"]),
        ({"arm": {}, "nam": "n", "size": 1}, ["unknown-key"]),
        ({"arm": {}}, ["missing-key", "missing-key"]),
        ({"arm": {}, "leg": 1, "extends": "e"}, ["wrong-type"]),
        ({"toe": True, "leg": 1, "extends": "e"}, []),
        ({"toe": True, "arm": {}, "extends": "e"}, ["unknown-key"]),
        ({"toe": True, "extends": "e"}, ["missing-key"]),
    ],
)
def test_rules_about_what_is_missing(data: Any, codes: list[str]) -> None:
    assert [fault.code for fault in told(Choice, data)] == codes


def test_what_exists_is_in_a_note() -> None:
    (fault,) = told(Choice, {"extends": "e"})
    assert fault.help == "write `arm: {}`"
    assert [note.message for note in fault.notes] == ["limbs that exist: arm, leg"]


def test_the_other_key_is_a_related_place() -> None:
    (fault,) = told(Arm, {"mass": 1, "range": [1, 2]})
    assert fault.related == (("`mass` is written here", ("robot", "mass")),)


def test_an_expectation_replaces_the_usual_words() -> None:
    class Odd(Model):
        """Odd."""

        steps: Annotated[list[int], Expects("steps of a gait", "[1, 2]")]
        """steps"""

    (fault,) = told(Odd, {"steps": "fast"})
    assert fault.message == "`steps` of `robot` expects steps of a gait, got text `fast`"
    assert fault.help == "write for instance `steps: [1, 2]`"

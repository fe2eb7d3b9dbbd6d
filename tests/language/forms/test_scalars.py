"""The JSON Schema of every kind of value, and that it and the validator agree."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import pytest
from language.forms.schemas import schema_of
from mjcompose.language.forms.context import define
from mjcompose.language.forms.model import Model
from mjcompose.language.forms.scalars import (
    AtLeastOne,
    AttributeValue,
    Count,
    Items,
    Measure,
    Name,
    NotNegative,
    Positive,
    Range,
    Text,
    Whole,
)
from mjcompose.text.expression import Angle
from pydantic import Field, ValidationError, create_model

Several = Annotated[tuple[Annotated[str, Name("geom", glob=True)], ...], Items(1, single=True)]
KINDS: dict[str, tuple[Any, list[Any], list[Any]]] = {
    "positive": (Positive, [1, 0.5], [0, "x", True, [1], float("nan")]),
    "not_negative": (NotNegative, [0, 1e308], [-1, "1"]),
    "below": (Annotated[float, Field(lt=1, le=5)], [0.5], [1, 6]),
    "whole": (Whole, [-1, 20.0], [0.5, "1", False]),
    "count": (Count, [0, 3], [-1, 1.5]),
    "at_least_one": (AtLeastOne, [1], [0]),
    "flag": (bool, [True, False], [1, "yes"]),
    "word": (Literal["a", "b"], ["a"], ["c", 1, ["a"]]),
    "text": (Text, ["x"], ["", 1]),
    "name": (Annotated[str, Name("body")], ["x"], ["", 3]),
    "glob": (Annotated[str, Name("body", glob=True)], ["a/**", "/a.*/", "{a,b}"], ["{a", ""]),
    "computed": (Annotated[str, Name("body", computed=True)], ["${name}_x"], [""]),
    "measure": (Annotated[float | Angle, Measure(ge=0)], [1, "90deg", "1.5rad"], ["90", -1, "x", True]),
    "range": (Range, [[1, 2], [1, 1]], [[1], [1, 2, 3], ["a", 1], 3]),
    "several": (Several, ["a", ["a", "b/*"]], [[], 3, [3], [""]]),
    "attribute": (Annotated[Any, AttributeValue("frame", "pos")], [[1, 2, 3]], [[1, 2], "x", [1, "a", 2]]),
}
UNSEEN = {"measure": [-1], "positive": [float("nan")]}
"""What JSON Schema cannot say: a text has no bounds, and a number that is none is no JSON."""


def model(kind: str) -> type[Model]:
    return create_model(kind.title(), __base__=Model, x=(KINDS[kind][0], ...))


def resolved(schema: Any) -> Any:
    if isinstance(schema, list):
        return [resolved(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    inner = {key: resolved(each) for key, each in schema.items() if key != "mjcf"}
    return {**resolved(define(schema["mjcf"])), **inner} if "mjcf" in schema else inner


@pytest.mark.parametrize("kind", KINDS)
def test_reader_and_schema_agree(kind: str) -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    _, right, wrong = KINDS[kind]
    form = model(kind)
    schema = jsonschema.Draft202012Validator(resolved(schema_of(form)))
    for value in right:
        form.model_validate({"x": value})
        assert schema.is_valid({"x": value}), value
    for value in wrong:
        with pytest.raises(ValidationError):
            form.model_validate({"x": value})
        if value not in UNSEEN.get(kind, []) and value == value:
            assert not schema.is_valid({"x": value}), value


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("positive", {"mjcf": "real", "exclusiveMinimum": 0}),
        ("count", {"mjcf": "whole", "minimum": 0}),
        ("flag", {"mjcf": "boolean"}),
        ("word", {"anyOf": [{"enum": ["a", "b"]}, {"mjcf": "template"}]}),
        ("measure", {"mjcf": "number", "minimum": 0}),
        (
            "range",
            {
                "type": ["array", "string"],
                "items": {"mjcf": "real"},
                "minItems": 2,
                "maxItems": 2,
                "pattern": r"\$\{",
                "errorMessage": "expected a list of 2 numbers, such as [LOW, HIGH]",
            },
        ),
    ],
)
def test_schema(kind: str, expected: dict[str, Any]) -> None:
    assert schema_of(model(kind))["properties"]["x"] == expected


def test_what_is_read() -> None:
    assert model("several").model_validate({"x": "a"}).x == ("a",)  # type: ignore[attr-defined]
    assert model("measure").model_validate({"x": "90deg"}).x == Angle(90, "deg")  # type: ignore[attr-defined]
    assert model("range").model_validate({"x": [1, 2]}).x == (1.0, 2.0)  # type: ignore[attr-defined]
    twenty = model("whole").model_validate({"x": 20.0}).x  # type: ignore[attr-defined]
    assert (twenty, type(twenty)) == (20, int)

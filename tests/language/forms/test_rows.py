"""Keys from a table, forms that are imported when they are needed, and values that are whole."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import pytest
from language.forms.schemas import schema_of
from mjcompose.base.extensions import ExtensionTable
from mjcompose.language.forms.context import Lazy, Rows, Settings, define, settings, validated
from mjcompose.language.forms.json_schema import Generator
from mjcompose.language.forms.model import WHOLE, Model
from mjcompose.language.forms.scalars import Items, Name
from mjcompose.language.forms.translate import faults, key_order, name_scopes, spots
from pydantic import Field, ValidationError, ValidationInfo, field_validator


class Paint(Model):
    """The color that it gets."""

    color: str
    """which"""


class Call(Model):
    """The name that it gets."""

    name: Annotated[str, Name("body")] = Field(alias=WHOLE)
    """the name"""

    @field_validator("name")
    @classmethod
    def _of_what_is_selected(cls, name: str, info: ValidationInfo) -> str:
        return f"{settings(info.context).selected}/{name}"


TABLE: ExtensionTable[Any] = ExtensionTable(
    "verbs", {"call": Call, "paint": f"{__name__}:Paint", "turn": float}, "VERB"
)


class Entry(Model):
    """What is done."""

    of: str | None = None
    """to what"""
    work: Annotated[Mapping[str, Any], Rows(lambda: TABLE, selects="of")] = Field({}, alias="<work>")
    """what"""
    often: int = 1
    """how often"""


class Late(Model):
    """A section that is imported when it is written."""

    fields: Annotated[Any, Lazy("mjcompose.language.verbs.move:Move")] = None
    """what is drawn"""
    entries: Annotated[tuple[Entry, ...], Items()] = ()
    """what is done"""


def test_the_words_of_a_table_are_keys() -> None:
    entry = Entry.model_validate({"turn": 1.5, "of": "arm", "paint": {"color": "red"}, "call": "x"})
    assert list(entry.work) == ["call", "paint", "turn"]  # in the order of the table
    assert entry.work["call"].name == "arm/x"
    assert entry.work["paint"].color == "red"
    assert entry.work["turn"] == 1.5
    assert Entry.key_names() == ["of", "call", "paint", "turn", "often"]


def test_what_is_selected_reaches_no_further() -> None:
    context = Settings()
    Entry.model_validate({"of": "arm", "call": "x"}, context=context)
    assert context.selected is None


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ({"call": 3, "turn": "x"}, [("e", 0, "call"), ("e", 0, "turn")]),
        ({"paint": {"colr": "red"}}, [("e", 0, "paint", "colr")]),
        ({"work": {"turn": 1}}, [("e", 0, "work")]),
        ({"<work>": {"turn": 1}, "often": 0.5}, [("e", 0, "often")]),
    ],
)
def test_faults_have_the_paths_of_the_recipe(data: Any, expected: list[Any]) -> None:
    with pytest.raises(ValidationError) as caught:
        Entry.model_validate(data)
    assert [each.at for each in faults(caught.value, Entry, data, start=("e", 0))] == expected


def test_messages_list_the_words_of_the_table() -> None:
    data = {"pain": {}}
    with pytest.raises(ValidationError) as caught:
        Entry.model_validate(data)
    (fault,) = faults(caught.value, Entry, data, start=("e", 0))
    assert fault.message == "an entry of `e` has no key `pain`"
    assert fault.help == "write `paint`"
    assert fault.notes[0].message == "keys that exist: of, call, paint, turn, often"


def test_the_schema_has_the_words_where_the_field_stands() -> None:
    schema = schema_of(Entry)
    assert list(schema["properties"]) == ["of", "call", "paint", "turn", "often"]
    assert schema["properties"]["call"] == {"mjcf": "form:Call", "description": "The name that it gets."}
    text = {"type": "string", "minLength": 1, "errorMessage": "expected the name of a body"}
    assert define("form:Call") == {**text, "description": "the name"}
    assert schema["properties"]["paint"]["description"] == "The color that it gets."


def test_a_lazy_form_is_imported_when_it_is_written() -> None:
    target = "wave"  # a small module of Python's own that nothing here imports
    sys.modules.pop(target, None)
    lazy = Annotated[Any, Lazy(f"{target}:Wave_read")]
    with pytest.raises(Exception, match="schema"):
        validated(lazy, None)
    assert target in sys.modules


def test_a_lazy_form_reads_and_reports_as_if_it_stood_there() -> None:
    made = Late.model_validate({"fields": {"to": "hand"}})
    assert made.fields.to == "hand"
    data = {"fields": {"to": {"fram": "x"}}}
    with pytest.raises(ValidationError) as caught:
        Late.model_validate(data)
    found = list(faults(caught.value, Late, data))
    assert [(each.code, each.at) for each in found] == [("unknown-key", ("fields", "to", "fram"))]
    assert "Move" in Late.model_json_schema(schema_generator=Generator)["$defs"]


def test_the_walk_sees_through_all_of_them() -> None:
    scopes = {at: name.scope for at, name in name_scopes(Late).items()}
    assert scopes == {
        ("fields", "to"): ("body",),
        ("fields", "to", "frame"): ("frame",),
        ("entries", "*", "call"): ("body",),
    }
    assert key_order(Late)[("entries", "*")] == Entry.key_names()
    assert ("entries", "*", "paint", "color") in {each.at for each in spots(Late)}


class Short(Model):
    """A text alone stands for its name."""

    short: ClassVar = "name"

    name: Annotated[str, Name("body")]
    """its name"""
    size: float = 1
    """its size"""


def test_a_text_stands_for_the_short_key() -> None:
    assert Short.model_validate("x") == Short.model_validate({"name": "x"})
    schema = schema_of(Short)
    assert schema["anyOf"][0]["errorMessage"] == "expected the name of a body"
    assert list(schema["anyOf"][1]["properties"]) == ["name", "size"]

"""The rows of the kinds: whole, all listed, and heeded by what looks references up."""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import mjcompose.sources
import pytest
from mjcompose.sources import kinds
from mjcompose.sources.fetching import Lookup
from mjcompose.sources.kinds import KINDS, parse
from mjcompose.sources.lock import Locked, resolve
from mjcompose.sources.reference import PINS, Form, Origin, Reference, Source, SourceError, SourceKind


def test_every_row_is_listed() -> None:
    modules = [
        importlib.import_module(f"mjcompose.sources.{each.name}")
        for each in pkgutil.iter_modules(mjcompose.sources.__path__)
    ]
    rows = {row.name for module in modules for row in vars(module).values() if isinstance(row, SourceKind)}
    assert sorted(rows) == sorted(row.name for row in KINDS)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_the_examples_of_a_kind_are_references_of_it(kind: SourceKind) -> None:
    for form in kind.forms:
        assert parse(form.example.replace("HEX", "0" * 64)).kind is kind


def test_messages_list_every_form_once() -> None:
    with pytest.raises(SourceError) as caught:
        parse("nothing:x")
    (note,) = caught.value.notes
    assert note.startswith("forms that exist: `./path/to/model.xml`, `package:NAME/path/in/package.xml`, ")
    shown = [Form(example, "").scheme for example in note.split("`")[1::2]]
    assert shown == list(dict.fromkeys(form.scheme for kind in KINDS for form in kind.forms))


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"forms": ()}, "at least one form"),
        ({"name": "a b"}, "needs a name"),
        ({"pins": frozenset({"color"})}, "no lock has that"),
        ({"pins": frozenset({"sha256"}), "is_local": True}, "are not pinned"),
    ],
)
def test_a_row_that_contradicts_itself_fails(change: dict[str, Any], problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        replace(KINDS[1], **{"pins": frozenset(), **change})


def test_what_a_kind_pins_is_what_a_lock_has() -> None:
    own = {"kind", "files", "licenses", "used_by"}
    assert {*PINS} == Locked.model_fields.keys() - own


def test_what_is_known_of_a_source_is_pinned() -> None:
    shared = replace(kinds.PATH, is_local=False)
    with pytest.raises(ValueError, match=r"knows \['sha256'\], and `pins` in its row does not name it"):
        Origin("shared:arm", shared, Path(), sha256="0" * 64)
    with pytest.raises(ValueError, match=r"knows \['package'\]"):
        Source(Path("arm.xml"), shared, "shared:arm/arm.xml", package="arm")


@pytest.mark.parametrize(("is_fetched", "seen"), [(False, {"SHOWN": "1"}), (True, {"SHOWN": "1", "HIDDEN": "2"})])
def test_a_kind_that_is_not_fetched_sees_its_own_variables(
    is_fetched: bool, seen: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[dict[str, str]] = []

    def look(reference: Reference, lookup: Lookup) -> Source:
        found.append(dict(lookup.environment))
        return Source(Path("arm.xml"), reference.kind, reference.text)

    row = replace(kinds.PATH, is_local=False, is_fetched=is_fetched, variables=("SHOWN", "UNSET"), resolve=look)
    monkeypatch.setitem(kinds._BY_NAME, "path", row)
    resolve("./arm.xml", relative_to=Path(), environment={"SHOWN": "1", "HIDDEN": "2"})
    assert found == [seen]

"""Every folder of `cases/`: models a/ and b/, and what is told of them. UPDATE_EXPECTED=1 writes that anew."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from mjcompose.contrast.text import render
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff

CASES = Path(__file__).parent / "cases"
NAMES = sorted(path.name for path in CASES.iterdir() if path.is_dir())


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


@pytest.mark.parametrize("name", NAMES)
def test_told_as_expected(name: str, session: Session) -> None:
    folder = CASES / name
    file = "model.xml" if (folder / "a" / "model.xml").exists() else "recipe.yaml"
    context = Context(folder=folder)
    found = diff(f"a/{file}", f"b/{file}", context, session)
    assert found is not None, context.sink.diagnostics
    text = render(found) + "\n"
    expected = folder / "expected.txt"
    if os.environ.get("UPDATE_EXPECTED"):
        expected.write_text(text, encoding="utf-8")
    assert text == expected.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [name for name in NAMES if name != "same"])
def test_the_other_way_round_differs_as_much(name: str, session: Session) -> None:
    folder = CASES / name
    file = "model.xml" if (folder / "a" / "model.xml").exists() else "recipe.yaml"
    ends = f"a/{file}", f"b/{file}"
    there, back = (diff(*each, Context(folder=folder), session, everything=True) for each in (ends, ends[::-1]))
    assert there is not None and back is not None
    opposite = {"added": "removed", "removed": "added"}
    changes = {
        (opposite.get(each.what, each.what), each.kind, each.field, each.after, each.before)
        for group in there.groups
        for each in group.changes
    }
    assert changes == {
        (each.what, each.kind, each.field, each.before, each.after) for group in back.groups for each in group.changes
    }
    assert not there.same and not back.same

"""Lint texts: what a rule finds in a small model."""

from __future__ import annotations

from pathlib import Path

from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.lint.rule import rules
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.fix import applied, edit_of
from mjcompose.tools.lint import lint


def linted(text: str, code: str, folder: Path, session: Session, name: str = "model.xml") -> tuple[Diagnostic, ...]:
    """Return the findings of one rule; the model must be without errors."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    context = Context(sink=Sink(), folder=folder)
    found = lint(path, context, session, [rules()[code]])
    assert not context.sink.has_errors, context.sink.sorted()
    return found.found


def check_case(case: tuple[str, str, str, str], folder: Path, session: Session) -> None:
    """A rule has one finding with these words in the wrong model, and none in the right one, which is nearly the same."""
    code, wrong, right, words = case
    found = linted(wrong, code, folder, session)
    assert len(found) == 1
    assert words in found[0].message
    assert not linted(right, code, folder, session)


def mended(text: str, found: tuple[Diagnostic, ...]) -> str:
    """Return the text with all fixes applied; every finding must have one."""
    edits = [edit_of(each, text) for each in found]
    assert all(edits), found
    return applied(text, [edit for edit in edits if edit is not None])

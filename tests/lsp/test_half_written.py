"""Recipes at every moment of being written: nothing breaks, and every place that is named exists."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

import pytest
from lsp.conftest import RECIPES
from mjcompose.base.diagnostic import Span
from mjcompose.lsp.actions import Offer, actions
from mjcompose.lsp.analysis import Analysis, Question, units
from mjcompose.lsp.completion import complete
from mjcompose.lsp.desk import Workspace, uses_of
from mjcompose.lsp.hover import hover
from mjcompose.lsp.mjcf import RenameRefused
from mjcompose.lsp.navigation import definition, folds, formatted, hints, lenses, references, symbols
from mjcompose.lsp.rename import rename, renameable
from mjcompose.text.node import lines_of

SHIPPED = sorted(RECIPES.glob("*.yaml"))
QUICK = [RECIPES / name for name in ("demo.yaml", "payload_study.yaml", "hoist.yaml")]


@dataclass
class Typist:
    """Writes a recipe and asks everything about it at each step."""

    recipe: Path
    workspace: Workspace
    analysis: Analysis | None = None
    asked: int = 0
    lines: list[str] = field(default_factory=list)

    def types(self, text: str, at: int, *, analyzed: bool = True, all_of_it: bool = True) -> None:
        """The text as it is now, with the cursor behind `at` characters."""
        if analyzed or self.analysis is None:
            self.analysis = self.workspace.analyze(self.recipe, text, {}, self.analysis)
            self.lines = lines_of(text)
            for each in self.analysis.found:
                self.check([each.span, *(note.span for note in each.notes)])
        before = lines_of(text[:at])
        question = Question(self.analysis, lines_of(text), len(before) - 1, len(before[-1]))
        found = complete(question)
        assert question.cursor.start <= question.column <= question.cursor.end
        if found.span is not None:
            line = question.lines[found.span.line - 1]
            assert 1 <= found.span.column <= (found.span.end_column or 0) <= len(line) + 1
            assert units(line, found.span.column - 1) <= units(line, len(line))
        for fold in folds(question.lines):
            assert 0 <= fold.first < fold.last < len(question.lines)
        if analyzed and all_of_it:
            traced = self.workspace.traced(self.analysis)
            self.asks(replace(question, analysis=traced), traced)
        self.asked += 1

    def asks(self, question: Question, analysis: Analysis) -> None:
        shown = hover(question)
        self.check([] if shown is None else [shown.span])
        for spans in (definition(question), references(question)):
            self.check(spans)
        for action in actions(Offer(question, analysis.found)):
            self.check(change.span for change in action.changes)
        for symbol in symbols(analysis):
            self.check([symbol.span, symbol.whole])
        self.check(each.span for each in hints(analysis))
        self.check(each.span for each in lenses(analysis))
        self.check(uses_of(analysis).values())
        self.check(each.span for each in formatted(analysis.text, analysis.file))
        if (span := renameable(question)) is not None:
            with suppress(RenameRefused):
                self.check([span, *(change.span for change in rename(question, "renamed", ()))])

    def check(self, spans: Iterable[Span | None]) -> None:
        """Every place in the recipe is one of its text."""
        assert self.analysis is not None
        for span in spans:
            if span is None or span.file != self.analysis.file:
                continue
            assert 1 <= span.line <= len(self.lines), span
            assert 1 <= span.column <= len(self.lines[span.line - 1]) + 1, span
            if span.end_line is not None and span.end_column is not None:
                assert (span.line, span.column) <= (span.end_line, span.end_column), span
                assert span.end_line <= len(self.lines), span
                # What lacks its end is reported with a caret behind the line, which an editor shows at its end.
                assert span.end_column <= max(len(self.lines[span.end_line - 1]) + 1, span.column + 1), span


@pytest.fixture
def typist(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Typist]:
    if request.param.stem.startswith("menagerie"):
        monkeypatch.setenv("MENAGERIE_ROOT", str(request.getfixturevalue("simple_robots")))
    workspace = Workspace(RECIPES)
    yield Typist(request.param, workspace)
    workspace.close()


def named(recipes: list[Path]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("typist", recipes, ids=[each.stem for each in recipes], indirect=True)


def deletions(text: str, count: int, seed: int) -> Iterator[tuple[str, int]]:
    """The text without stretches of it, and where each was."""
    draw = random.Random(seed)
    for _ in range(count):
        start = draw.randrange(len(text))
        yield text[:start] + text[start + draw.choice([1, 1, 2, 5, 20, 100]) :], start


@named(QUICK)
def test_some_prefixes_and_deletions(typist: Typist) -> None:
    text = typist.recipe.read_text(encoding="utf-8")
    for at in range(0, len(text), 7):
        typist.types(text[:at], at, analyzed=at % 98 == 0)
    for shorter, at in deletions(text, 12, 1):
        typist.types(shorter, at)
    assert typist.asked > 50


def test_emoji_and_other_line_ends(tmp_path: Path) -> None:
    text = (RECIPES / "demo.yaml").read_text(encoding="utf-8").replace("models/", f"{RECIPES}/models/")
    text = text.replace("table:", "ta🤖ble:").replace("table/", "ta🤖ble/").replace("\n", "\r\n")
    workspace = Workspace(tmp_path)
    typist = Typist(tmp_path / "emoji.yaml", workspace)
    for at in range(0, len(text), 61):
        typist.types(text[:at], at)
    typist.types(text, len(text))
    workspace.close()


@pytest.mark.slow
@named(SHIPPED)
def test_many_prefixes_and_deletions(typist: Typist) -> None:
    """At every second end of a word or number, and now and then inside of one."""
    text = typist.recipe.read_text(encoding="utf-8")
    ends = (
        at
        for at in range(len(text) + 1)
        if at % 8 == 0 or not (text[at - 1 : at].isalnum() and text[at : at + 1].isalnum())
    )
    for number, at in enumerate(islice(ends, 0, None, 2)):
        typist.types(text[:at], at, analyzed=number % 20 == 0)
    for shorter, at in deletions(text, 30, 2):
        typist.types(shorter, at)

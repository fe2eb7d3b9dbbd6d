"""The open recipes, and what is kept for them from one analysis to the next."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.compose.compose import Composer
from composer.context import Context
from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.sink import Sink, TooManyFaults
from composer.diagnostics.span import Span
from composer.document import load
from composer.engine import Session
from composer.explain.trace import Trace
from composer.explain.traced import Traced
from composer.link.measure import measure_with
from composer.link.source_check import check_source
from composer.lsp.analysis import Analysis, shown
from composer.lsp.names import names_of
from composer.lsp.shelf import Shelf
from composer.plan.allowed import acknowledge
from composer.plan.planner import plan_what_remains
from composer.reading.regular import read_regular
from composer.reading.unsaved import unsaved
from composer.sources.fetching import Fetching
from composer.sources.suggest import model_files
from composer.tree.parse import parse_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from composer.plan.plan import Plan

RECIPES = (".yaml", ".yml")
_RECIPE = re.compile(r"^(?:recipe|extends)\s*:", re.MULTILINE)


def is_recipe(path: Path, text: str) -> bool:
    """Return whether a YAML file is a recipe: its text or its file name says so."""
    return path.suffix.lower() in RECIPES and bool(_RECIPE.search(text) or path.stem.endswith(".recipe"))


_MOST_TEXT = 1_000_000
"""The longest recipe that is analyzed, in characters: it takes up to 20 seconds for every letter that you type."""


def _too_large(text: str, file: str) -> Diagnostic:
    message = f"the recipe has {len(text) / 1e6:.1f} MB, and the editor shows no errors above {_MOST_TEXT / 1e6:g} MB"
    help = "`mjcompose check` shows them"
    return Diagnostic("yaml-too-large", message, Span(file, 1, 1), severity=Severity.WARNING, help=help)


class Workspace:
    """Analyses recipes one after another, in one thread. Paths are shown relative to `folder`.

    Sources that have not changed are not read again. Nothing is fetched: remote sources must already be in the store.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shelf = Shelf()
        self._session = Session()

    def close(self) -> None:
        self._session.close()

    def context(self) -> Context:
        return Context(folder=self.folder, fetching=Fetching(offline=True))

    def analyse(
        self, path: Path, text: str, texts: Mapping[str, bytes], before: Analysis | None = None
    ) -> Analysis:
        """Return the analysis of a recipe with the texts of the editor. What it lacks now is taken from `before`."""
        if len(text) > _MOST_TEXT:
            return Analysis(path, self.folder, text, found=(_too_large(text, shown(path, self.folder)),))
        with unsaved({**texts, os.path.realpath(path): text.encode("utf-8", "replace")}):
            return self._analysed(path, text, texts, before or Analysis(path, self.folder, text))

    def _analysed(self, path: Path, text: str, texts: Mapping[str, bytes], before: Analysis) -> Analysis:
        self.shelf.refresh(texts)
        context = self.context()
        tree = load(text, shown(path, self.folder), Sink())
        plan, traced = None, None
        try:
            plan = plan_what_remains(path, context)
            traced = None if plan is None else self._traced(plan, context)
        except TooManyFaults as too_many:
            context.sink = too_many.sink
        self.shelf.note(texts)
        if plan is not None:
            acknowledge(plan, context.sink, context.shown, whole=False)
        known, model = plan or before.plan, traced or before.traced
        return replace(
            Analysis(path, self.folder, text),
            tree=tree or before.tree,
            plan=known,
            traced=model,
            composed=plan if traced is not None else before.composed,
            tree_of=text if tree is not None else before.tree_of,
            plan_of=text if plan is not None else before.plan_of,
            model_of=text if traced is not None else before.model_of,
            is_current=tree is not None,
            is_composed=traced is not None,
            found=tuple(context.sink.sorted()),
            files=self._files(plan, traced, context) | (before.files if traced is None else frozenset()),
            names=before.names
            if known is None
            else names_of(known, model, plan if traced is not None else before.composed, self.shelf.library),
        )

    def _traced(self, plan: Plan, context: Context) -> Traced | None:
        watch = Trace()
        composer = Composer(
            context, measure_with(context, session=self._session), self._session,
            watch=watch, library=self.shelf.library, checks_sources=True, makes_shapes=False,
        )  # fmt: skip
        composed = composer.compose(plan)
        return None if composed is None else Traced(composed.model, watch, plan.separator, context.folder)

    def _files(self, plan: Plan | None, traced: Traced | None, context: Context) -> frozenset[Path]:
        """Return the recipes and models that were read."""
        found = {self.folder / each for each in context.recipes}
        if plan is not None:
            found |= {source.path for source in plan.sources()}
        if traced is not None:
            found |= {self.folder / name for name in traced.model.origins.texts}
        return frozenset(Path(os.path.normpath(each)) for each in found)

    def including(self, path: Path, texts: Mapping[str, bytes]) -> list[Analysis]:
        """Return the recipes in the folder that contain the name of a recipe."""
        found = []
        for name in model_files(self.folder):
            other = self.folder / name
            if other.suffix.lower() not in RECIPES or other == path:
                continue
            try:
                with unsaved(texts):
                    text = read_regular(other).decode("utf-8")
            except (OSError, UnicodeDecodeError):
                continue
            if path.name in text and is_recipe(other, text):
                found.append(self.analyse(other, text, texts))
        return found

    def check_model(self, path: Path, text: str) -> tuple[Diagnostic, ...]:
        """Return the diagnostics of an MJCF file by itself."""
        sink = Sink()
        unit = parse_text(
            text.encode("utf-8", "replace"),
            sink,
            file=shown(path, self.folder),
            directory=path.parent,
            label=path.stem,
        )
        if unit is not None:
            check_source(unit, sink)
        return tuple(sink.sorted())

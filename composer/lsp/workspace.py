"""The open recipes, and what is kept for them from one analysis to the next."""

from __future__ import annotations

import os
import re
from contextlib import suppress
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
from composer.lsp.analysis import Analysis, Model, shown
from composer.lsp.shelf import Shelf
from composer.plan.allowed import acknowledge
from composer.plan.planner import plan_what_remains
from composer.reading.regular import read_regular
from composer.reading.unsaved import unsaved
from composer.sources.fetching import Fetching
from composer.sources.suggest import model_files
from composer.tree.parse import parse_text
from composer.tree.watch import Watch, nobody

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lxml.etree import _Element as Node

    from composer.compose.load import Library
    from composer.plan.plan import Plan
    from composer.tree.unit import Unit

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
        self._latest: tuple[Analysis, Analysis] | None = None

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
        self.shelf.refresh(texts)
        whole = {**texts, os.path.realpath(path): text.encode("utf-8", "replace")}
        with unsaved(whole):
            analysis = self._analysed(path, text, whole, before or Analysis(path, self.folder, text))
        self.shelf.note(texts)
        return analysis

    def _analysed(self, path: Path, text: str, whole: Mapping[str, bytes], before: Analysis) -> Analysis:
        context = self.context()
        tree = load(text, shown(path, self.folder), Sink())
        plan, model = None, None
        try:
            plan = plan_what_remains(path, context)
            composed = None if plan is None else self._composed(plan, context, self.shelf.library)
            if plan is not None and composed is not None:
                model = Model(composed[0], plan, composed[1], dict(self.shelf.library), whole)
        except TooManyFaults as too_many:
            context.sink = too_many.sink
        if plan is not None:
            acknowledge(plan, context.sink, context.shown, whole=False)
        return replace(
            Analysis(path, self.folder, text),
            tree=tree or before.tree,
            plan=plan or before.plan,
            model=model or before.model,
            traced=before.traced if model is None else None,
            tree_of=text if tree is not None else before.tree_of,
            plan_of=text if plan is not None else before.plan_of,
            model_of=text if model is not None else before.model_of,
            is_current=tree is not None,
            is_composed=model is not None,
            found=tuple(context.sink.sorted()),
            files=self._files(plan, model, context) | (before.files if model is None else frozenset()),
            library=dict(self.shelf.library),
        )

    def traced(self, analysis: Analysis) -> Analysis:
        """Return an analysis that knows where the elements of its model come from, if it can still be composed.

        The model is composed again from the same plan, sources and unsaved texts.
        """
        model = analysis.model
        if model is None or analysis.traced is not None:
            return analysis
        if self._latest is None or self._latest[0] is not analysis:
            self._latest = analysis, self._with_trace(analysis, model)
        return self._latest[1]

    def _with_trace(self, analysis: Analysis, model: Model) -> Analysis:
        watch = Trace()
        with unsaved(model.texts), suppress(TooManyFaults):
            again = self._composed(model.plan, self.context(), dict(model.library), watch)
            if again is not None:
                unit, parts = again
                traced = Traced(unit, watch, model.plan.separator, self.folder)
                return replace(analysis, model=replace(model, unit=unit, parts=parts), traced=traced)
        return analysis

    def _composed(
        self, plan: Plan, context: Context, library: Library, watch: Watch = nobody
    ) -> tuple[Unit, dict[Node, str]] | None:
        """Return the model of a plan and the part of each element, or None if it has faults."""
        composer = Composer(
            context, measure_with(context, session=self._session), self._session, watch=watch, library=library,
            checks_sources=True, notes_parts=True, makes_shapes=False,
        )  # fmt: skip
        composed = composer.compose(plan)
        return None if composed is None else (composed.model, composer.parts)

    def _files(self, plan: Plan | None, model: Model | None, context: Context) -> frozenset[Path]:
        """Return the recipes and models that were read."""
        found = {self.folder / each for each in context.recipes}
        if plan is not None:
            found |= {source.path for source in plan.sources()}
        if model is not None:
            found |= {self.folder / name for name in model.unit.origins.texts}
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

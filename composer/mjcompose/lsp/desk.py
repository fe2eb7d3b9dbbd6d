"""Open documents, their analysis, and their diagnostics."""

from __future__ import annotations

import asyncio
import os
import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.base.files import MJCF_FILES, RECIPES, read_regular, unsaved
from mjcompose.base.sink import Sink, TooManyFaults
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.link.measure import measure_with
from mjcompose.link.source_check import check_source
from mjcompose.lint.rule import chosen
from mjcompose.lsp.analysis import Analysis, ComposedModel, FreshLibrary, is_saved, shown
from mjcompose.lsp.glance import carried, glance, waits_for_pause
from mjcompose.lsp.markup import ModelAnalysis, including, read_model
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.planner import plan_what_remains
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching, model_files
from mjcompose.text.load import load
from mjcompose.text.node import lines_of
from mjcompose.tools.fix import Fixing, Judged, models_of
from mjcompose.tools.lint import lint
from mjcompose.trace.trace import Trace
from mjcompose.trace.traced import Traced
from mjcompose.tree.parse import parse_text, parse_xml
from mjcompose.tree.unit import Unit, Watch, nobody
from mjcompose.tree.xml_text import kind_of, root_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.compose.load import Library
    from mjcompose.plan.plan import Plan

T = TypeVar("T")


def by_file(
    found: Iterable[Diagnostic], own: str, uses: Mapping[str, Span] | None = None
) -> Mapping[str, list[Diagnostic]]:
    """Return diagnostics by file. A model's file may not be open, so they are also shown at its place in `uses`."""
    files: dict[str, list[Diagnostic]] = {own: []}
    for each in found:
        span = each.span
        file = own if span is None or span.file.startswith("--") else span.file
        files.setdefault(file, []).append(each)
        if file != own and uses is not None:
            notes = (Note("it is found here", span), *each.notes)
            files[own].append(
                replace(each, span=uses.get(file) or Span(own, 1, 1, end_line=1, end_column=1), notes=notes, fix=None)
            )
    return files


def uses_of(analysis: Analysis) -> dict[str, Span]:
    """Return the first place of each file of a model that the recipe names."""
    first: dict[Path, Span] = {}
    if analysis.plan is not None:
        for place in analysis.plan.walk():
            path = getattr(place.model, "path", None)
            if path is None or path in first or place.span is None or place.span.file != analysis.file:
                continue
            now = analysis.now(place.span, analysis.plan_of)
            if now is not None:
                first[path] = now
    found: dict[str, Span] = {}
    for path, span in first.items():
        found.setdefault(shown(path, analysis.folder), span)
    return found


def _offline(folder: Path) -> Context:
    return Context(folder=folder, fetching=Fetching(offline=True))


def _with(texts: Mapping[str, bytes], path: Path, text: str) -> dict[str, bytes]:
    return {**texts, os.path.realpath(path): text.encode("utf-8", "replace")}


def once(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return one diagnostic for each fault: a recipe may know more ways to correct a file than the file alone."""
    fullest: dict[tuple[Any, ...], Diagnostic] = {}
    for diagnostic in diagnostics:
        fault = (diagnostic.code, diagnostic.severity, diagnostic.message, diagnostic.span, diagnostic.notes)
        known = fullest.get(fault)
        if known is None or len(str(diagnostic.help or "")) > len(str(known.help or "")):
            fullest[fault] = diagnostic
    return list(fullest.values())


def _has_errors(found: Iterable[Diagnostic]) -> bool:
    return any(each.severity is Severity.ERROR for each in found)


_MOST_TEXT = 1_000_000
"""The length of the longest recipe to analyze, in characters: it takes up to 20 seconds for each keystroke."""


class Workspace:
    """Analyses recipes one after another, in one thread. It reads changed sources only, and fetches nothing."""

    def __init__(self, folder: Path, *, remembers: bool = False) -> None:
        self.folder = folder
        self.shelf = FreshLibrary()
        self._session = Session(remembers=remembers)
        self._latest: tuple[Analysis, Analysis] | None = None

    def close(self) -> None:
        self._session.close()

    def analyze(self, path: Path, text: str, texts: Mapping[str, bytes], before: Analysis | None = None) -> Analysis:
        """Return the analysis of a recipe with the texts of the editor. Missing results come from `before`."""
        if len(text) > _MOST_TEXT:
            size = f"{len(text) / 1e6:.1f} MB, and the editor shows no errors above {_MOST_TEXT / 1e6:g} MB"
            warning = Diagnostic(
                "yaml-too-large",
                f"the recipe has {size}",
                Span(shown(path, self.folder), 1, 1),
                severity=Severity.WARNING,
                help="`mjcompose check` shows them",
            )
            return Analysis(path, self.folder, text, found=(warning,))
        self.shelf.refresh(texts)
        whole = _with(texts, path, text)
        with unsaved(whole):
            analysis = self._analysed(path, text, whole, before or Analysis(path, self.folder, text))
        self.shelf.note(texts)
        return analysis

    def _analysed(self, path: Path, text: str, whole: Mapping[str, bytes], before: Analysis) -> Analysis:
        context = _offline(self.folder)
        tree = load(text, shown(path, self.folder), Sink())
        plan = None
        model = None
        try:
            plan = plan_what_remains(path, context)
            composed = None if plan is None else self._composed(plan, context, self.shelf.library)
            if plan is not None and composed is not None:
                model = ComposedModel(composed[0], plan, composed[1], dict(self.shelf.library), whole)
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
        """Return an analysis that knows where elements come from, by composing the same plan and sources again."""
        model = analysis.model
        if model is None or analysis.traced is not None:
            return analysis
        if self._latest is None or self._latest[0] is not analysis:
            watch = Trace()
            again = None
            with unsaved(model.texts), suppress(TooManyFaults), watch.recording():
                again = self._composed(model.plan, _offline(self.folder), dict(model.library), watch)
            whole = analysis
            if again is not None:
                traced = Traced(again[0], watch, model.plan.separator, self.folder)
                whole = replace(analysis, model=replace(model, unit=again[0], parts=again[1]), traced=traced)
            self._latest = analysis, whole
        return self._latest[1]

    def _composed(
        self, plan: Plan, context: Context, library: Library, watch: Watch = nobody
    ) -> tuple[Unit, dict[Node, str]] | None:
        composer = Composer(
            context,
            measure_with(context, session=self._session),
            self._session,
            watch=watch,
            library=library,
            # An edit selects the assets of each copy, before copies share them.
            options=ComposeOptions(checks_sources=True, notes_parts=True, makes_shapes=False, shares_assets=False),
        )
        composed = composer.compose(plan)
        return None if composed is None else (composed.model, composer.parts)

    def _files(self, plan: Plan | None, model: ComposedModel | None, context: Context) -> frozenset[Path]:
        found = {self.folder / each for each in context.recipes}
        if plan is not None:
            found |= {source.path for source in plan.sources()}
        if model is not None:
            found |= {self.folder / name for name in model.unit.origins.texts}
        return frozenset(Path(os.path.normpath(each)) for each in found)

    def including(self, path: Path, texts: Mapping[str, bytes]) -> list[Analysis]:
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
            if path.name in text and kind_of(other, text) == "recipe":
                found.append(self.analyze(other, text, texts))
        return found

    def analyze_model(
        self, path: Path, text: str, texts: Mapping[str, bytes], before: Analysis | None = None
    ) -> ModelAnalysis:
        """Return the analysis of an MJCF file. If it cannot be read at all, use the model of `before`."""
        sink = Sink()
        file = shown(path, self.folder)
        content = text.encode("utf-8", "replace")
        with unsaved(texts):
            unit, nodes = read_model(path, text, self.folder)
            if root_of(text) == "mujocoinclude":  # a piece of other models
                parse_xml(content, file, sink)
            elif (whole := parse_text(content, sink, file=file, directory=path.parent, label=path.stem)) is not None:
                check_source(whole, sink)
        found = tuple(sink.sorted())
        if unit is None and isinstance(before, ModelAnalysis):
            return replace(before, text=text, found=found, is_current=False, nodes=())
        files = () if unit is None else (each.path for each in unit.origins.texts.values() if each.path is not None)
        is_current = not any(each.code == "xml-syntax" for each in found)
        return ModelAnalysis(
            path,
            self.folder,
            text,
            found=found,
            files=frozenset(files),
            is_current=is_current,
            model_of=text,
            unit=unit,
            nodes=nodes,
        )

    def verify(self, path: Path, text: str, texts: Mapping[str, bytes]) -> tuple[Diagnostic, ...]:
        """Return the findings about a recipe, built with MuJoCo as `check` does."""
        context = _offline(self.folder)
        with unsaved(_with(texts, path, text)):
            self.shelf.refresh(texts)
            try:
                build(ModelRequest(path), context, session=self._session, library=self.shelf.library)
            except TooManyFaults as too_many:
                context.sink = too_many.sink
            self.shelf.note(texts)
        return tuple(context.sink.sorted())

    def holds(self, path: Path, text: str, texts: Mapping[str, bytes], diagnostic: Diagnostic) -> bool:
        """Return whether a fix removes its fault from every model of a recipe, or from a model, and nothing else."""

        def linted(context: Context) -> list[Judged]:
            found = lint(path, context, self._session, selected=chosen()).found
            return [Judged(None, (*context.sink.sorted(), *found))]

        own = _offline(self.folder)
        if kind_of(path, text) == "recipe":
            judge = partial(models_of, path, given={}, most=_MOST_MODELS)
            ways = [Fixing(judge, own), Fixing(partial(judge, verified=True), own)]
        else:
            ways = [Fixing(linted, own, MJCF_FILES)]
        with unsaved(_with(texts, path, text)):
            return any(fixing.holds(diagnostic) for fixing in ways)

    def lint(self, path: Path, text: str, texts: Mapping[str, bytes]) -> tuple[Diagnostic, ...]:
        """Return the findings about an MJCF file, as `mjcompose lint` reports them. A file must exist."""
        if not os.path.isfile(path):
            return ()
        context = _offline(self.folder)
        with unsaved(_with(texts, path, text)):
            linted = lint(path, context, self._session, selected=chosen())
        return (*context.sink.sorted(), *linted.found)


_MOST_MODELS = 32
"""The number of models in which the editor tries a fix before it offers it. `mjcompose fix` tries all of them."""

PAUSE = 0.4  # seconds without typing before MuJoCo builds the model


class OpenFile(Struct, frozen=False, slots=False, eq=False):
    """An open file. `kind` is `recipe`, `model`, or empty as long as it is neither.

    The texts of a document are numbered: `count` is the newest text, and `done` the analyzed text. `version` is the
    editor's own number for the newest text, and `seen` its number for the analyzed text. `tried` says for the fixes of
    a numbered text whether they hold.

    The last analysis, `whole`, took `seconds` of processor time. If that is too long for each keystroke, `analysis` is
    the result of a glance at the text number `glanced` until nobody types.
    """

    path: Path
    text: str
    kind: str
    version: int | None = None
    seen: int | None = None
    count: int = 1
    done: int = 0
    analysis: Analysis | None = None
    whole: Analysis | None = None
    seconds: float = 0
    glanced: int = 0
    glancing: asyncio.Task[None] | None = None
    verified: tuple[Diagnostic, ...] = ()
    tried: tuple[int, dict[Diagnostic, bool]] = (0, {})
    verified_lines: list[str] = field(default_factory=list)
    work: asyncio.Task[None] | None = None
    timer: asyncio.TimerHandle | None = None
    _lines: tuple[str, list[str]] = ("", [""])

    @property
    def lines(self) -> list[str]:
        if self._lines[0] != self.text:
            self._lines = self.text, lines_of(self.text)
        return self._lines[1]

    @property
    def waits_for_pause(self) -> bool:
        return self.kind == "recipe" and waits_for_pause(self.text, self.seconds)

    def is_touched_again(self) -> bool:
        """Return whether the next analysis waits for a pause, while an earlier text is analyzed."""
        return self.timer is not None

    def stop(self) -> None:
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None


def _timed(work: Callable[..., T], *arguments: object) -> tuple[T, float]:
    """Return the result of some work, and the processor time that it takes."""
    start = time.thread_time()
    result = work(*arguments)
    return result, time.thread_time() - start


class Desk:
    """The open documents by path, in the thread of the event loop; analysis and verification have one thread each."""

    def __init__(
        self, folder: Path, publish: Callable[[Path, list[Diagnostic]], None], log: Callable[[str], None]
    ) -> None:
        self.folder = folder
        self.documents: dict[Path, OpenFile] = {}
        self.workspace = Workspace(folder)
        self.verifier = Workspace(folder, remembers=True)
        self._publish = publish
        self._log = log
        self._analysing = ThreadPoolExecutor(1, "analysis")
        self._verifying = ThreadPoolExecutor(1, "verification")
        self._glancing = ThreadPoolExecutor(1, "glance")
        self._reported: dict[Path, dict[str, list[Diagnostic]]] = {}

    def take(self, path: Path, text: str, version: int | None = None) -> None:
        self.documents[path] = OpenFile(path, text, kind_of(path, text), version)
        self._touched(path)

    def change(self, path: Path, text: str, version: int | None = None) -> None:
        document = self.documents[path]
        document.text = text
        document.version = version
        document.count = document.count + 1
        if document.kind == "":
            document.kind = kind_of(path, text)
        self._touched(path)

    def close(self, path: Path) -> None:
        document = self.documents.pop(path, None)
        if document is not None:
            document.stop()
            self._report(path, {})
            self.changed_on_disk([path])

    def changed_on_disk(self, paths: Iterable[Path]) -> None:
        for path in paths:
            self._touched(path, itself=False)

    def _touched(self, path: Path, itself: bool = True) -> None:
        for document in list(self.documents.values()):
            uses = document.analysis is not None and path in document.analysis.files
            if document.path == path and itself:
                self._start(document)
            elif uses and document.path != path:
                document.count += 1
                self._start(document)

    def texts(self, but: Path | None = None) -> dict[str, bytes]:
        others = (each for each in self.documents.values() if each.path != but)
        return {os.path.realpath(each.path): each.text.encode("utf-8", "replace") for each in others}

    async def analyzed(self, path: Path, newest: bool = False, *, traced: bool = False) -> Analysis | None:
        """Return the latest analysis of an open file, with `newest` for the current text, and `traced` if requested."""
        document = self.documents.get(path)
        if document is None or not document.kind:
            return None
        while document.analysis is None or (newest and document.done < document.count):
            if document.work is None and document.timer is not None:  # nobody waits for a pause any longer
                self._begin(document)
            if document.work is None:
                break
            await asyncio.wait([document.work])
        analysis = document.analysis
        if not traced or analysis is None or document.kind == "model":
            return analysis
        with_trace = await self._analyse(self.workspace.traced, analysis)
        if document.whole is analysis:
            document.whole = with_trace
        if document.analysis is analysis:
            document.analysis = with_trace
        return with_trace

    async def including(self, path: Path) -> list[Analysis]:
        return await self._analyse(self.workspace.including, path, self.texts())

    async def models_including(self, path: Path) -> list[tuple[Unit, str]]:
        def found() -> list[tuple[Unit, str]]:
            with unsaved(self.texts()):
                return list(including(path, self.folder))

        return await self._analyse(found)

    async def _analyse(self, work: Callable[..., T], *arguments: object) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._analysing, work, *arguments)

    async def using(self, path: Path) -> list[Analysis]:
        found = []
        for document in list(self.documents.values()):
            analysis = await self.analyzed(document.path, newest=True) if document.kind == "recipe" else None
            if analysis is not None and path in analysis.files:
                found.append(await self.analyzed(document.path, newest=True, traced=True) or analysis)
        return found

    def is_model(self, path: Path) -> bool:
        document = self.documents.get(path)
        return document is not None and document.kind == "model"

    def _start(self, document: OpenFile) -> None:
        document.stop()
        if not document.waits_for_pause:
            self._begin(document)
            return
        document.timer = asyncio.get_running_loop().call_later(PAUSE, self._begin, document)
        self._glance_at(document)

    def _begin(self, document: OpenFile) -> None:
        document.stop()
        if document.work is None or document.work.done():
            document.work = asyncio.get_running_loop().create_task(self._work(document))

    def _glance_at(self, document: OpenFile) -> None:
        if document.glancing is None or document.glancing.done():
            document.glancing = asyncio.get_running_loop().create_task(self._glance(document))

    async def _glance(self, document: OpenFile) -> None:
        """Report the certain faults of the newest text, as long as it is not analyzed."""
        while document.glanced < document.count and self.documents.get(document.path) is document:
            count = document.count
            text = document.text
            version = document.version
            whole = document.whole
            if whole is None:
                return
            try:
                glanced = await asyncio.get_running_loop().run_in_executor(self._glancing, glance, text, whole)
            except Exception:
                self._log(traceback.format_exc())
                return
            document.glanced = count
            if document.done < count and document.whole is whole and self.documents.get(document.path) is document:
                document.analysis = glanced
                document.seen = version
                self._report_found(document)

    async def _work(self, document: OpenFile) -> None:
        while document.done < document.count and self.documents.get(document.path) is document:
            if document.is_touched_again():
                break
            count = document.count
            text = document.text
            version = document.version
            try:
                if document.kind:
                    await self._analyze(document, text)
            except Exception:
                self._log(traceback.format_exc())
            document.done = count
            document.seen = version
            if document.is_touched_again():
                document.glanced = 0
                self._glance_at(document)
            elif document.kind and self.documents.get(document.path) is document:
                self._report_found(document)
        document.work = None
        if document.kind and not document.is_touched_again() and self.documents.get(document.path) is document:
            loop = asyncio.get_running_loop()
            document.timer = loop.call_later(PAUSE, lambda: loop.create_task(self._verify(document)))

    async def _analyze(self, document: OpenFile, text: str) -> None:
        work = self.workspace.analyze if document.kind == "recipe" else self.workspace.analyze_model
        given = document.path, text, self.texts(document.path), document.whole
        analysis, seconds = await self._analyse(_timed, work, *given)
        document.analysis = analysis
        document.whole = analysis
        document.seconds = seconds

    async def _verify(self, document: OpenFile) -> None:
        """Build a recipe with MuJoCo, or lint a model. The result is dropped if the text changes in the meantime."""
        analysis = document.analysis
        count = document.count
        texts = self.texts(document.path)
        is_model = isinstance(analysis, ModelAnalysis) and root_of(document.text) == "mujoco"
        if analysis is None or not (analysis.is_composed or is_model) or _has_errors(analysis.found):
            return
        models = {os.path.realpath(each) for each in analysis.files if each.suffix.lower() not in RECIPES}
        if not all(is_saved(path, text) for path, text in texts.items() if path in models):
            return  # MuJoCo reads the files on disk
        try:
            work = self.verifier.lint if is_model else self.verifier.verify
            given = document.path, document.text, texts
            found = await asyncio.get_running_loop().run_in_executor(self._verifying, work, *given)
        except Exception:
            self._log(traceback.format_exc())
            return
        if document.count == count and self.documents.get(document.path) is document:
            document.verified = found
            document.verified_lines = analysis.lines
            self._report_found(document)

    def _report_found(self, document: OpenFile) -> None:
        analysis = document.analysis
        if analysis is None:
            return
        lines = lines_of(analysis.text)
        document.verified = carried(document.verified, analysis.file, document.verified_lines, lines)
        document.verified_lines = lines
        found = list(analysis.found)
        if not _has_errors(found):  # with errors there is no model
            found += [each for each in document.verified if each not in found]
        uses = None if isinstance(analysis, ModelAnalysis) else uses_of(analysis)
        self._report(document.path, by_file(found, analysis.file, uses))

    def _report(self, path: Path, files: Mapping[str, list[Diagnostic]]) -> None:
        """Publish the diagnostics that changed. Diagnostics that several recipes report in one file are merged."""
        before = self._reported.get(path, {})
        self._reported[path] = dict(files)
        for file in dict.fromkeys([*before, *files]):
            self._publish(Path(os.path.normpath(self.folder / file)), once(self._found(file)))
        if path not in self.documents:
            self._reported.pop(path, None)

    async def holding(self, path: Path, found: Iterable[Diagnostic]) -> list[Diagnostic]:
        """Return diagnostics about a file, without the fixes that do not hold in every recipe that reports them."""
        file = shown(path, self.folder)
        kept = []
        for each in found:
            reporting = [
                self.documents.get(own) for own, files in self._reported.items() if each in files.get(file, ())
            ]
            holds = [await self._holds(document, each) for document in reporting if document and each.fix is not None]
            kept.append(each if all(holds) else replace(each, fix=None))
        return kept

    async def _holds(self, document: OpenFile, diagnostic: Diagnostic) -> bool:
        count = document.count
        if document.tried[0] != count:
            document.tried = (count, {})
        known = document.tried[1]
        if diagnostic not in known:
            given = document.path, document.text, self.texts(document.path), diagnostic
            try:
                known[diagnostic] = await asyncio.get_running_loop().run_in_executor(
                    self._verifying, self.verifier.holds, *given
                )
            except Exception:
                self._log(traceback.format_exc())
                return False
        return known[diagnostic]

    def found(self, path: Path) -> list[Diagnostic]:
        return self._found(shown(path, self.folder))

    def _found(self, file: str) -> list[Diagnostic]:
        return [each for reported in self._reported.values() for each in reported.get(file, ())]

    async def shut(self) -> None:
        for document in self.documents.values():
            document.stop()
        self._glancing.shutdown(wait=False, cancel_futures=True)
        self._analysing.shutdown(wait=False, cancel_futures=True)
        self._verifying.shutdown(wait=False, cancel_futures=True)
        self.end()

    def end(self) -> None:
        """End the processes that work for this process, and remove their folders."""
        self.workspace.close()
        self.verifier.close()

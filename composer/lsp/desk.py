"""The documents that are open in an editor, and when they are analysed: at once, and with MuJoCo after a pause."""

from __future__ import annotations

import asyncio
import os
import re
import traceback
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import field
from pathlib import Path

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.lsp.analysis import Analysis, shown
from composer.lsp.files import is_saved
from composer.lsp.lines import lines_of
from composer.lsp.reports import by_file, carried, together, uses_of
from composer.lsp.verifier import Verifier
from composer.lsp.workspace import RECIPES, Workspace, is_recipe

PAUSE = 0.4
"""How many seconds nothing is typed before MuJoCo is asked."""
_MODELS = (".xml", ".mjcf")
_MODEL = re.compile(r"<mujoco[\s>]")
"""What makes a file a model by itself; `<mujocoinclude>` is there to be included."""


@dataclass(eq=False)
class Document:
    """An open file. `kind` is `recipe`, `model`, or empty as long as it is neither.

    The texts of a document are numbered: `count` is the newest one, and `done` the one that was analysed. `version`
    is the editor's own number of the newest text, `seen` that of the analysed one.
    """

    path: Path
    text: str
    kind: str
    version: int | None = None
    seen: int | None = None
    count: int = 1
    done: int = 0
    analysis: Analysis | None = None
    verified: tuple[Diagnostic, ...] = ()
    verified_lines: list[str] = field(default_factory=list)
    work: asyncio.Task[None] | None = None
    timer: asyncio.TimerHandle | None = None
    _lines: tuple[str, list[str]] = ("", [""])

    @property
    def lines(self) -> list[str]:
        if self._lines[0] != self.text:
            self._lines = self.text, lines_of(self.text)
        return self._lines[1]


class Desk:
    """The open documents by path.

    `publish` is called with a file and its diagnostics, and `log` with an error message. Everything runs in the
    thread of the event loop, except for `Workspace` and `Verifier`, which have one thread each.
    """

    def __init__(
        self,
        folder: Path,
        publish: Callable[[Path, list[Diagnostic]], None],
        log: Callable[[str], None],
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self.folder = folder
        self.documents: dict[Path, Document] = {}
        self.workspace, self.verifier = Workspace(folder), Verifier(folder)
        self._publish, self._log, self._changed = publish, log, changed
        self._analysing = ThreadPoolExecutor(1, "analysis")
        self._verifying = ThreadPoolExecutor(1, "verification")
        self._reported: dict[Path, dict[str, list[Diagnostic]]] = {}

    # -- documents ---------------------------------------------------------------------------------------------

    def take(self, path: Path, text: str, version: int | None = None) -> None:
        """Add a document that an editor has opened."""
        self.documents[path] = Document(path, text, _kind(path, text), version)
        self._touched(path)

    def change(self, path: Path, text: str, version: int | None = None) -> None:
        document = self.documents[path]
        document.text, document.version, document.count = text, version, document.count + 1
        if document.kind == "":
            document.kind = _kind(path, text)
        self._touched(path)

    def close(self, path: Path) -> None:
        document = self.documents.pop(path, None)
        if document is not None:
            if document.timer is not None:
                document.timer.cancel()
            self._report(path, {})
            self.changed_on_disk([path])

    def changed_on_disk(self, paths: Iterable[Path]) -> None:
        """Analyse the recipes again that use any of these files."""
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
        """Return the texts of the open documents as bytes, by real path."""
        return {
            os.path.realpath(each.path): each.text.encode("utf-8", "replace")
            for each in self.documents.values()
            if each.path != but
        }

    # -- analysis ----------------------------------------------------------------------------------------------

    async def analysed(self, path: Path, newest: bool = False, *, traced: bool = False) -> Analysis | None:
        """Return the latest analysis of an open recipe. With `newest`, wait for that of the current text.

        With `traced`, it knows where the elements of the model come from.
        """
        document = self.documents.get(path)
        if document is None or document.kind != "recipe":
            return None
        while document.work is not None and (
            document.analysis is None or (newest and document.done < document.count)
        ):
            await asyncio.wait([document.work])
        analysis = document.analysis
        if not traced or analysis is None:
            return analysis
        whole = await asyncio.get_running_loop().run_in_executor(
            self._analysing, self.workspace.traced, analysis
        )
        if document.analysis is analysis:
            document.analysis = whole
        return whole

    async def including(self, path: Path) -> list[Analysis]:
        """Return the recipes of the workspace that mention a recipe, and so may include it."""
        return await asyncio.get_running_loop().run_in_executor(
            self._analysing, self.workspace.including, path, self.texts()
        )

    async def using(self, path: Path) -> list[Analysis]:
        """Return the open recipes that use a model."""
        found = []
        for document in list(self.documents.values()):
            analysis = await self.analysed(document.path, newest=True)
            if analysis is not None and path in analysis.files:
                found.append(await self.analysed(document.path, newest=True, traced=True) or analysis)
        return found

    def is_model(self, path: Path) -> bool:
        document = self.documents.get(path)
        return document is not None and document.kind == "model"

    def _start(self, document: Document) -> None:
        if document.timer is not None:
            document.timer.cancel()
        if document.work is None or document.work.done():
            document.work = asyncio.get_running_loop().create_task(self._work(document))

    async def _work(self, document: Document) -> None:
        loop = asyncio.get_running_loop()
        while document.done < document.count and self.documents.get(document.path) is document:
            count, text, version = document.count, document.text, document.version
            try:
                if document.kind == "recipe":
                    document.analysis = await loop.run_in_executor(
                        self._analysing, self.workspace.analyse, document.path, text, self.texts(document.path),
                        document.analysis,
                    )  # fmt: skip
                elif document.kind == "model":
                    document.seen = version
                    found = await loop.run_in_executor(
                        self._analysing, self.workspace.check_model, document.path, text
                    )
                    self._report(document.path, by_file(found, shown(document.path, self.folder)))
            except Exception:
                self._log(traceback.format_exc())
            document.done, document.seen = count, version
            if document.kind == "recipe" and self.documents.get(document.path) is document:
                self._report_recipe(document)
        document.work = None
        self._changed()
        if document.kind == "recipe" and self.documents.get(document.path) is document:
            document.timer = loop.call_later(PAUSE, lambda: loop.create_task(self._verify(document)))

    async def _verify(self, document: Document) -> None:
        """Build with MuJoCo. The result is dropped if the text has changed in the meantime."""
        analysis, count, texts = document.analysis, document.count, self.texts(document.path)
        if analysis is None or not analysis.is_composed or not self._are_saved(analysis, texts):
            return
        try:
            found = await asyncio.get_running_loop().run_in_executor(
                self._verifying, self.verifier.verify, document.path, document.text, texts
            )
        except Exception:
            self._log(traceback.format_exc())
            return
        if document.count == count and self.documents.get(document.path) is document:
            document.verified, document.verified_lines = found, analysis.lines
            self._report_recipe(document)

    def _are_saved(self, analysis: Analysis, texts: Mapping[str, bytes]) -> bool:
        """Return whether all models of a recipe are saved as the editor has them. MuJoCo reads the files on disk."""
        used = {os.path.realpath(each) for each in analysis.files if each.suffix.lower() not in RECIPES}
        return all(is_saved(path, text) for path, text in texts.items() if path in used)

    # -- reports -----------------------------------------------------------------------------------------------

    def _report_recipe(self, document: Document) -> None:
        analysis = document.analysis
        if analysis is None:
            return
        lines = lines_of(analysis.text)
        document.verified = carried(document.verified, analysis.file, document.verified_lines, lines)
        document.verified_lines = lines
        found = together(analysis.found, document.verified)
        self._report(document.path, by_file(found, analysis.file, uses_of(analysis)))

    def _report(self, path: Path, files: Mapping[str, list[Diagnostic]]) -> None:
        """Publish the diagnostics that changed. Those that several recipes report in one file are merged."""
        before = self._reported.get(path, {})
        self._reported[path] = dict(files)
        for file in dict.fromkeys([*before, *files]):
            found = [each for reported in self._reported.values() for each in reported.get(file, ())]
            self._publish(Path(os.path.normpath(self.folder / file)), list(dict.fromkeys(found)))
        if path not in self.documents:
            self._reported.pop(path, None)

    def found(self, path: Path) -> list[Diagnostic]:
        """Return the diagnostics of a file."""
        file = shown(path, self.folder)
        return [each for reported in self._reported.values() for each in reported.get(file, ())]

    async def shut(self) -> None:
        """Stop all work. Requests get no answers after this."""
        for document in self.documents.values():
            if document.timer is not None:
                document.timer.cancel()
        self._analysing.shutdown(wait=False, cancel_futures=True)
        self._verifying.shutdown(wait=False, cancel_futures=True)
        self.end()

    def end(self) -> None:
        """End the processes that work for this one, and remove their folders."""
        self.workspace.close()
        self.verifier.close()


def _kind(path: Path, text: str) -> str:
    if is_recipe(path, text):
        return "recipe"
    return "model" if path.suffix.lower() in _MODELS and _MODEL.search(text[:20_000]) else ""

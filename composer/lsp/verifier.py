"""MuJoCo's verdict on an open recipe and its checks, found in the background in a process of its own."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from composer.context import Context
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import TooManyFaults
from composer.engine import Session
from composer.lsp.shelf import Shelf
from composer.reading.unsaved import unsaved
from composer.sources.fetching import Fetching
from composer.stages import Request, build


class Verifier:
    """Builds recipes as `check` does, with one process of MuJoCo for all. It must be used from one thread only."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._shelf = Shelf()
        self._session = Session(remembers=True)

    def close(self) -> None:
        self._session.close()

    def verify(self, path: Path, text: str, texts: Mapping[str, bytes]) -> tuple[Diagnostic, ...]:
        """Return all diagnostics that `check` would report."""
        context = Context(folder=self.folder, fetching=Fetching(offline=True))
        with unsaved({**texts, os.path.realpath(path): text.encode("utf-8", "replace")}):
            self._shelf.refresh(texts)
            try:
                build(Request(path), context, session=self._session, library=self._shelf.library)
            except TooManyFaults as too_many:
                context.sink = too_many.sink
            self._shelf.note(texts)
        return tuple(context.sink.sorted())

"""Build the model that a server shows, again and again, in one engine."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import field
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING

from composer.context import Context
from composer.dataclass import dataclass
from composer.diff.operand import Operand, read_operand
from composer.diff.side import Side, load
from composer.render.given import check_given
from composer.view.asked import Asked, choices
from composer.view.description import described
from composer.view.watching import hopes

if TYPE_CHECKING:
    from composer.engine import Session

KEPT = "view"
EDITOR = "vscode://file{file}:{line}:{column}"


@dataclass(slots=True)
class Shown:
    """The state of a page: the last good model, and the current fault, if there is one.

    `version` counts the models. `blobs` has everything that its text refers to.
    """

    version: int = -1
    text: str = ""
    blobs: dict[str, bytes] = field(default_factory=dict)
    title: str = ""
    fault: str | None = None
    seconds: float = 0.0


class Workshop:
    """Builds the models that the page shows.

    `open` returns a new context for each build, `words` the terminal's text for its faults. `lock` is held while
    the engine works; `shown` and `inputs`, the files to watch, are replaced as a whole.
    """

    def __init__(
        self,
        target: str,
        asked: Asked,
        session: Session,
        open: Callable[[], Context],
        words: Callable[[Context], str],
        key: str | None = None,
        editor: str = EDITOR,
    ) -> None:
        self.target, self.asked, self.session = target, asked, session
        self.key, self.editor = key, editor
        self._open, self._words = open, words
        self.lock = RLock()
        self.shown = Shown()
        self.inputs: frozenset[Path] = frozenset()

    def choose(self, name: str, value: str) -> None:
        """Show another model of the recipe."""
        with self.lock:
            self.asked = self.asked.choosing(name, value)
            self.build()

    def build(self) -> Shown:
        """Build and show the result; after a fault the previous model stays."""
        with self.lock, ExitStack() as opened:
            started = time.monotonic()
            context = self._open()
            operand = read_operand(self.target, context, opened)
            made, is_new, old = None, False, self.shown
            if operand is not None:
                made = self._made(operand)
                is_new = made is not None and self._describe(made, operand, old)
                operand.report(context.sink)
            self._watch(operand, made, context)
            if not is_new:
                self.shown = Shown(
                    old.version, old.text, old.blobs, title=old.title, fault=self._words(context)
                )
            self.shown.seconds = time.monotonic() - started
            return self.shown

    def _made(self, operand: Operand) -> Side | None:
        asked = self.asked
        if not check_given(operand, asked.given):
            return None
        side = load(operand, KEPT, self.session, given=asked.given, pick=asked.pick, sample=asked.sample)
        return None if operand.context.sink.has_errors else side

    def _describe(self, side: Side, operand: Operand, old: Shown) -> bool:
        menus = choices(operand, self.asked)
        found = described(
            side, self.session, old.blobs, editor=self.editor, key_named=self.key, choices=menus
        )
        if found is None or (old.version < 0 and not found.has_key(self.key, operand.context.sink)):
            return False
        blobs = {name: found.blobs.get(name) or old.blobs[name] for name in found.used}
        self.shown = Shown(old.version + 1, found.text, blobs, title=found.title)
        return True

    def _watch(self, operand: Operand | None, side: Side | None, context: Context) -> None:
        """Watch the inputs of the model; after a fault also the previous ones, which may fix it."""
        files = {context.folder / self.target, *hopes(context)}
        if side is not None:
            files |= {context.folder / path for path in side.inputs}
        else:
            files |= self.inputs
        lock = None if operand is None else operand.path.with_suffix(".lock")
        if lock is not None:
            files.add(context.folder / lock)
        self.inputs = frozenset(files)

"""The model that a server shows, built again when a file changes."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import field, replace
from importlib import import_module
from pathlib import Path
from threading import Event, RLock
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import Mark, mark_of, read_regular
from mjcompose.base.limits import in_force
from mjcompose.mujoco.engine import Session
from mjcompose.sides.operand import Operand, read_operand
from mjcompose.sides.side import Side, load
from mjcompose.sources.context import Context
from mjcompose.text.node import texts
from mjcompose.tools.view.page import ViewChoice, choices, described, parameters
from mjcompose.tools.view.render import check_given
from mjcompose.tools.view.targets import MovableItems, movable

POLL_SECONDS = 0.15
_SETTLE_SECONDS = 0.02


def marks(files: Iterable[Path]) -> dict[Path, Mark]:
    return {file: mark_of(file) for file in files}


def hopes(context: Context) -> Iterator[Path]:
    """Yield files that may fix a fault although they were not read: files that recipes name, and files with faults."""
    for recipe, read in context.recipes.items():
        yield context.folder / recipe
        if read.node is not None:
            named = (text for text in texts(read.node) if text.startswith(("./", "../")))
            yield from (context.folder / recipe.parent / text.partition("#")[0] for text in named)
    yield from (context.folder / each.span.file for each in context.sink.diagnostics if each.span is not None)


class FileWatch:
    """Waits for changes, with `watchfiles` if it is installed, and otherwise by polling.

    It watches folders instead of files, because many editors replace a file by renaming.
    """

    def __init__(self, stop: Event) -> None:
        self.stop = stop
        try:
            self._watchfiles: Any = import_module("watchfiles")
        except ImportError:
            self._watchfiles = None

    def wait(self, before: dict[Path, Mark]) -> bool:
        """Return True as soon as a file is not as `before`; False once `stop` is set."""
        while not self.stop.is_set() and marks(before) == before:
            self._sleep({file.parent for file in before})
        self.stop.wait(_SETTLE_SECONDS)  # the editor may not be done yet
        return not self.stop.is_set()

    def _sleep(self, folders: set[Path]) -> None:
        """Wait until something happens in the folders, or for a while if that cannot be observed."""
        there = [folder for folder in folders if os.path.isdir(folder)]
        if self._watchfiles is None or not there:
            self.stop.wait(POLL_SECONDS)
            return
        # Network drives and sleeping laptops lose events, so look every few seconds.
        with contextlib.suppress(OSError):
            seen = self._watchfiles.watch(
                *there,
                watch_filter=None,
                recursive=False,
                stop_event=self.stop,
                debounce=50,
                step=10,
                rust_timeout=2000,
                yield_on_timeout=True,
                raise_interrupt=False,
            )
            next(seen, None)
            return
        self.stop.wait(POLL_SECONDS)


KEPT = "view"
EDITOR = "vscode://file{file}:{line}:{column}"


class PageFault(Struct):
    """One diagnostic for the page: its text in the terminal, its place, and the new text of the file if a fix is known.

    `place` is the start of the text. `source` is the text that was read, and `words` name the fix.
    """

    text: str
    place: str = ""
    file: str = ""
    path: Path | None = None
    line: int = 1
    column: int = 1
    source: str = ""
    fixed: str | None = None
    words: str = ""


class Shown(Struct, frozen=False):
    """The last good model with its blobs, and the current fault, if any. `version` counts the models."""

    version: int = -1
    text: str = ""
    blobs: dict[str, bytes] = field(default_factory=dict)
    title: str = ""
    fault: str | None = None
    faults: tuple[PageFault, ...] = ()
    seconds: float = 0.0
    targets: MovableItems = MovableItems()


class Workshop:
    """Builds the models that the page shows.

    `open` returns a new context for each build. `words` returns the terminal's text for its faults, and `faults` yields
    each of them with its place and its fix. A build takes `lock` while the engine works. `shown` and `inputs`, the
    files to watch, are replaced as a whole. If it `writes`, the page gets a table of movable elements.
    """

    def __init__(
        self,
        target: str,
        asked: ViewChoice,
        session: Session,
        open: Callable[[], Context],
        words: Callable[[Context], str],
        key: str | None = None,
        editor: str = EDITOR,
        faults: Callable[[Context], Iterable[PageFault]] = lambda context: (),
    ) -> None:
        self.target = target
        self.asked = asked
        self.session = session
        self.key = key
        self.editor = editor
        self.writes = False
        self._open = open
        self._words = words
        self._faults = faults
        self.recipe: Path | None = None
        self.lock = RLock()
        self.shown = Shown()
        self.inputs: frozenset[Path] = frozenset()

    def choose(self, name: str, value: str | float) -> None:
        with self.lock:
            self.asked = self.asked.choosing(name, value)
            self.build()

    def build(self) -> Shown:
        """Build and show the result; after a fault the previous model stays."""
        with self.lock, ExitStack() as opened:
            started = time.monotonic()
            context = self._open()
            self.recipe = context.folder / self.target
            asked = self.asked
            before = (time.time_ns(), marks(self.inputs))
            operand = read_operand(self.target, context, opened)
            made = None
            is_new = False
            old = self.shown
            if operand is not None and check_given(operand, asked.given):
                made = load(operand, KEPT, self.session, given=asked.given, pick=asked.pick, sample=asked.sample)
                made = None if operand.context.sink.has_errors else made
                is_new = made is not None and self._describe(made, operand, old, before=before)
            if operand is not None:
                operand.report(context.sink)
            self._watch(operand, made, context)
            if not is_new:
                self.shown = replace(old, fault=self._words(context), faults=tuple(self._faults(context)))
            self.shown.seconds = time.monotonic() - started
            return self.shown

    def _describe(self, side: Side, operand: Operand, old: Shown, before: tuple[int, dict[Path, Mark]]) -> bool:
        menus = choices(operand, self.asked)
        targets = MovableItems()

        def extend(scene: dict[str, Any]) -> None:
            nonlocal targets
            if self.writes:
                scene["move"], targets = movable(side, scene, _recipes(operand.context, before))
                scene["move"]["version"] = old.version + 1

        found = described(
            side,
            self.session,
            old.blobs,
            editor=self.editor,
            extend=extend,
            key_named=self.key,
            choices=menus,
            params=parameters(operand, self.asked),
        )
        if found is None or (old.version < 0 and not found.has_key(self.key, operand.context.sink)):
            return False
        blobs = {name: found.blobs.get(name) or old.blobs[name] for name in found.used}
        self.shown = Shown(old.version + 1, found.text, blobs, title=found.title, targets=targets)
        return True

    def _watch(self, operand: Operand | None, side: Side | None, context: Context) -> None:
        """Watch the inputs of the model and, after a fault, also the previous inputs, which may fix it."""
        files = {context.folder / self.target, *hopes(context)}
        files |= self.inputs if side is None else {context.folder / path for path in side.inputs}
        if operand is not None:
            files.add(context.folder / operand.path.with_suffix(".lock"))
        self.inputs = frozenset(files)


def _recipes(context: Context, before: tuple[int, dict[Path, Mark]]) -> dict[str, bytes | None]:
    """Return the recipes of a build by their name in messages, each with its text, or None if it may have changed.

    `before` are the time when the build began, and the marks of files then.
    """
    begun, earlier = before
    found: dict[str, bytes | None] = {}
    for recipe, read in context.recipes.items():
        for path in (context.folder / recipe, *(source.path for source, _ in read.extended)):
            mark = mark_of(path)
            text = None
            with contextlib.suppress(OSError):
                text = read_regular(path, in_force().recipe_size)
                is_same = earlier.get(path) == mark or os.stat(path).st_mtime_ns < begun
                text = text if is_same and mark_of(path) == mark else None
            found[context.shown(path)] = text
    return found

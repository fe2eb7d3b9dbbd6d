"""`--watch`: run the command again whenever a file changes that it read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import wraps
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

import click

from mjcompose.cli.reporting import USAGE, clear_progress, is_quiet, note_files, noted_files

if TYPE_CHECKING:
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.view.builder import Mark

_PATIENCE = 0.5
_SESSIONS = "mjcompose.sessions"


def watch_option(command: Callable[..., None]) -> Callable[..., None]:
    """Add `--watch`; the command does not get it, and runs until the user interrupts it."""

    @wraps(command)
    def watched(watch: bool, **given: Any) -> None:
        if watch:
            _again_and_again(lambda: command(**given), _named(given))
        else:
            command(**given)

    help = "Run again whenever a file that was read changes. Stop with Ctrl-C."
    return click.option("--watch", is_flag=True, help=help)(watched)


@contextmanager
def session_of_run(*, remembers: bool) -> Iterator[Session]:
    """Yield a session for MuJoCo. With `--watch` all runs have the same one, which remembers assets."""
    from mjcompose.mujoco.engine import Session

    kept = click.get_current_context().meta.get(_SESSIONS)
    if kept is None:
        with Session(remembers=remembers) as session:
            yield session
        return
    opened, sessions = kept
    if not sessions:
        sessions.append(opened.enter_context(Session(remembers=True)))
    yield sessions[0]


def _named(given: dict[str, Any]) -> list[Path]:
    """Return the recipes given to the command, and their locks."""
    recipes = [path for key in ("recipe", "recipes") for path in _listed(given.get(key))]
    return [path for recipe in recipes for path in (recipe, recipe.with_suffix(".lock"))]


def _listed(value: Any) -> tuple[Path, ...]:
    if value is None:
        return ()
    return value if isinstance(value, tuple) else (value,)


def _again_and_again(command: Callable[[], None], named: list[Path]) -> None:
    from mjcompose.sources.blobs import let_go
    from mjcompose.tools.view.builder import marks

    before: dict[Path, Mark] = {}
    opened = ExitStack()
    click.get_current_context().meta[_SESSIONS] = opened, []
    try:
        while True:
            started = marks([*before, *named])
            note_files(named)
            code = _code(command)
            let_go()
            if code == USAGE and not before:  # there is nothing to watch
                raise SystemExit(code)
            files = [Path.cwd() / path for path in noted_files()]
            before = {path: started.get(path, mark) for path, mark in marks(files).items()}
            if not is_quiet():
                clear_progress()
                click.echo(f"watching {len(before)} files; Ctrl-C ends it", err=True)
            _wait(before)
    except KeyboardInterrupt:
        clear_progress()
    finally:
        opened.close()


def _code(command: Callable[[], None]) -> int:
    try:
        command()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else 1
    return 0


def _wait(before: dict[Path, Mark]) -> None:
    """Wait until a file has changed.

    In a thread of its own, because a watch swallows the signal that ends a command.
    """
    from concurrent.futures import ThreadPoolExecutor

    from mjcompose.tools.view.builder import Watch

    stop, done = Event(), Event()
    # Set up what stops the thread before it starts: otherwise an interrupt at that moment would wait for it
    # forever.
    with ThreadPoolExecutor(1) as executor, ExitStack() as at_the_end:
        at_the_end.callback(stop.set)
        executor.submit(Watch(stop).wait, before).add_done_callback(lambda _: done.set())
        while not done.wait(_PATIENCE):
            pass

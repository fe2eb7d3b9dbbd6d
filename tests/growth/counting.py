"""Counts the Python functions that a command calls, in this process and in MuJoCo's child, which runs here, too."""

from __future__ import annotations

import json
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import mujoco
import pytest
from mjcompose.mujoco import child
from mjcompose.mujoco.engine import Session


class Calls:
    """The number of Python functions that were called in all threads."""

    def __init__(self) -> None:
        self.count = 0

    def _note(self, _frame: FrameType, event: str, _argument: Any) -> None:
        if event == "call":
            self.count += 1

    @contextmanager
    def counting(self) -> Iterator[None]:
        threading.setprofile(self._note)
        sys.setprofile(self._note)
        try:
            yield
        finally:
            sys.setprofile(None)
            threading.setprofile(None)


def calls_of(action: Callable[[], object]) -> int:
    """Return the number of Python functions that `action` calls."""
    calls = Calls()
    with calls.counting():
        action()
    return calls.count


def answer_here(patch: pytest.MonkeyPatch) -> None:
    """Let the requests to MuJoCo's child be answered in this process, where their calls can be counted."""
    kept: dict[int, dict[str, Any]] = {}

    def start(session: Session) -> None:
        session.mujoco_version = mujoco.__version__
        if session._folder is None:
            session._folder = Path(session._held.enter_context(tempfile.TemporaryDirectory()))

    def exchange(session: Session, line: str, _seconds: float) -> dict[str, Any]:
        request = json.loads(line)
        answer = child._call if "function" in request else child._compile
        return {**answer(request, mujoco, kept.setdefault(id(session), {})), "warnings": []}

    patch.setattr(Session, "begin", lambda session: None)
    patch.setattr(Session, "_start", start)
    patch.setattr(Session, "_exchange", exchange)

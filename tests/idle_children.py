"""Child processes that wait for the next session: starting Python and MuJoCo is most of what a small test costs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from subprocess import Popen
from typing import Any

import pytest
from mjcompose.base.processes import module_path
from mjcompose.mujoco.engine import Session

Key = tuple[object, ...]
State = dict[str, Any]


class IdleChildren:
    """Keeps the child of each session that ended well, for a session that would start one just like it."""

    def __init__(self) -> None:
        self._start = Session._start
        self._close = Session.close
        self._standing = Session.standing
        self._waiting: dict[Key, list[State]] = {}
        self._keys: dict[Popen[str], Key] = {}

    def lend(self, patch: pytest.MonkeyPatch) -> None:
        """Let sessions take and return children until the patch is undone."""
        patch.setattr(Session, "begin", lambda session: None)  # one that waits is ready already
        patch.setattr(Session, "_start", lambda session: self._take_or_start(session))
        patch.setattr(Session, "standing", lambda session, name: self._take_to_stand(session, name))
        patch.setattr(Session, "close", lambda session: self._return_or_close(session))

    def close(self) -> None:
        """End all of them."""
        for state in [state for waiting in self._waiting.values() for state in waiting]:
            session = Session()
            vars(session).update(state)
            self._close(session)

    def _take_or_start(self, session: Session) -> dict[str, Any] | None:
        key = self._take(session)
        failure = self._start(session)
        if session._process is not None:
            self._keys.setdefault(session._process, key)
        return failure

    def _take_to_stand(self, session: Session, name: str) -> Path:
        self._take(session)
        return self._standing(session, name)

    def _take(self, session: Session) -> Key:
        key = _key(session)
        waiting = self._waiting.get(key)
        if session._folder is None and session._shelf is None and waiting:
            vars(session).update(waiting.pop())
        return key

    def _return_or_close(self, session: Session) -> None:
        process = session._process
        key = None if process is None or process.poll() is not None else self._keys.get(process)
        # With an exception under way, the child may be in the middle of a request.
        if key is None or sys.exc_info()[0] is not None:
            self._close(session)
            return
        state = vars(session).copy()
        vars(session).update(vars(Session(session.limits, rendering=session.rendering, remembers=session.remembers)))
        self._waiting.setdefault(key, []).append(state)


def _key(session: Session) -> Key:
    """What a child is started with."""
    graphics = os.environ.get("MUJOCO_GL")
    return (session.limits, session.rendering, session.remembers, graphics, sys.executable, tuple(module_path()))

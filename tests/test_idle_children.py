"""Sessions of tests hand their children on, unless something may be wrong with them."""

from __future__ import annotations

from pathlib import Path
from subprocess import Popen

import pytest
from mjcompose.mujoco.engine import CompileRequest, RequestLimits, Session


def _child(session: Session, folder: Path) -> Popen[str]:
    assert session.ask(CompileRequest(folder, text="<mujoco/>"))[0]["ok"]
    assert session._process is not None
    return session._process


def test_a_child_is_handed_on_to_who_would_start_one_like_it(tmp_path: Path) -> None:
    with Session() as session:
        first = _child(session, tmp_path)
    with Session() as session, Session() as beside, Session(RequestLimits(seconds=60)) as limited:
        assert _child(session, tmp_path) is first
        assert _child(beside, tmp_path) is not first
        assert _child(limited, tmp_path) is not first


def test_a_child_that_may_be_in_the_middle_of_something_ends(tmp_path: Path) -> None:
    with pytest.raises(KeyError), Session() as session:
        child = _child(session, tmp_path)
        raise KeyError
    assert child.poll() is not None


@pytest.mark.own_children
def test_who_asks_for_it_starts_and_ends_its_own(tmp_path: Path) -> None:
    with Session() as session:
        child = _child(session, tmp_path)
    assert child.poll() is not None

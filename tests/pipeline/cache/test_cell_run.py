from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.builder import Maker
from mjcompose.pipeline.cache.cache_key import BuildOptions
from mjcompose.pipeline.cache.cell_run import CellMaker, Job
from mjcompose.sources.context import Context


@pytest.mark.own_children
@pytest.mark.parametrize("verified", [True, False])
def test_mujoco_starts_before_the_first_cell_is_asked_for(tmp_path: Path, verified: bool) -> None:
    maker = Maker(tmp_path / "recipe.yaml", BuildOptions(verified=verified), None, Context(folder=tmp_path))
    with Session() as session:
        making = CellMaker(maker, {}, session)
        making.begin()
        assert (session._process is not None) is verified


@pytest.mark.own_children
def test_mujoco_of_a_worker_starts_when_the_worker_knows_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Session] = []
    monkeypatch.setattr(Session, "begin", lambda session: begun.append(session))
    maker = Maker(tmp_path / "recipe.yaml", BuildOptions(), None, Context(folder=tmp_path))
    with Session() as session, Job.of(CellMaker(maker, {}, session)).opened():
        assert len(begun) == 1 and begun[0] is not session

"""A session that remembers files: faster, and never with bytes that are no more."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mjcompose.bundle.bundle import Bundle
from mjcompose.mujoco import engine
from mjcompose.verify.compile import verify

OBJ = "v 0 0 0\nv {} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MODEL = """<mujoco><compiler {}/><option timestep="{}"/><asset><mesh name="m" file="m.obj" {}/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="m" density="{}"/></body></worldbody></mujoco>"""


def bundle(x: float = 1, *, compiler: str = "", step: float = 0.01, mesh: str = "", density: int = 1000) -> Bundle:
    text = MODEL.format(compiler, step, mesh, density)
    return Bundle({"model.xml": text.encode(), "m.obj": OBJ.format(x).encode()})


def facts(mujoco: Any, model: Any, asked: Any) -> list[float]:
    """What the model says, for `mjcompose.mujoco.engine.call`."""
    return [float(model.opt.timestep), float(model.body_mass[1]), *model.geom_rbound.tolist()]


def remembered(mujoco: Any, asked: Any) -> int:
    """How many bytes MuJoCo has in its cache."""
    try:
        return int(mujoco.mj_getCacheSize(mujoco.mj_getCache()))
    except AttributeError:
        return -1


@pytest.fixture(scope="module")
def plain() -> Iterator[engine.Session]:
    with engine.Session() as session:
        yield session


@pytest.fixture
def session() -> Iterator[engine.Session]:
    with engine.Session(remembers=True) as session:
        yield session


def _facts(bundle: Bundle, session: engine.Session) -> list[float]:
    verified = verify(bundle, session=session, keep="it")
    assert verified.ok, verified.error
    found: list[float] = engine.call(session, facts, ["it"], None).value
    return found


def test_what_differs_is_never_what_was_remembered(session: engine.Session, plain: engine.Session) -> None:
    every = [
        bundle(),
        bundle(step=0.002),
        bundle(density=2000),
        bundle(2),
        bundle(3),
        bundle(mesh='scale="4 1 1"'),
        bundle(mesh='scale="5 1 1"'),
        bundle(compiler='boundmass="9000"'),
        bundle(mesh='inertia="shell"'),
        bundle(),
    ]
    found = [_facts(each, session) for each in every]
    assert found == [_facts(each, plain) for each in every]
    assert len({tuple(each) for each in found}) == len(every) - 1


def test_files_are_remembered_only_where_they_stand(
    session: engine.Session, plain: engine.Session, tmp_path: Path
) -> None:
    _facts(bundle(), plain)
    none = engine.call(plain, remembered, [], None).value
    if none < 0:
        pytest.skip("this MuJoCo has no cache")
    _facts(bundle(), session)
    assert none == 0 < engine.call(session, remembered, [], None).value
    for path, content in bundle().files.items():
        (tmp_path / path).write_bytes(content)
    assert engine.compile(tmp_path, session=session).ok
    assert engine.call(session, remembered, [], None).value == 0


def test_another_folder_has_the_bytes_that_it_has_now(plain: engine.Session, tmp_path: Path) -> None:
    """Also where path and time are those of a file that was there before."""
    found = []
    for x in (1, 2):
        for path, content in bundle(x).files.items():
            (tmp_path / path).write_bytes(content)
            os.utime(tmp_path / path, (1e9, 1e9))
        found.append(engine.measure(tmp_path, arrays=["geom_rbound"], session=plain).arrays["geom_rbound"].tolist())
    assert found[0] != found[1]


def test_one_folder_stands(session: engine.Session) -> None:
    first, again, other = (_standing(each, session) for each in (bundle(), bundle(step=0.5), bundle(7)))
    assert first == again != other
    assert other.is_dir() and not first.exists()


def test_a_material_is_no_file(session: engine.Session) -> None:
    red, green = (f'/><material name="paint" rgba="{rgba}"' for rgba in ("1 0 0 1", "0 1 0 1"))
    assert _standing(bundle(mesh=red), session) == _standing(bundle(mesh=green), session)


def _standing(bundle: Bundle, session: engine.Session) -> Path:
    _facts(bundle, session)
    assert session._shelf is not None
    (folder,) = session._shelf.iterdir()
    return folder

"""Every model of the packages that tests need, and a sample of the corpus: read, written, the same to the bit.

All of the corpus is for `make fidelity`.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fidelity import corpus as corpora
from fidelity.roundtrip import travel

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")
EVERY = 12
FILES = [(root, path) for root, paths in corpora.packaged() for path in paths]
SAMPLE = [(Path(FOLDER), path) for path in corpora.models(Path(FOLDER))[::EVERY]] if FOLDER else []


def _name(value: Path) -> str:
    return "/".join(value.parts[-3:])


@pytest.mark.skipif(not FILES, reason="no package with models is installed")
def test_packages_have_models_that_load() -> None:
    assert any(travel(path, root, rivals=False).loads for root, path in FILES[:3])


@pytest.mark.parametrize(("root", "path"), FILES + SAMPLE, ids=_name)
def test_what_is_written_is_what_was_read(root: Path, path: Path) -> None:
    trip = travel(path, root, rivals=False)
    if not trip.loads:
        pytest.skip("MuJoCo does not load it by itself")
    assert not trip.error
    assert not trip.different


def test_a_fragment_is_no_model(tmp_path: Path) -> None:
    path = tmp_path / "fragment.xml"
    path.write_text('<mujoco><body name="a"><geom size="1"/></body></mujoco>')
    assert not travel(path, tmp_path, rivals=False).loads


def test_mujoco_reads_and_writes_what_it_can_write(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')
    assert travel(path, tmp_path).mjspec
    path.write_text('<mujoco><worldbody><geom size="1.0001234567"/></worldbody></mujoco>')
    trip = travel(path, tmp_path)
    assert trip.fine
    assert trip.mjspec

"""Builds that are killed leave nothing half-written; `make kills` does it a thousand times."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from kills.project import OUTPUTS, Project, digest
from kills.run import kill

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="kills and sessions of processes are those of POSIX"),
]


@pytest.fixture
def project(tmp_path: Path) -> Project:
    made = Project(tmp_path / "project")
    made.make()
    return made


def test_every_output_is_old_or_new(project: Project) -> None:
    seen = kill(project, OUTPUTS, 20, 1, say=lambda line: None)
    assert seen["old"] + seen["new"] > 10 and seen["next builds"] >= 6


def test_what_is_half_written_would_be_seen(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    archive = OUTPUTS[0]
    assert project.run(archive.words)[0] == 0
    path = project.folder / "cell" / archive.writes
    before = digest(path)
    path.write_bytes(path.read_bytes()[:-1])
    assert digest(path) != before

    def spoil(project: Project, words: tuple[str, ...], seconds: float) -> None:
        for each in (project.folder / "cell" / "out").rglob("*.zip"):
            each.write_bytes(b"half")

    monkeypatch.setattr("kills.run._kill_one", spoil)
    with pytest.raises(AssertionError, match="is neither old nor new"):
        kill(project, [archive], 20, 1, say=lambda line: None)

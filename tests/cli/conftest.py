"""Makes the shell importable as `cli.shell`, however pytest is started."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

TESTS = str(Path(__file__).resolve().parent.parent)
if TESTS not in sys.path:
    sys.path.insert(0, TESTS)

from cli.shell import ARM, COVER, RECIPE, REJECTED, TOOL, WRONG  # noqa: E402
from sources.conftest import no_pauses, robots, web  # noqa: E402, F401


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with `cell.yaml`, `wrong.yaml`, `rejected.yaml` and the models that they name."""
    folder = tmp_path / "cell"
    (folder / "models" / "meshes").mkdir(parents=True)
    (folder / "models" / "arm.xml").write_text(ARM)
    (folder / "models" / "tool.xml").write_text(TOOL)
    (folder / "models" / "LICENSE").write_text("Do as you please.\n")
    (folder / "models" / "meshes" / "cover.obj").write_text(COVER)
    (folder / "cell.yaml").write_text(RECIPE)
    (folder / "wrong.yaml").write_text(WRONG)
    (folder / "rejected.yaml").write_text(REJECTED)
    monkeypatch.chdir(folder)
    for name in ("NO_COLOR", "SOURCE_DATE_EPOCH", "MJCOMPOSE_TRACEBACK"):
        monkeypatch.delenv(name, raising=False)
    return folder

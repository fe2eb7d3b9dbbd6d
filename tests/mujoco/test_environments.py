"""MuJoCo in another Python, which gets no modules from this one."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import pytest
from mjcompose.mujoco.environments import open_python


def test_another_python_has_its_own_modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("json", "numpy", "mujoco"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert open_python(Path(sys.executable)).version == mujoco.__version__
    assert not (tmp_path / "ran").exists()

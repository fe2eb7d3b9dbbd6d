from __future__ import annotations

import json
from pathlib import Path

import pytest

from composer.engine.request import Request


def test_a_misspelt_want_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"unknown wants \['indexx'\]; there are \['forward', 'index', 'names'\]"
    ):
        Request(Path(), wants=("indexx",))


def test_its_json_is_one_line_with_absolute_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    line = Request(Path("in"), mjb=Path("out.mjb"), text="<mujoco>\n\u2028</mujoco>").to_json(
        tmp_path / "a.npz"
    )
    assert "\n" not in line and "\r" not in line
    sent = json.loads(line)
    assert sent["folder"] == str(tmp_path / "in")
    assert sent["mjb"] == str(tmp_path / "out.mjb")
    assert sent["text"] == "<mujoco>\n\u2028</mujoco>"

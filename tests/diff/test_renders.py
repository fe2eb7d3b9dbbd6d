"""Pictures of both models. They need OpenGL, and skip where there is none."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from composer.context import Context
from composer.diff.change import Diff
from composer.diff.diff import diff
from composer.diff.markdown import render as in_markdown
from composer.diff.text import render
from composer.engine import Session

MODEL = """<mujoco>
  <worldbody>
    <light pos="0 0 3"/>
    <camera name="the whole" pos="0 -2 0" xyaxes="1 0 0 0 0 1"/>
    <camera name="away" pos="0 -2 0" xyaxes="-1 0 0 0 0 1"/>
    <geom name="ball" size="0.2" rgba="{rgba}"/>
  </worldbody>
</mujoco>
"""


def _diff(folder: Path, context: Context) -> Diff | None:
    for name, rgba in (("a", "1 0 0 1"), ("b", "0 0 1 1")):
        (folder / f"{name}.xml").write_text(MODEL.format(rgba=rgba))
    with Session(rendering=True) as session:
        return diff("a.xml", "b.xml", context, session, renders=Path("out"))


def test_every_view_is_a_pair_of_pictures(tmp_path: Path) -> None:
    context = Context(folder=tmp_path)
    found = _diff(tmp_path, context)
    if found is None:
        (fault,) = context.sink.errors
        assert fault.code == "no-rendering" and fault.help
        pytest.skip("there is no OpenGL")
    assert [(each.name, each.differs > 0) for each in found.views] == [
        ("the whole", True), ("the whole", True), ("away", False),
    ]  # fmt: skip
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(
        f"{stem}-{side}.png" for stem in ("the_whole", "the_whole_2", "away") for side in ("before", "after")
    )
    for view in found.views:
        for name in (view.before, view.after):
            header = (tmp_path / name).read_bytes()[:24]
            assert header[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", header[16:]) == (640, 480)
    assert "away: the same: out/away-before.png, out/away-after.png" in render(found)
    assert "| `away`<br>the same | ![before](<out/away-before.png>) |" in in_markdown(found)


def test_without_opengl_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "disable")
    context = Context(folder=tmp_path)
    assert _diff(tmp_path, context) is None
    (fault,) = context.sink.errors
    assert fault.code == "no-rendering" and "MUJOCO_GL=egl" in str(fault.help)
    assert not (tmp_path / "out").exists()

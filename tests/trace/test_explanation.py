"""An answer on a terminal has the colors that messages have, and the same words."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from mjcompose.cli.reporting import use_color
from mjcompose.sources.context import Context
from mjcompose.trace.explanation import render
from mjcompose.trace.traced import trace

_ESCAPE = re.compile(r"\x1b\[[0-9;]*m")
MODEL = """<mujoco>
  <worldbody><body name="b"><geom name="g" size=".1" mass="2"/></body></worldbody>
</mujoco>
"""


@pytest.mark.parametrize("attribute", [None, "size", "mass"])
def test_colors_change_no_word(tmp_path: Path, attribute: str | None) -> None:
    (tmp_path / "model.xml").write_text(MODEL, encoding="utf-8")
    traced = trace(Path("model.xml"), Context(environment={}, folder=tmp_path))
    assert traced is not None
    (geom,) = traced.model.root.iter("geom")
    explained = traced.element(geom) if attribute is None else traced.attribute(geom, attribute)

    def read(file: str) -> str:
        return (tmp_path / file).read_text(encoding="utf-8")

    plain = render(explained, read)
    colored = render(explained, read, color=True)
    assert _ESCAPE.sub("", colored) == plain
    assert colored.startswith("\x1b[1m") and "\x1b[34m2 |\x1b[0m" in colored
    assert "\x1b" not in plain


def test_colors_are_for_the_terminal_that_reads_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False, raising=False)
    assert use_color(out=True) and not use_color()
    monkeypatch.setattr(sys.stdout, "isatty", lambda: False, raising=False)
    assert not use_color(out=True)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("NO_COLOR", "1")
    assert not use_color(out=True)

from __future__ import annotations

import hashlib
import os
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.sink import Sink
from mjcompose.tree import xml_layout
from mjcompose.tree.xml_layout import format_mjcf
from sampling import rest_slow, without_meshes

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
MODELS = Path(CORPUS, "models") if CORPUS else None

UNTIDY = """\
<?xml version="1.0"?>
<!-- A license. -->
<mujoco  model = 'arm'>

    <compiler angle="radian"></compiler> <!-- angles -->
    <option timestep='.002' />
    <!-- the body tree -->
    <worldbody>


        <body quat="1 0 0 0" childclass="arm" name="base" pos="0 0 1">
            <!-- the joint
                 turns

                 once -->
            <joint axis="0 0 1"
                   name="turn" other="1"/>


            <geom rgba="0.123456 0.123456 0.123456 1" size="0.1000000 0.2000000" pos="0 0 0" euler="0 0 0" type="capsule" name="&quot;a&amp;b"/>

        </body>
    </worldbody>
    <custom><text name="t"><![CDATA[ <a> ]]></text></custom>
    <keyframe><key qpos="
      0 1
      " name="home"/></keyframe>
</mujoco>"""

TIDY = """\
<?xml version="1.0"?>
<!-- A license. -->
<mujoco model="arm">
  <compiler angle="radian"/> <!-- angles -->

  <option timestep=".002"/>

  <!-- the body tree -->
  <worldbody>
    <body name="base" childclass="arm" pos="0 0 1" quat="1 0 0 0">
      <!-- the joint
           turns

           once -->
      <joint name="turn" axis="0 0 1" other="1"/>

      <geom name="&quot;a&amp;b" type="capsule" size="0.1000000 0.2000000" pos="0 0 0" euler="0 0 0"
        rgba="0.123456 0.123456 0.123456 1"/>
    </body>
  </worldbody>

  <custom>
    <text name="t"><![CDATA[ <a> ]]></text>
  </custom>

  <keyframe>
    <key name="home"
      qpos="
      0 1
      "/>
  </keyframe>
</mujoco>
"""


def formatted(text: str) -> str:
    sink = Sink()
    result = format_mjcf(text.encode(), "arm.xml", sink)
    assert result is not None, sink.errors
    return result.decode()


def test_the_layout() -> None:
    assert formatted(UNTIDY) == TIDY
    assert formatted(TIDY) == TIDY


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_breaks_and_the_byte_order_mark_are_kept(mark: str) -> None:
    assert formatted(mark + UNTIDY.replace("\n", "\r\n")) == mark + TIDY.replace("\n", "\r\n")


def test_a_piece_of_a_model() -> None:
    text = "<mujocoinclude>\n  <geom size='1' name='a'/>\n  <body pos='0 0 1' name='b'/>\n</mujocoinclude>\n"
    tidy = '<mujocoinclude>\n  <geom name="a" size="1"/>\n  <body name="b" pos="0 0 1"/>\n</mujocoinclude>\n'
    assert formatted(text) == tidy


class CountedText(str):
    """A text that counts the characters of its slices."""

    copied = 0

    def __getitem__(self, at: Any) -> str:
        part = super().__getitem__(at)
        self.copied += len(part)
        return part


class CountedPattern:
    """A pattern that counts the characters of its matches."""

    def __init__(self, pattern: re.Pattern[str]) -> None:
        self.pattern = pattern
        self.matched = 0

    def match(self, text: str, at: int = 0) -> re.Match[str] | None:
        match = self.pattern.match(text, at)
        self.matched += 0 if match is None else match.end() - at
        return match


@pytest.mark.parametrize("between", ["\n    ", " ", "\n\n  "])
@pytest.mark.parametrize("section", ["worldbody", "asset"])
def test_each_comment_is_read_once(between: str, section: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four times as many comments need four times as many characters, not sixteen times."""

    def characters(count: int) -> int:
        pattern = CountedPattern(xml_layout._LEADS)
        monkeypatch.setattr(xml_layout, "_LEADS", pattern)
        comments = between.join(f'<!-- <geom name="g{number}" size="1"/> -->' for number in range(count))
        text = CountedText(
            f"<mujoco>\n  <{section}>\n    {comments}\n  </{section}>\n  {comments}\n  <option/>\n</mujoco>\n"
        )
        layout = xml_layout._Layout(text)
        layout.write()
        monkeypatch.setattr(xml_layout, "_LEADS", pattern.pattern)
        return text.copied + pattern.matched + sum(map(len, layout.written))

    assert characters(400) < 5 * characters(100)


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("<mujoco>\n <worldbody>\n  words\n  <geom/>\n </worldbody>\n</mujoco>", "cannot-format", 2),
        ("<!DOCTYPE mujoco>\n<mujoco/>", "cannot-format", 1),
        ('<!DOCTYPE mujoco [<!ENTITY a "1">]>\n<mujoco model="&a;"/>', "xml-syntax", 1),
        ('<mujoco>\n  <geom size="&a;"/>\n</mujoco>', "xml-syntax", 2),
        ("<mujoco>\n  <worldbody>\n</mujoco>", "xml-syntax", 3),
        ("<robot name='arm'/>", "not-mjcf", 1),
    ],
)
def test_refusals(text: str, code: str, line: int) -> None:
    sink = Sink()
    assert format_mjcf(text.encode(), "arm.xml", sink) is None
    (error,) = sink.errors
    assert error.span is not None
    assert (error.code, error.span.line) == (code, line)


def test_a_change_of_the_meaning_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.tree.xml_layout._Layout.quoted", lambda self, written: '"1"')
    sink = Sink()
    assert format_mjcf(b'<mujoco model="arm"/>', "arm.xml", sink) is None
    assert [each.code for each in sink.errors] == ["cannot-format"]


ROBOTS = [] if MODELS is None else sorted(each.name for each in MODELS.iterdir() if next(each.rglob("*.xml"), None))


@pytest.mark.skipif(MODELS is None, reason="MJCOMPOSE_CORPUS does not name the models of MuJoCo Menagerie")
@pytest.mark.parametrize("robot", rest_slow(ROBOTS, quick=("universal_robots_ur5e",)))
def test_models_compile_to_the_same_bits(robot: str, tmp_path: Path) -> None:
    import mujoco
    import numpy as np

    assert MODELS is not None
    folder = tmp_path / robot
    shutil.copytree(MODELS / robot, folder, copy_function=without_meshes)
    files = sorted(folder.rglob("*.xml"))

    def compiled(file: Path) -> tuple[str, str] | None:
        try:
            model = mujoco.MjModel.from_xml_path(str(file))
        except ValueError:  # a piece of other models
            return None
        saved = tmp_path / "saved.xml"
        buffer = np.empty(mujoco.mj_sizeModel(model), np.uint8)
        mujoco.mj_saveLastXML(str(saved), model)
        mujoco.mj_saveModel(model, None, buffer)
        return saved.read_text(), hashlib.sha256(buffer.tobytes()).hexdigest()

    before = {file: compiled(file) for file in files}
    assert any(each is not None for each in before.values())
    for file in files:
        file.write_text(tidy := formatted(file.read_text()))
        assert formatted(tidy) == tidy, file
    assert [file for file in files if compiled(file) != before[file]] == []

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from lint.workshop import linted
from mjcompose.mujoco.engine import Session

MODEL = """\
<mujoco>
  <asset>{}</asset>
  <worldbody><geom size="1"/></worldbody>
</mujoco>
"""


def _stl(path: Path, faces: int) -> None:
    table = np.zeros(faces, dtype=[("numbers", "<f4", 12), ("rest", "<u2")])
    table["numbers"] = np.random.default_rng(1).normal(size=(faces, 12))
    path.write_bytes(bytes(80) + struct.pack("<I", faces) + table.tobytes())


def test_a_model_with_a_mesh_needs_a_license(tmp_path: Path, session: Session) -> None:
    (tmp_path / ".git").mkdir()
    _stl(tmp_path / "a.stl", 4)
    text = MODEL.format('<mesh file="a.stl"/>')
    assert linted(text, "no-license", tmp_path, session)
    assert not linted("<!-- SPDX-License-Identifier: MIT -->" + text, "no-license", tmp_path, session)
    assert not linted(MODEL.format(""), "no-license", tmp_path, session), "a small test needs none"
    (tmp_path / "LICENSE").write_text("MIT License")
    assert not linted(text, "no-license", tmp_path, session)


def test_paths_of_one_machine(tmp_path: Path, session: Session) -> None:
    _stl(tmp_path / "a.stl", 4)
    assert linted(MODEL.format(f'<mesh file="{tmp_path}/a.stl"/>'), "absolute-path", tmp_path, session)
    assert not linted(MODEL.format('<mesh file="a.stl"/>'), "absolute-path", tmp_path, session)


def test_equal_large_and_fine_files(tmp_path: Path, session: Session) -> None:
    _stl(tmp_path / "a.stl", 1000)
    _stl(tmp_path / "b.stl", 1000)
    _stl(tmp_path / "c.stl", 1001)
    both = MODEL.format('<mesh file="a.stl"/><mesh file="b.stl"/><mesh file="c.stl"/>')
    (found,) = linted(both, "same-file-twice", tmp_path, session)
    assert found.message == "`b.stl` has the same bytes as `a.stl`"
    assert not linted(both, "mesh-too-fine", tmp_path, session)
    assert not linted(both, "file-too-large", tmp_path, session)
    points = "".join(f"v {at % 1000} {at // 1000} {at % 7}\n" for at in range(210_000))
    (tmp_path / "large.obj").write_text(
        points + "f 1 900 200000\nf 900 200000 3\nf 1 200000 4\nf 3 900 1\n" + "#" * 3_000_000
    )
    large = MODEL.format('<mesh file="large.obj"/>')
    assert linted(large, "mesh-too-fine", tmp_path, session)
    assert linted(large, "file-too-large", tmp_path, session)


def test_a_large_texture(tmp_path: Path, session: Session) -> None:
    head = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + struct.pack(">II", 8192, 4096)
    (tmp_path / "a.png").write_bytes(head)
    text = MODEL.format('<texture name="t" type="2d" file="a.png"/>')
    from mjcompose.base.sink import Sink
    from mjcompose.lint.rule import Subject, rules
    from mjcompose.tree.parse import parse_text

    unit = parse_text(text, Sink(), file="m.xml", directory=tmp_path, label="m")
    assert unit is not None
    (found,) = rules()["texture-too-large"].run(Subject(unit.root, unit))
    assert "34 million pixels" in found.message


ROBOT = """\
<mujoco model="arm">
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body>
      <joint name="a"/>
      <geom size="1"/>
    </body>
  </worldbody>
  <asset/>
</mujoco>
"""
GOOD = ROBOT.replace('    <geom type="plane" size="1 1 1"/>\n', "").replace("  <asset/>\n", "")


def test_the_rules_of_menagerie(tmp_path: Path, session: Session) -> None:
    for code in ("floor-in-model", "section-order", "no-scene"):
        assert linted(ROBOT, code, tmp_path, session), code
    for code in ("floor-in-model", "section-order", "indentation"):
        assert not linted(GOOD, code, tmp_path, session), code
    assert linted(GOOD.replace("    <body>", "   <body>"), "indentation", tmp_path, session)
    (tmp_path / "scene.xml").write_text('<mujoco><include file="model.xml"/></mujoco>')
    assert not linted(GOOD, "no-scene", tmp_path, session)

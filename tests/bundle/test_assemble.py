"""What the manifest of a build says."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.report import render
from mjcompose.bundle.bundle import MANIFEST
from mjcompose.bundle.manifest import Manifest, from_json
from mjcompose.mujoco import engine
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco>
  <compiler meshdir="../meshes"/>
  <asset><mesh name="cover" file="cover.obj"/></asset>
  <worldbody>
    <body name="link">
      <joint name="elbow"/>
      <geom size="0.1"/>
      <geom type="mesh" mesh="cover" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <include file="motors.xml"/>
</mujoco>"""
MOTORS = """<mujocoinclude>
  <actuator>
    <motor name="elbow" joint="elbow"/>
  </actuator>
</mujocoinclude>"""
COVER = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
INNER = """recipe: 1
base: ./models/arm.xml
edit:
  - {select: {joint: elbow}, rename: bend}
"""
OUTER = """recipe: 1
name: cell
params: {weight: {default: 2, unit: kg}, label: x}
variants: {light: {dim: {}, bright: {}}}
attach:
  left: {model: ./models/arm.xml, edit: [{select: {body: link}, rename: rod}]}
  right: {model: ./inner.yaml, pos: [1, 0, 0]}
edit:
  - {select: {joint: right/bend}, rename: hook}
sensor:
  angle: {type: jointpos, joint: right/bend}
check:
  sizes: {expect: {attr: nu, equals: 2}}
  there: {expect: {select: {joint: "**"}}}
  still: {settles: {seconds: 0.01, max_speed: 100}}
"""


@pytest.fixture(scope="module")
def session() -> Iterator[engine.Session]:
    with engine.Session() as session:
        yield session


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "one"
    files = {
        "cell.yaml": OUTER,
        "inner.yaml": INNER,
        "models/arm.xml": ARM,
        "models/motors.xml": MOTORS,
        "meshes/cover.obj": COVER,
        "models/LICENSE": "SPDX-License-Identifier: MIT\n",
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def made(recipe: Path, session: engine.Session, cwd: Path, **more: Any) -> bytes:
    context = Context(folder=cwd)
    built = build(ModelRequest(recipe, **more), context, session=session)
    assert built is not None, "\n".join(map(render, context.sink.diagnostics))
    return built.bundle.files[MANIFEST]


def manifest(folder: Path, session: engine.Session) -> Manifest:
    return from_json(made(folder / "cell.yaml", session, folder))


def test_it_is_the_same_from_everywhere(folder: Path, tmp_path: Path, session: engine.Session) -> None:
    other = tmp_path / "somewhere" / "else"
    shutil.copytree(folder, other)
    texts = {
        made(folder / "cell.yaml", session, folder),
        made(Path("one/cell.yaml"), session, tmp_path),
        made(other / "cell.yaml", session, Path("/")),
    }
    assert len(texts) == 1
    assert str(tmp_path).encode() not in texts.pop()


def test_every_file_that_was_read_is_listed(folder: Path, session: engine.Session) -> None:
    assert [each.path for each in manifest(folder, session).read] == [
        "cell.yaml",
        "inner.yaml",
        "meshes/cover.obj",
        "models/LICENSE",
        "models/arm.xml",
        "models/motors.xml",
    ]


def test_elements_are_told_where_they_are_written(folder: Path, session: engine.Session) -> None:
    index = manifest(folder, session).index
    assert index is not None
    assert (index.joints[0].name, index.joints[0].origin) == ("left/elbow", "models/arm.xml:6")
    assert [(each.type, each.origin) for each in index.actuators] == [("motor", "models/motors.xml:3")] * 2
    assert [(each.name, each.origin) for each in index.sensors] == [("angle", "cell.yaml:11")]


def test_names_that_were_changed_are_traced_back(folder: Path, session: engine.Session) -> None:
    renamed = {part.part: part.renamed for part in manifest(folder, session).parts}
    assert renamed == {"left": {"body": {"link": "left/rod"}}, "right/base": {"joint": {"elbow": "hook"}}}


def test_what_was_chosen_and_what_was_found(folder: Path, session: engine.Session) -> None:
    found = manifest(folder, session)
    assert (found.cell, found.variants, found.params) == (None, {"light": "dim"}, {"weight": 2, "label": "x"})
    assert [(each.name, each.kind, each.origin) for each in found.checks] == [
        ("sizes", "expect", "cell.yaml:13"),
        ("there", "expect", "cell.yaml:14"),
        ("still", "settles", "cell.yaml:15"),
    ]
    assert found.checks[0].values == {"nu": 2}
    assert found.checks[1].values == {"joint **": 2}
    assert from_json(made(folder / "cell.yaml", session, folder, name="cell-dim")).cell == "cell-dim"


def test_licenses_are_summed_up(folder: Path, session: engine.Session) -> None:
    found = manifest(folder, session)
    assert found.licenses == {"MIT": ("left", "right/base")}
    assert {each.license for each in found.inputs} == {"MIT"}


def test_what_is_multiplied_has_no_place(folder: Path, session: engine.Session) -> None:
    (folder / "models" / "arm.xml").write_text(
        """<mujoco><worldbody><replicate count="2" offset="1 0 0"><body name="b"><joint name="j"/>
        <geom size="0.1"/></body></replicate></worldbody></mujoco>"""
    )
    (folder / "cell.yaml").write_text("recipe: 1\nbase: ./models/arm.xml\n")
    index = manifest(folder, session).index
    assert index is not None
    assert [(each.name, each.origin) for each in index.joints] == [("j0", None), ("j1", None)]

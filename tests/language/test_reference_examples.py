"""The examples of the reference build, and together have each of its keys."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import pytest
import yaml
from mjcompose.language.reference_page import examples, pages
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ROOT = Path(__file__).resolve().parents[2]
NAMES = sorted(path.stem for path in (ROOT / "docs" / "examples" / "keys").glob("*.yaml"))
TABLES = {
    "Top-level keys": "top",
    "Sections of MJCF": "top",
    "Selectors": "selectors",
    "Entries": "edit",
    "Fields": "fields",
}
ROW = re.compile(r"^\| (\[?\**`[^|]+) \|", re.MULTILINE)
START = re.compile(r"^Keys of `([^`]+)`:$", re.MULTILINE)
WORDS = re.compile(r"[A-Z]+")
RAIL = """\
recipe: 1
params: {length: 1}
add: [{to: world, body: {name: rail, geom: {type: box, size: ["${length}", 0.1, 0.1]}}}]
"""
CLAW = """<mujoco><worldbody><body name="claw"><joint axis="0 1 0" range="-0.5 0.5"/><geom size="0.1"/></body></worldbody></mujoco>"""
BOX = """\
<robot name="box"><link name="box"><collision><geometry><mesh filename="package://box_meshes/box.obj"/></geometry>
</collision></link></robot>
"""
A12 = """measured: 1
values: {joint elbow: {damping: {value: 0.62, std: 0.03}, zero: {value: -1.3deg, std: 0.1deg}}}
"""
CLOTH = """\
<mujoco>
  <extension><plugin plugin="mujoco.pid"><instance name="soft"/></plugin></extension>
  <actuator><plugin plugin="mujoco.pid" instance="soft" joint="hinge"/></actuator>
  <asset><hfield name="hills" nrow="2" ncol="2" size="1 1 0.1 0.1"/></asset>
  <worldbody>
    <flexcomp name="cloth" type="grid" count="3 3 1" spacing="0.1 0.1 0.1" dim="2" radius="0.01" mass="0.1" pos="0 0 1">
      <edge equality="true"/>
    </flexcomp>
    <body name="patch"><joint name="hinge"/><geom size="0.1"/></body>
  </worldbody>
  <deformable>
    <skin name="patch" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2">
      <bone body="patch" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/>
    </skin>
  </deformable>
</mujoco>
"""


def chapters() -> Iterator[tuple[str, list[str]]]:
    for name, text in pages().items():
        for chapter in re.split(r"^##? ", text, flags=re.MULTILINE)[1:]:
            title, _, rest = chapter.partition("\n")
            section = name.removesuffix(".md")
            start = START.search(rest)
            before = f"{start[1]}." if start else ""
            if title not in ("Model references", "Elements of MJCF", "Recipe reference"):
                yield (
                    TABLES.get(title, section),
                    [before + key for cell in ROW.findall(rest) for key in keys_of(cell)],
                )


def keys_of(cell: str) -> Iterator[str]:
    """The keys of a row, which are in one mapping; the first one has the path to it."""
    first, *others = re.findall("`([^`]+)`", cell)
    yield first
    yield from (f"{first.rpartition('.')[0]}.{each}".lstrip(".") for each in others)


def has(value: Any, steps: list[str]) -> bool:
    """Whether a value has what a key of the reference names; `PREFIX` and the like stand for any key."""
    if not steps:
        return True
    first, *rest = steps
    if first == "[]":
        return isinstance(value, list) and any(has(each, rest) for each in value)
    if not isinstance(value, dict):
        return False
    if WORDS.fullmatch(first):
        return any(has(each, rest) for each in value.values())
    return first in value and has(value[first], rest)


def inside(value: Any, key: str) -> Iterator[Any]:
    """Every value of a key, at any depth."""
    if isinstance(value, dict):
        yield from (each for name, each in value.items() if name == key)
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    for each in items:
        yield from inside(each, key)


def places(chapter: str, recipe: Any) -> list[Any]:
    """What the keys of a chapter are keys of."""
    if chapter == "selectors":
        return [*inside(recipe, "select")]
    if chapter == "edit":
        return [entry for entries in inside(recipe, "edit") for entry in entries]
    if chapter == "fields":
        return [field for fields in inside(recipe, "fields") for field in fields.values()]
    return [recipe]


@pytest.mark.parametrize(("chapter", "keys"), [*chapters()], ids=lambda each: each if isinstance(each, str) else "")
def test_every_key_has_an_example(chapter: str, keys: list[str]) -> None:
    shown = [place for text in examples(chapter) for place in places(chapter, yaml.safe_load(text))]
    if chapter == "top":
        everything = [yaml.safe_load(text) for name in NAMES for text in examples(name)]
        shown += everything
    lacking = {key for key in keys if not any(has(each, steps(key)) for each in shown)}
    assert lacking == set()


def steps(key: str) -> list[str]:
    return [each for part in key.split(".") for each in re.findall(r"\[\]|[^\[\]]+", part)]


@pytest.mark.skipif(mujoco.mj_versionString() < "4", reason="they are of MuJoCo 4")
@pytest.mark.parametrize(("name", "number"), [(name, n) for name in NAMES for n in range(len(examples(name)))])
def test_an_example_builds(name: str, number: int, tmp_path: Path) -> None:
    (tmp_path / "models").symlink_to(ROOT / "recipes" / "models")
    (tmp_path / "rail.yaml").write_text(RAIL, encoding="utf-8")
    (tmp_path / "box.urdf").write_text(BOX, encoding="utf-8")
    (tmp_path / "claw.xml").write_text(CLAW, encoding="utf-8")
    rows = "".join(f"{index / 50},1.6,1.6\n" for index in range(20))
    (tmp_path / "run.csv").write_text(f"time,qpos elbow,ctrl elbow\n{rows}", encoding="utf-8")
    (tmp_path / "A12.yaml").write_text(A12, encoding="utf-8")
    (tmp_path / "cloth.xml").write_text(CLOTH, encoding="utf-8")
    (tmp_path / "box_meshes").mkdir()
    (tmp_path / "box_meshes" / "box.obj").write_bytes((ROOT / "recipes/models/arm6/assets/elbow.obj").read_bytes())
    (tmp_path / "example.yaml").write_text(examples(name)[number], encoding="utf-8")
    context = Context(folder=tmp_path)
    assert build(ModelRequest(tmp_path / "example.yaml"), context) is not None, context.sink.diagnostics
    assert [each for each in context.sink.diagnostics if each.severity != "note"] == []

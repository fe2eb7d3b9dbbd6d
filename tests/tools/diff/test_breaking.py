"""Changes by level: which ones break programs that use the interface, and which lines are the reason."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from mjcompose.contrast.changes import Breaking
from mjcompose.contrast.text import breaking_as_data, render_breaking
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import breaking, diff

MODEL = """\
<mujoco model="m">
  <asset><material name="red" rgba="1 0 0 1"/><mesh name="shell" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  <worldbody>
    <light name="l" pos="0 0 3"/>
    <camera name="c" pos="1 1 1"/>
    <body name="a">
      <joint name="ja" range="-50 50"/>
      <geom name="g" size=".1"/>
      <geom name="v" size=".2" contype="0" conaffinity="0" mass="0"/>
      <geom name="s" type="mesh" mesh="shell" contype="0" conaffinity="0" mass="0"/>
      <site name="tip"/>
      <body name="b"><joint name="jb"/><geom size=".1"/></body>
    </body>
  </worldbody>
  <actuator>
    <motor name="x" joint="ja"/>
    <position name="y" joint="jb" kp="4" ctrlrange="-1 1"/>
    <motor name="z" joint="jb"/>
  </actuator>
  <sensor>
    <jointpos name="s" joint="ja"/>
  </sensor>
  <keyframe>
    <key name="k"/>
    <key name="l"/>
  </keyframe>
</mujoco>
"""
X = '    <motor name="x" joint="ja"/>\n'
KEYS = '    <key name="k"/>\n    <key name="l"/>\n'
CHANGES = [
    ('rgba="1 0 0 1"', 'rgba="1 1 0 1"', "patch"),
    ('name="v" size=".2"', 'name="v" size=".3"', "patch"),
    ('pos="0 0 3"', 'pos="0 0 4"', "patch"),
    ('pos="1 1 1"', 'pos="1 1 2"', "patch"),
    ("0 0 0 1 0 0", "0 0 0 2 0 0", "patch"),
    ('name="g" size=".1"', 'name="g" size=".1" group="2"', "patch"),
    ('name="g" size=".1"', 'name="g" size=".11"', "minor"),
    ('name="v" size=".2" contype="0"', 'name="v" size=".2" contype="1"', "minor"),
    ('kp="4"', 'kp="5"', "minor"),
    ('<motor name="x"', '<motor name="x" forcerange="-1 1"', "minor"),
    ('<key name="k"/>', '<key name="k" qpos="1 1"/>', "minor"),
    ('<mujoco model="m">', '<mujoco model="m"><option timestep="0.001"/>', "minor"),
    ('ctrlrange="-1 1"', 'ctrlrange="-1 2"', "major"),
    ('range="-50 50"', 'range="-50 60"', "major"),
    ('<joint name="jb"/>', '<joint name="jb" type="slide"/>', "major"),
    ('<motor name="z" joint="jb"/>', '<motor name="z" joint="ja"/>', "major"),
    ('<motor name="z" joint="jb"/>', '<velocity name="z" joint="jb" kv="1"/>', "major"),
    ('<motor name="z" joint="jb"/>', '<motor name="z" joint="jb" gear="3"/>', "major"),
    ('<motor name="z"', '<motor name="w"', "major"),
    ('    <motor name="z" joint="jb"/>\n', "", "major"),
    (X, "", "major"),
    ("<jointpos", "<jointvel", "major"),
    ('<jointpos name="s" joint="ja"', '<framepos name="s" objtype="site" objname="tip"', "major"),
    (KEYS, KEYS.replace('"k"', '"?"').replace('"l"', '"k"').replace('"?"', '"l"'), "major"),
    ('    <key name="l"/>\n', "", "major"),
]  # fmt: skip


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


def compared(folder: Path, session: Session, a: str = "a.xml", b: str = "b.xml") -> Breaking:
    context = Context(folder=folder, environment={})
    made: list[Breaking | None] = []
    found = diff(
        a, b, context, session, show=lambda *sides: made.append(breaking(*sides, session=session, context=context))
    )
    assert found is not None and made[0] is not None, context.sink.diagnostics
    return made[0]


def names(found: Breaking) -> list[str]:
    return [each.name for each in found.levels]


@pytest.mark.parametrize(("before", "after", "level"), CHANGES, ids=range(len(CHANGES)))
def test_levels(tmp_path: Path, session: Session, before: str, after: str, level: str) -> None:
    assert MODEL.count(before) == 1
    (tmp_path / "a.xml").write_text(MODEL)
    (tmp_path / "b.xml").write_text(MODEL.replace(before, after))
    found = compared(tmp_path, session)
    assert names(found)[0] == level
    groups = found.levels[0].groups
    line = MODEL[: MODEL.index(before)].count("\n") + 1
    assert all(each.cause is not None for each in groups)
    assert line in {
        span.line for each in groups if (cause := each.cause) for span in (cause.before, cause.after) if span
    }
    back = compared(tmp_path, session, "b.xml", "a.xml")
    assert names(back)[0] == level
    assert compared(tmp_path, session, "a.xml", "a.xml").levels == ()


def test_what_a_program_measures_is_more_than_looks(tmp_path: Path, session: Session) -> None:
    for sensor, change in (
        ('<rangefinder name="r" site="tip"/>', ('name="v" size=".2"', 'name="v" size=".3"')),
        ('<distance name="d" geom1="v" geom2="g"/>', ('name="v" size=".2"', 'name="v" size=".3"')),
        ('<camprojection name="p" site="tip" camera="c"/>', ('pos="1 1 1"', 'pos="1 1 2"')),
    ):
        text = MODEL.replace("<sensor>", f"<sensor>{sensor}")
        (tmp_path / "a.xml").write_text(text.replace('pos="1 1 1"', 'pos="1 1 1" resolution="9 9"'))
        (tmp_path / "b.xml").write_text(text.replace(*change).replace('name="c" pos', 'name="c" resolution="9 9" pos'))
        assert names(compared(tmp_path, session)) == ["minor"], sensor


def test_an_order_names_the_list_or_the_lines(tmp_path: Path, session: Session) -> None:
    (tmp_path / "a.xml").write_text(MODEL)
    (tmp_path / "b.xml").write_text(MODEL.replace(X, "").replace("  </actuator>", f"{X}  </actuator>"))
    text = render_breaking(compared(tmp_path, session), markdown=False)
    assert "a.xml:16 → b.xml:18: the order of actuators\n    place of actuator `x`: 0 → 2" in text
    for name, names_in_order in (("a", "x, y, z"), ("b", "z, x, y")):
        (tmp_path / f"{name}.yaml").write_text(
            f"recipe: 1\nbase: ./a.xml\ninterface:\n  actuator: [{names_in_order}]\n"
        )
    found = compared(tmp_path, session, "a.yaml", "b.yaml")
    text = render_breaking(found, markdown=True)
    assert "#### `a.yaml:4 → b.yaml:4`" in text and "+   actuator: [z, x, y]" in text.replace(
        "+ actuator", "+   actuator"
    )
    data = breaking_as_data(found)
    assert data["level"] == "major" and list(data["levels"]) == ["major"]
    assert data["levels"]["major"]["groups"][0]["changes"][0]["field"] == "place"


def test_only_listed_names_are_major(tmp_path: Path, session: Session) -> None:
    (tmp_path / "a.xml").write_text(MODEL)
    (tmp_path / "b.xml").write_text(MODEL.replace('ctrlrange="-1 1"', 'ctrlrange="-1 2"').replace('"s"', '"other"'))
    for interface, level in (
        ("actuator: [x, y, …]", "major"),
        ("actuator: [x, …]", "minor"),
        ("actuator: [x, y, z]", "major"),
        ("joint: [ja, jb]", "minor"),
    ):
        (tmp_path / "a.yaml").write_text(f"recipe: 1\nbase: ./a.xml\ninterface: {{{interface}}}\n")
        (tmp_path / "b.yaml").write_text("recipe: 1\nbase: ./b.xml\n")
        assert names(compared(tmp_path, session, "a.yaml", "b.yaml"))[0] == level, interface
        assert names(compared(tmp_path, session, "b.yaml", "a.yaml"))[0] == level, interface
        assert names(compared(tmp_path, session, "a.xml", "b.yaml"))[0] == "major", interface

"""A URDF that is linted alone: its own warnings, all of its faults, and no place that its author cannot open."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.lint.rule import rules
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.lint import lint

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial>'
ROBOT = """<robot name="arm">
<link name="base"/>
<link name="upper">{inertial}{shape}</link>
<link name="fore">{inertial}</link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>{limit}</joint>
<joint name="elbow" type="continuous"><parent link="{parent}"/><child link="fore"/></joint>
</robot>
"""
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


def linted(folder: Path, **changed: str) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """The findings and the errors of a URDF."""
    given = {"inertial": INERTIAL.format(0.1), "shape": "", "limit": LIMIT, "parent": "upper", **changed}
    (folder / "arm.urdf").write_text(ROBOT.format(**given))
    context = Context(sink=Sink(), folder=folder)
    with Session() as session:
        found = lint(folder / "arm.urdf", context, session, [rules()["range-ignored"]])
    return list(found.found), context.sink.errors


def test_warnings_about_the_file_are_findings(tmp_path: Path) -> None:
    found, errors = linted(tmp_path, limit='<limit lower="1" upper="-1"/>')
    assert [(each.code, each.span and each.span.line) for each in found] == [("urdf-limits", 5)]
    assert not errors
    assert linted(tmp_path) == ([], [])


def test_a_comment_ignores_them(tmp_path: Path) -> None:
    found, errors = linted(tmp_path, limit='<limit effort="1"/> <!-- mjcompose: ignore[urdf-limits] -->')
    assert not found and not errors


@pytest.mark.parametrize("mesh", ["lost.stl", "package://lost/lost.stl", "file:///lost/lost.stl", "/lost/lost.stl"])
def test_no_message_shows_a_file_of_ours(tmp_path: Path, mesh: str) -> None:
    _, (error,) = linted(tmp_path, shape=MESH.format(mesh))
    spans = [error.span, *(note.span for note in error.notes)]
    assert {span.file for span in spans if span is not None} == {"arm.urdf"}
    assert not any("recipe" in note.message for note in error.notes)


def test_all_faults_are_reported_at_once(tmp_path: Path) -> None:
    _, errors = linted(tmp_path, shape=MESH.format("lost.stl"), inertial=INERTIAL.format(9), parent="uper")
    assert sorted((each.code, each.span.line) for each in errors if each.span is not None) == [
        ("asset-missing", 3),
        ("mujoco-rejects", 6),
        ("urdf-inertia", 3),
    ]
    (inertia,) = (each for each in errors if each.code == "urdf-inertia")
    assert len(inertia.others) == 1


def test_an_inertia_that_mujoco_balances_is_no_fault(tmp_path: Path) -> None:
    setting = '<mujoco><compiler balanceinertia="true"/></mujoco>'
    _, errors = linted(
        tmp_path, inertial=INERTIAL.format(9), parent='uper"/></joint><joint name="x"><parent link="base'
    )
    assert {each.code for each in errors} == {"urdf-inertia", "mujoco-rejects"}
    (tmp_path / "b.urdf").write_text(
        (tmp_path / "arm.urdf").read_text().replace('name="arm">', f'name="arm">{setting}')
    )
    context = Context(sink=Sink(), folder=tmp_path)
    with Session() as session:
        lint(tmp_path / "b.urdf", context, session, [])
    assert {each.code for each in context.sink.errors} == {"mujoco-rejects"}

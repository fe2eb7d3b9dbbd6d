from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main

INERTIA = '<inertial><mass value="1"/><inertia ixx="{0}" iyy="{0}" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper">{}<visual><geometry><box size="1 1 1"/></geometry></visual></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/></joint>
  <gazebo><plugin name="p"/></gazebo>
</robot>
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("moment", "keys"), [(0.1, "{visuals: keep}"), (0.01, "{visuals: keep, inertia: repair}")])
def test_the_recipe_builds(folder: Path, moment: float, keys: str) -> None:
    (folder / "arm.urdf").write_text(ARM.format(INERTIA.format(moment)))
    result = CliRunner().invoke(main, ["import", "arm.urdf"])
    assert result.exit_code == 0, result.output
    assert f"urdf: {keys}" in (folder / "arm.yaml").read_text()
    assert "`<gazebo><plugin>` (1)  a program of Gazebo  (arm.urdf:5:11)" in result.output
    built = CliRunner().invoke(main, ["check", "arm.yaml"])
    assert built.exit_code == 0, built.output


def test_the_table_as_data(folder: Path) -> None:
    (folder / "arm.urdf").write_text(ARM.format(INERTIA.format(0.1)))
    result = CliRunner().invoke(main, ["import", "arm.urdf", "--output-format", "json"])
    rows = {row["what"]: row for row in json.loads(result.stdout)["rows"]}
    assert rows["link"]["count"] == 2 and rows["gazebo/plugin"]["why"] and rows["link/visual"]["became"]


def test_a_broken_one(folder: Path) -> None:
    (folder / "arm.urdf").write_text("<robot>")
    result = CliRunner().invoke(main, ["import", "arm.urdf"])
    assert result.exit_code == 1 and "xml-syntax" in result.output and not (folder / "arm.yaml").exists()

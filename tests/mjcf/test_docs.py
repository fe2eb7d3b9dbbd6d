"""The examples of docs/reference/mjcf.md, run as they stand, in their order."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from mjcompose.mjcf import Physics


def test_the_examples_of_the_page(
    repository: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arm = (folder / "arm" / "arm.xml").read_text().replace('"upper"', '"arm"').replace("meshes", "arm/meshes")
    (folder / "robot.xml").write_text(arm)
    (folder / "gripper.xml").write_text(
        (folder / "gripper" / "gripper.xml").read_text().replace("shell.stl", "gripper/shell.stl")
    )
    mesh = folder / "arm" / "meshes" / "path" / "to" / "mesh.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes((folder / "gripper" / "shell.stl").read_bytes())
    monkeypatch.chdir(folder)
    examples = re.findall(
        r"```python\n(.*?)```", (repository / "docs" / "reference" / "mjcf.md").read_text(), re.DOTALL
    )
    assert len(examples) == 13
    names: dict[str, object] = {}
    for example in examples:
        exec(compile(example, "docs/reference/mjcf.md", "exec"), names)

    physics = names["physics"]
    assert isinstance(physics, Physics)
    assert physics.model.joint("gripper/turn").id == 2
    assert physics.data.joint("gripper/right").qpos[0] == 0.02
    assert mujoco.MjModel.from_xml_path("out/model.xml").nsensor == 5
    told = capsys.readouterr().out.splitlines()
    last = told.index(".stl")
    assert told[last + 1 : last + 5] == ["True", told[last + 2], "left True", "hammer"]
    assert told[2:5] == ["base default", "arm default", "fore default"]
    assert told[last + 2].startswith("[0.01 0.02] ")
    assert told[last + 5] == '<body name="custom_body">'
    assert told[-3:-1] == ["3 numbers; 0 0 0 if it is not set anywhere.", "['gravcomp']"]
    assert told[-1].startswith("True ['Equality', 'EqualityConnect', ")

"""docs/how-to/so101.md, with a simulated arm in place of the real one."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from cli.shell import run
from tools.identify import robots

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "so101.md").read_text(encoding="utf-8")
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
ARM = """<mujoco model="so101"><compiler angle="radian"/><option integrator="implicitfast"/>
<default><joint damping="0.6" frictionloss="{friction}" armature="0.028" range="-1.7 1.7"/>
<position kp="{kp}" kv="2.7" ctrlrange="-1.8 1.8"/></default><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>"""


def arm(friction: float = 0.05, kp: float = 100.0) -> str:
    bodies = ""
    for index, name in reversed(list(enumerate(JOINTS))):
        axis = "0 0 1" if index in (0, 4) else "0 1 0"
        geom = '<geom type="capsule" fromto="0 0 0 .1 0 0" size=".02" mass=".1" contype="0" conaffinity="0"/>'
        bodies = f'<body pos=".1 0 0"><joint name="{name}" axis="{axis}"/>{geom}{bodies}</body>'
    motors = "".join(f'<position name="{name}" joint="{name}"/>' for name in JOINTS)
    return ARM.format(friction=friction, kp=kp, bodies=bodies, motors=motors)


@pytest.mark.slow
def test_the_recipe_plans_a_fit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "SO-ARM100" / "Simulation" / "SO101"
    folder.mkdir(parents=True)
    (folder / "so101_new_calib.xml").write_text(arm())
    for name, text in re.findall(r'```yaml title="([^"]+)"\n(.*?)^```', PAGE, re.MULTILINE | re.DOTALL):
        (tmp_path / name).write_text(text.replace("episode: 0", "episode: 1"))
    columns = robots.recorded(mujoco.MjModel.from_xml_string(arm(0.2, 80.0)), 4.0)
    degrees = {name: values if name == "time" else np.degrees(values) for name, values in columns.items()}
    robots.write_lerobot(tmp_path / "so101-a12", degrees)
    commands = re.findall(r"^mjcompose (identify .*)$", PAGE, re.MULTILINE)
    assert len(commands) == 2
    result = run(*commands[0].split())
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert len(lines) == 26, "four numbers and a zero of each joint but the gripper, and one delay"
    assert "gripper" not in result.stdout
    (little,) = [line for line in lines if line.endswith("little is learned")]
    assert little.startswith("joint shoulder_pan: zero "), "its axis is vertical"

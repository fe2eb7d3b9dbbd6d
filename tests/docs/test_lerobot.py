"""docs/how-to/lerobot.md, with a simple arm in place of Menagerie's SO-101."""

from __future__ import annotations

import json
import re
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest
from docs.replay import Replay
from docs.test_so101 import JOINTS, arm

PAGE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "lerobot.md"
CAMERA = '<camera name="wrist_cam" resolution="1920 1080"/>'


@pytest.fixture
def arms(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder laid out like Menagerie, with an arm of the names of its SO-101."""
    folder = tmp_path / "menagerie" / "robotstudio_so101"
    folder.mkdir(parents=True)
    text = arm().replace('<joint name="gripper"', f'{CAMERA}<joint name="gripper"')
    (folder / "so101.xml").write_text(f"<!-- SPDX-License-Identifier: Apache-2.0 -->{text}")
    monkeypatch.setenv("MENAGERIE_ROOT", str(folder.parent))
    monkeypatch.chdir(tmp_path)
    return folder


@pytest.mark.slow
def test_the_page_is_true(arms: Path, tmp_path: Path) -> None:
    """Without LeRobot, its program is not run: then another one writes the stamp."""
    page = tmp_path / "lerobot.md"
    text = PAGE.read_text(encoding="utf-8")
    if find_spec("lerobot") is None:
        program = (
            "import json, mjcompose, pathlib\n"
            "pathlib.Path('so101-sim/meta').mkdir(parents=True)\n"
            "stamp = mjcompose.stamp('build/so101.zip')\n"
            "pathlib.Path('so101-sim/meta/model.json').write_text(json.dumps(stamp))\n"
            "print('recorded 50 frames')\n"
        )
        text = re.sub(r'(title="record.py"\n).*?(?=^```)', lambda found: found[1] + program, text, flags=re.M | re.S)
    page.write_text(text, encoding="utf-8")
    Replay(page, tmp_path).whole()
    features = json.loads((tmp_path / "features.json").read_text())
    motors = [f"{name}.pos" for name in JOINTS]
    assert features["action"]["names"] == features["observation.state"]["names"] == motors
    images = {name.rpartition(".")[2]: each["shape"] for name, each in features.items() if "images" in name}
    assert images == {"front": [480, 640, 3], "wrist": [360, 640, 3]}


def test_the_units_of_the_follower(tmp_path: Path) -> None:
    (source,) = re.findall(r'title="follower.py"\n(.*?)^```', PAGE.read_text(encoding="utf-8"), re.M | re.S)
    space: dict[str, object] = {}
    exec(compile(source, "follower.py", "exec"), space)  # a program of this repository
    follower = space["Follower"](mujoco.MjModel.from_xml_string(arm()), JOINTS)  # type: ignore[operator]
    radians = np.array([-1.7, 0, 0.5, 1.7, 1, 0])
    numbers = follower.numbers(radians)
    assert numbers == pytest.approx([*np.degrees(radians[:5]), 50], abs=1e-4)
    assert follower.radians(numbers) == pytest.approx(radians, abs=1e-6)
    assert follower.numbers(np.array([0, 0, 0, 0, 0, 1.7]))[5] == pytest.approx(100)

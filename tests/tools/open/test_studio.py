"""The plugin for MuJoCo's Studio in `docs/how-to/open_in_mujoco.md`, in a simulation without a window."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import mujoco
import pytest

PAGE = Path(__file__).resolve().parents[3] / "docs" / "how-to" / "open_in_mujoco.md"
BASE = "<mujoco><worldbody><body name='table'><geom name='top' size='.1'/></body></worldbody></mujoco>"
PROGRAM = """
import time
from pathlib import Path
from mujoco.studio import endpoints, hot_reload, launch_thread, messages, plugin, viewer_handle

hot_reload.enable("model")
_, sim = endpoints.make_endpoints(
    s2v_snapshot=launch_thread.ThreadSnapshotChannel(), s2v_events=launch_thread.ThreadEventChannel(),
    v2s_events=launch_thread.ThreadEventChannel(), v2s_snapshot=launch_thread.ThreadSnapshotChannel(),
)
handle = viewer_handle.ViewerHandle(sim, sim_plugins=plugin.load_plugins(["recipes.py"]))
handle.dispatch(messages.LoadModelEvent(path="cell.yaml"))
print(handle.model.body("table").mass[0])

def saved(file, old, new):
    path = Path(file)
    path.write_text(path.read_text().replace(old, new))
    before, end = handle.model, time.monotonic() + 10
    while handle.model is before and time.monotonic() < end:
        handle.sync()
        time.sleep(0.05)
        if "bad" in new and time.monotonic() > end - 9:
            break
    print(handle.model.body("table").mass[0], handle.model.nbody)

saved("cell.yaml", "mass: 2", "mass: 3")
saved("base.xml", "</worldbody>", "<body name='more'/></worldbody>")
saved("cell.yaml", "base:", "bad:")
saved("cell.yaml", "bad:", "base:")
saved("base.xml", "<body name='more'/>", "")
"""

pytestmark = [
    pytest.mark.skipif(mujoco.mj_version() < 4000000, reason="MuJoCo 3 has no Studio"),
    pytest.mark.skipif(find_spec("mujoco.studio") is None, reason="Studio is not installed"),
]


def test_studio_loads_a_recipe_again_after_a_part_of_it_was_saved(tmp_path: Path) -> None:
    [text] = re.findall(r'^```python title="recipes.py"\n(.*?)^```', PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    (tmp_path / "recipes.py").write_text(text)
    (tmp_path / "base.xml").write_text(BASE)
    (tmp_path / "cell.yaml").write_text("recipe: 1\nbase: ./base.xml\nedit: [{select: {geom: top}, set: {mass: 2}}]\n")
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env=os.environ.copy(),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["2.0", "3.0 2", "3.0 3", "3.0 3", "3.0 3", "3.0 2"]
    assert "the recipe has no key `bad`" in done.stderr

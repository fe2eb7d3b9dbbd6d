"""The plugin for programs without Python, compiled and tried."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest
from mjcompose.tools.open import shim

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(mujoco.mj_version() < 4000000, reason="decoders of MuJoCo 3 have other arguments"),
    pytest.mark.skipif(sys.platform != "linux" or shutil.which("cc") is None, reason="needs Linux and a C compiler"),
]
PROGRAM = r"""
#include <mujoco/mujoco.h>
#include <stdio.h>
int main(int count, char** words) {
  char error[1024] = "";
  mj_loadAllPluginLibraries(words[2], 0);
  mjSpec* spec = mj_parse(words[1], 0, 0, error, sizeof error);
  if (!spec) return printf("%s", error), 1;
  mjModel* model = mj_compile(spec, 0);
  printf("%d", (int)model->nbody);
  return 0;
}
"""


@pytest.fixture
def release(tmp_path: Path) -> Path:
    """A folder laid out like a release of MuJoCo."""
    package = Path(mujoco.__file__).parent
    (tmp_path / "release" / "bin" / "mujoco_plugin").mkdir(parents=True)
    (tmp_path / "release" / "include").symlink_to(package / "include")
    return tmp_path / "release"


def test_a_program_in_c_opens_a_recipe(release: Path, tmp_path: Path) -> None:
    place = shim.install(shim.mujoco_folder(release))
    assert place.parent.name == "mujoco_plugin"
    (tmp_path / "main.c").write_text(PROGRAM)
    package = Path(mujoco.__file__).parent
    [library] = package.glob("libmujoco.so.*")
    program = tmp_path / "program"
    subprocess.run(
        ["cc", f"-I{package / 'include'}", tmp_path / "main.c", library, f"-Wl,-rpath,{package}", "-o", program],
        check=True,
    )
    (tmp_path / "base.xml").write_text("<mujoco><worldbody><body><geom size='1'/></body></worldbody></mujoco>")
    for text, code, shown in (
        ("recipe: 1\nbase: ./base.xml\n", 0, "2"),
        ("recipe: 1\nbas: ./base.xml\n", 1, "error[unknown-key]: the recipe has no key `bas`"),
    ):
        (tmp_path / "cell.yaml").write_text(text)
        done = subprocess.run(
            [program, tmp_path / "cell.yaml", place.parent], capture_output=True, text=True, check=False
        )
        assert done.returncode == code and shown in done.stdout
    assert shim.remove(release) == place and not place.exists() and shim.remove(release) is None


def test_a_folder_without_mujoco_is_refused(tmp_path: Path) -> None:
    with pytest.raises(shim.PluginError, match=r"mjplugin\.h"):
        shim.mujoco_folder(tmp_path)

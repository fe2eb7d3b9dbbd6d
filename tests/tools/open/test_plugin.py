"""The plugin for programs without Python, compiled and tried."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest
from mjcompose.tools.open import decoder

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(mujoco.mj_version() < 4000000, reason="decoders of MuJoCo 3 have other arguments"),
    pytest.mark.skipif(
        sys.platform != "linux" or None in (shutil.which("cc"), shutil.which("c++")), reason="needs Linux and compilers"
    ),
]
PAGE = Path(__file__).resolve().parents[3] / "docs" / "how-to" / "open_in_mujoco.md"


@pytest.fixture
def release(tmp_path: Path) -> Path:
    """A folder laid out like a release of MuJoCo."""
    package = Path(mujoco.__file__).parent
    (tmp_path / "release" / "bin" / "mujoco_plugin").mkdir(parents=True)
    (tmp_path / "release" / "include").symlink_to(package / "include")
    return tmp_path / "release"


def test_the_program_of_the_page_opens_a_recipe(release: Path, tmp_path: Path) -> None:
    place = decoder.install(decoder.mujoco_folder(release))
    assert place.parent.name == "mujoco_plugin"
    [program_text] = re.findall(r"^```cpp\n(.*?)^```", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    (tmp_path / "main.cpp").write_text(program_text)
    package = Path(mujoco.__file__).parent
    [library] = package.glob("libmujoco.so.*")
    program = tmp_path / "program"
    subprocess.run(
        ["c++", f"-I{package / 'include'}", tmp_path / "main.cpp", library, f"-Wl,-rpath,{package}", "-o", program],
        check=True,
    )
    (tmp_path / "base.xml").write_text(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    for text, code, shown in (
        ("recipe: 1\nbase: ./base.xml\n", 0, "7"),
        ("recipe: 1\nbas: ./base.xml\n", 1, "error[unknown-key]: the recipe has no key `bas`"),
    ):
        (tmp_path / "cell.yaml").write_text(text)
        done = subprocess.run(
            [program, tmp_path / "cell.yaml", place.parent], capture_output=True, text=True, check=False
        )
        assert done.returncode == code and shown in done.stdout
    assert decoder.remove(release) == place and not place.exists() and decoder.remove(release) is None


def test_import_mujoco_alone_opens_a_recipe(tmp_path: Path) -> None:
    """In a package like the installed one, which other tests use at the same time."""
    package, copy = Path(mujoco.__file__).parent, tmp_path / "site" / "mujoco"
    copy.mkdir(parents=True)
    for each in package.iterdir():
        if each.name == "plugin":
            shutil.copytree(each, copy / "plugin")
        else:
            (copy / each.name).symlink_to(each)
    decoder.install(decoder.mujoco_folder(copy))
    (tmp_path / "base.xml").write_text("<mujoco><worldbody><body name='b'/></worldbody></mujoco>")
    (tmp_path / "cell.yaml").write_text("recipe: 1\nbase: ./base.xml\n")
    program = "import mujoco; print(mujoco.__file__, mujoco.MjSpec.from_file('cell.yaml').body('b').name)"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(copy.parent)},
    )  # fmt: skip
    assert done.stdout.split() == [str(copy / "__init__.py"), "b"], done.stderr


def test_a_folder_without_mujoco_is_refused(tmp_path: Path) -> None:
    with pytest.raises(decoder.PluginError, match=r"mjplugin\.h"):
        decoder.mujoco_folder(tmp_path)

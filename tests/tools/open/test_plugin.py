"""The plugin for programs without Python, compiled and tried."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
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


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a package like the installed one, which other tests use at the same time, and with the plugin."""
    site = tmp_path_factory.mktemp("site")
    package = Path(mujoco.__file__).parent
    copy = site / "mujoco"
    copy.mkdir()
    for each in package.iterdir():
        if each.name == "plugin":
            shutil.copytree(each, copy / "plugin")
        else:
            (copy / each.name).symlink_to(each)
    decoder.install(decoder.mujoco_folder(copy))
    return site


OPENS = """
import mujoco
try:
    print(mujoco.__file__, mujoco.MjSpec.from_file('cell.yaml').body('b').name)
except ValueError as error:
    print(error)
"""


def opened(folder: Path, site: Path, **variables: str) -> str:
    """What a program prints that opens a recipe in a folder, with `import mujoco` alone."""
    (folder / "base.xml").write_text("<mujoco><worldbody><body name='b'/></worldbody></mujoco>")
    if not (folder / "cell.yaml").exists():
        (folder / "cell.yaml").write_text("recipe: 1\nbase: ./base.xml\n")
    done = subprocess.run(
        [sys.executable, "-P", "-c", OPENS],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env={**os.environ, "PYTHONPATH": str(site), **variables},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_import_mujoco_alone_opens_a_recipe(tmp_path: Path, site: Path) -> None:
    assert opened(tmp_path, site).split() == [str(site / "mujoco" / "__init__.py"), "b"]


def test_nothing_of_the_folder_of_the_program_runs(tmp_path: Path, site: Path) -> None:
    """The program has another Python with an empty entry in PYTHONPATH: that means the current folder."""
    for name in ("yaml", "json", "click", "typing", "mjcompose", "sitecustomize", "usercustomize"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write({name!r})\n")
    clean = tmp_path / "python"
    clean.write_text(f'#!/bin/sh\nPYTHONPATH=":$PYTHONPATH" exec {sys.executable} "$@"\n')
    clean.chmod(0o755)
    assert opened(tmp_path, site, MJCOMPOSE_PYTHON=str(clean)).split()[-1] == "b"
    assert not (tmp_path / "ran").exists()


def test_an_error_is_one_line(tmp_path: Path, site: Path) -> None:
    (tmp_path / "cell.yaml").write_text("recipe: 1\nbas: ./base.xml\nedits: []\n")
    [line] = opened(tmp_path, site).splitlines()
    assert line.startswith("cell.yaml:2:1: error[unknown-key]: the recipe has no key `bas`; help: write `base`")
    assert line.endswith("(and 1 more error)")
    (tmp_path / "cell.yaml").unlink()
    (tmp_path / "cell.yaml").mkdir()
    [line] = opened(tmp_path, site).splitlines()
    assert "cell.yaml" in line and "folder" in line


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("exec sleep 60", "mjcompose needs more than 0.5 s; MJCOMPOSE_OPEN_SECONDS allows more"),
        ("exec >&- 2>&-; sleep 60", "mjcompose needs more than 0.5 s; MJCOMPOSE_OPEN_SECONDS allows more"),
        ("sleep 60 2>&- & echo wrong; exit 1", "mjcompose needs more than 0.5 s; MJCOMPOSE_OPEN_SECONDS allows more"),
        ("trap '' TERM; while :; do echo no; sleep .1; done", "mjcompose needs more than 0.5 s"),
        ("exit 0", "mjcompose has stopped without an answer"),
        ("kill -9 $$", "mjcompose has stopped without an answer"),
        ("echo 'one reason'; echo 'and another'; exit 1", "one reason"),
        ("echo 'not a model'", "not a model"),
        ('echo "$PWD $*"', "/ -P -m mjcompose.tools.open.recipe cell.yaml /"),
        ("printf '<mujoco'; exit 1", "<mujoco"),
    ],
)
def test_what_goes_wrong_is_one_line_in_time(tmp_path: Path, site: Path, script: str, reason: str) -> None:
    (tmp_path / "python").write_text(f"#!/bin/sh\n{script}\n")
    (tmp_path / "python").chmod(0o755)
    begun = time.monotonic()
    [line] = opened(
        tmp_path, site, MJCOMPOSE_PYTHON=str(tmp_path / "python"), MJCOMPOSE_OPEN_SECONDS="0.5"
    ).splitlines()
    assert line.startswith(reason)
    assert time.monotonic() - begun < 30


def test_a_reply_that_is_too_large_is_not_read(tmp_path: Path, site: Path) -> None:
    (tmp_path / "python").write_text("#!/bin/sh\nexec cat /dev/zero\n")
    (tmp_path / "python").chmod(0o755)
    [line] = opened(tmp_path, site, MJCOMPOSE_PYTHON=str(tmp_path / "python")).splitlines()
    assert line == "mjcompose prints more than 256 MiB; `mjcompose build` writes the model to a bundle"


def test_a_folder_without_mujoco_is_refused(tmp_path: Path) -> None:
    with pytest.raises(decoder.PluginError, match=r"mjplugin\.h"):
        decoder.mujoco_folder(tmp_path)

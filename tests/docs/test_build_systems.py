"""What docs/how-to/teams.md shows works as it stands: CMake with Ninja and Make, Bazel's command, and Make."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli.conftest import folder  # noqa: F401  # a fixture
from cli.shell import REPOSITORY, environment, process

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="the commands are of a POSIX shell")]
PAGE = (REPOSITORY / "docs" / "how-to" / "teams.md").read_text(encoding="utf-8")


def blocks(kind: str) -> list[str]:
    return re.findall(rf"^```{kind}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


@pytest.fixture
def shell(folder: Path, tmp_path: Path) -> dict[str, str]:  # noqa: F811
    """The environment of a shell that finds this `mjcompose`, and the build systems beside this Python."""
    command = tmp_path / "bin" / "mjcompose"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m mjcompose "$@"\n')
    command.chmod(0o755)
    paths = [str(command.parent), str(Path(sys.executable).parent), os.environ["PATH"]]
    return environment(PATH=os.pathsep.join(paths))


def needs(name: str, shell: dict[str, str]) -> None:
    if shutil.which(name, path=shell["PATH"]) is None:
        pytest.skip(f"there is no {name}")


@pytest.mark.parametrize(("generator", "program"), [("Ninja", "ninja"), ("Unix Makefiles", "make")])
def test_cmake_builds_again_what_changed(folder: Path, shell: dict[str, str], generator: str, program: str) -> None:  # noqa: F811
    needs("cmake", shell)
    needs(program, shell)
    project = folder.parent / "a project"
    folder.rename(project)
    whole, ament = blocks("cmake")
    own = re.sub(r"^(find_package\(ament_cmake|ament_package\().*\n", "", ament, flags=re.MULTILINE)
    assert own.count("\n") == 1 and ament.count("\n") == 3
    (project / "CMakeLists.txt").write_text(whole + own)

    def cmake(*words: str) -> str:
        done = subprocess.run(["cmake", *words], cwd=project, env=shell, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def builds() -> bool:
        before = model.stat().st_mtime_ns
        cmake("--build", "out")
        return model.stat().st_mtime_ns != before

    model = project / "out" / "cell.zip"
    cmake("-S", ".", "-B", "out", "-G", generator)
    cmake("--build", "out")
    first = model.read_bytes()
    assert not builds()
    (project / "models" / "tool.xml").touch()  # without a change
    assert builds() and model.read_bytes() == first
    assert not builds()
    mesh = project / "models" / "meshes" / "cover.obj"
    mesh.write_text(mesh.read_text().replace("v 1 0 0", "v 2 0 0"))
    assert builds() and model.read_bytes() != first
    assert not builds()
    cmake("--install", "out", "--prefix", str(project / "installed"))
    assert (project / "installed" / "share" / "robots" / "models" / "cell.zip").is_file()


def test_make_builds_again_what_changed(folder: Path, shell: dict[str, str]) -> None:  # noqa: F811
    needs("make", shell)
    (folder / "Makefile").write_text(blocks("make")[0])

    def make() -> str:
        done = subprocess.run(["make", "build/cell.zip"], cwd=folder, env=shell, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "mjcompose build" in make()
    assert "up to date" in make()
    time.sleep(0.05)  # file systems count time in ticks
    (folder / "models" / "meshes" / "cover.obj").touch()
    assert "mjcompose build" in make() and "up to date" in make()


def test_the_command_of_bazel_builds_in_a_sandbox_of_links(folder: Path, shell: dict[str, str]) -> None:  # noqa: F811
    rule = blocks("starlark")[0]
    (command,) = re.findall(r'cmd = "(.*)"', rule)
    assert process("lock", "cell.yaml", cwd=folder).returncode == 0
    sandbox = folder.parent / "sandbox"
    for file in ("cell.yaml", "cell.lock", *folder.glob("models/**/*")):
        path = folder / file
        if path.is_file():
            (link := sandbox / path.relative_to(folder)).parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(path)
    for word, value in {
        "$(execpath :mjcompose)": "mjcompose",
        "$(execpath cell.yaml)": "cell.yaml",
        "$@": "out/cell.zip",
    }.items():
        assert word in command
        command = command.replace(word, value)
    done = subprocess.run(["bash", "-ec", command], cwd=sandbox, env=shell, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert process("verify", "out/cell.zip", cwd=sandbox).returncode == 0


def test_a_recipe_on_standard_input(folder: Path, shell: dict[str, str]) -> None:  # noqa: F811
    subprocess.run(["bash", "-ec", blocks("sh")[-1]], cwd=folder, env=shell, check=True, timeout=120)
    assert (folder / "build" / "cell.zip").is_file()

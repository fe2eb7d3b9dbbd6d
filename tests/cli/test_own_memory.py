from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

resource = pytest.importorskip("resource")
MODEL = '<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>'


def check(
    folder: Path, kilobytes: int, *options: str, model: str = MODEL
) -> subprocess.CompletedProcess[str]:
    """The command in a process that may have so much memory."""
    (folder / "m.xml").write_text(model)
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    command = f'ulimit -d {kilobytes}; exec "$0" -m composer check r.yaml --no-cache "$@"'
    return subprocess.run(
        ["bash", "-c", command, sys.executable, *options], cwd=folder, capture_output=True, text=True
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
@pytest.mark.parametrize("kilobytes", [30_000, 60_000, 100_000, 160_000])
def test_too_little_memory_is_one_clear_line(tmp_path: Path, kilobytes: int) -> None:
    done = check(tmp_path, kilobytes)
    assert done.returncode == 1
    assert done.stderr == (
        f"not enough memory: this process may have {kilobytes >> 10} MiB (`ulimit -d`), and needs at least 160\n"
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
def test_the_least_memory_is_enough(tmp_path: Path) -> None:
    done = check(tmp_path, 200_000)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts data as Linux does")
def test_the_limit_binds_the_command_itself(tmp_path: Path) -> None:
    numbers = " ".join(["1.5"] * 3_000_000)
    texts = "".join(f'<numeric name="n{each}" data="{numbers}"/>' for each in range(3))
    model = MODEL.replace("<worldbody>", f"<custom>{texts}</custom><worldbody>", 1)
    assert model != MODEL
    done = check(tmp_path, 8_000_000, "--limit", "memory=170M", model=model)
    assert done.returncode == 1 and done.stderr.startswith("not enough memory"), done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the shell is bash")
def test_a_limit_below_what_any_build_needs_is_wrong_usage(tmp_path: Path) -> None:
    done = check(tmp_path, 8_000_000, "--limit", "memory=30M")
    assert done.returncode == 2 and "a build needs at least 160M" in done.stderr, done.stderr

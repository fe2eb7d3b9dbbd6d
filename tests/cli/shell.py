"""The command in this process, which is quick, and as a process of its own, which is what users have."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result
from mjcompose.cli.main import main
from mjcompose.sources.blobs import let_go

REPOSITORY = Path(__file__).resolve().parents[2]

ARM = """\
<mujoco model="arm">
  <compiler meshdir="meshes"/>
  <asset>
    <mesh name="cover" file="cover.obj"/>
  </asset>
  <worldbody>
    <body name="base">
      <geom type="mesh" mesh="cover"/>
      <body name="link" pos="0 0 1">
        <joint name="shoulder" axis="0 1 0" range="-90 90"/>
        <geom name="rod" type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <site name="flange" pos="0 0 0.3"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
TOOL = """\
<mujoco model="tool">
  <worldbody>
    <body name="palm">
      <geom name="palm" type="box" size="0.03 0.03 0.01"/>
    </body>
  </worldbody>
</mujoco>
"""
COVER = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
RECIPE = """\
recipe: 1
name: cell
base: ./models/arm.xml
attach:
  tool: {model: ./models/tool.xml, site: flange}
sensor:
  angle: {type: jointpos, joint: shoulder}
"""
WRONG = RECIPE.replace("site: flange", "site: flang")
REJECTED = RECIPE + "add:\n  - {to: link, geom: {type: box, size: [0.1]}}\n"


def run(*arguments: str, input: str | None = None) -> Result:
    """The command in this process; standard output and standard error are kept apart."""
    keep_apart = {"mix_stderr": False} if "mix_stderr" in inspect.signature(CliRunner).parameters else {}
    let_go()  # each command is a process, which has ended
    result = CliRunner(**keep_apart).invoke(main, list(arguments), input=input, prog_name="mjcompose")
    assert result.exit_code in (0, 1, 2, 130), result.stderr
    return result


def environment(**more: str) -> dict[str, str]:
    """The environment of a process that finds this package, whatever its folder."""
    path = os.pathsep.join(filter(None, [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]))
    return {**os.environ, "PYTHONPATH": path, **more}


def process(*arguments: str, **more: Any) -> subprocess.CompletedProcess[bytes]:
    """The command as a process of its own; `more` goes to `subprocess.run`."""
    more = {"env": environment(), "capture_output": True, "timeout": 120, **more}
    return subprocess.run([sys.executable, "-m", "mjcompose", *arguments], check=False, **more)


def snapshot(folder: Path) -> dict[str, bytes | None]:
    """Everything in a folder: contents of files, None for folders."""
    return {
        path.relative_to(folder).as_posix(): None if path.is_dir() else path.read_bytes()
        for path in sorted(folder.rglob("*"))
    }

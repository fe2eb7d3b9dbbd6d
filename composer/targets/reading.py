"""Read a model back in another program, in an environment that has it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from composer.dataclass import dataclass
from composer.limits import in_force
from composer.processes.process import Process
from composer.recipe.checks.simulators import READ_IN
from composer.recipe.rows import check_rows
from composer.targets.names import CONSUMERS
from composer.targets.table import TARGETS

_READERS = Path(__file__).with_name("readers")
_INTERPRETER = "Scripts/python.exe" if os.name == "nt" else "bin/python"
_ASK = "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)"
_LAST_WORDS = 400
_RAISED = re.compile(r"[\w.]+(Error|Exception|Exit)\b")


@dataclass(frozen=True, slots=True)
class Reader:
    """A program that reads models back.

    `program` is both the file in `readers/` and the folder of its environment. `module` is what Python imports, and
    `packages` are what pip installs. A program that computes in `single` precision gets a larger tolerance.
    """

    target: str
    program: str
    module: str
    packages: tuple[str, ...]
    single: bool = False


READERS: Mapping[str, Reader] = {
    each.target: each
    for each in (
        Reader("drake", "drake", "pydrake", packages=("drake",)),
        Reader("pinocchio", "pinocchio", "pinocchio", packages=("pin",)),
        Reader("pybullet", "pybullet", "pybullet", packages=("numpy", "pybullet"), single=True),
        Reader(
            "newton",
            "newton",
            "newton",
            packages=("newton", "trimesh", "scipy", "mujoco", "mujoco-warp"),
            single=True,
        ),
        Reader("genesis", "genesis", "genesis", packages=("torch", "genesis-world")),
        Reader("mjx", "mjx", "mujoco.mjx", packages=("mujoco-mjx",)),
        Reader("warp", "warp", "mujoco_warp", packages=("mujoco-warp",), single=True),
        Reader("urdf", "pinocchio", "pinocchio", packages=("pin",)),
    )
}
"""By the name of the target that it reads."""

check_rows("the programs of composer/targets/reading.py", READERS, READ_IN)
check_rows("the targets that they read", [name for name in TARGETS if name in READERS], READERS)


def interpreter(reader: Reader, environment: Mapping[str, str]) -> str | None:
    """Return the Python that can import a program: that of its environment, or the current one; None without either."""
    folder = environment.get(CONSUMERS)
    named = Path(folder, reader.program, _INTERPRETER) if folder else None
    for python in (named, Path(sys.executable)):
        if python is not None and os.path.isfile(python) and _has(str(python), reader.module):
            return str(python)
    return None


def _has(python: str, module: str) -> bool:
    asked = subprocess.run([python, "-I", "-c", _ASK, module], capture_output=True, check=False)
    return asked.returncode == 0


def read_back(reader: Reader, python: str, model: Path, questions: dict[str, Any]) -> dict[str, Any] | str:
    """Return the facts of a model as the program reads it, or an error message.

    The facts are those of `judging.py`: numbers by name, the count of shapes, poses, and the end of a motion. Files are
    written beside the folder of the model.
    """
    asked, out = model.parent.with_suffix(".poses.json"), model.parent.with_suffix(".facts.json")
    asked.write_text(json.dumps(questions), encoding="utf-8")
    command = [python, "-I", str(_READERS / f"{reader.program}.py"), str(model), str(asked), str(out)]
    seconds = in_force().time
    with Process(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        cwd=model.parent.parent,
    ) as process:
        try:
            _, said = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.end()
            return f"it took longer than {seconds:g} seconds"
    if process.returncode or not os.path.isfile(out):
        lines = [line for line in said.decode("utf-8", "replace").splitlines() if line.strip(" -")]
        raised = [line for line in lines if _RAISED.match(line)]  # JAX and Genesis write more after it
        return (
            (raised or lines)[-1][:_LAST_WORDS] if lines else f"it ended with the code {process.returncode}"
        )
    facts: dict[str, Any] = json.loads(out.read_bytes())
    return facts

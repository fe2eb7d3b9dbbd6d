"""MuJoCo in other versions: in a Python that the user names, or in an environment that mjcompose makes and keeps."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import field
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.limits import in_force
from mjcompose.base.processes import Process
from mjcompose.sources.blobs import FOLDER, READY, complete, gate, hold, is_complete, mujoco_key
from mjcompose.sources.reference import SourceError
from mjcompose.sources.store import Store
from mjcompose.tree.history import release

_DUMP, _MOTION = (Path(__file__).with_name(name) for name in ("dump.py", "motion.py"))
_INSTALLING = 900.0
_LONGEST = 300


class OtherError(Exception):
    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help


@dataclass(frozen=True, slots=True)
class Compiled:
    """A compiled model: the file with its arrays, and its names; or the error of MuJoCo."""

    version: str
    arrays: Path | None = None
    names: Mapping[str, Sequence[str | None]] = field(default_factory=dict)
    words: Mapping[str, Any] = field(default_factory=dict)
    error: str | None = None


@dataclass(frozen=True, slots=True)
class Other:
    python: Path
    version: str

    def compile(self, model: Path, out: Path) -> Compiled:
        """Compile a model and write its arrays to a file. Raises OtherError if MuJoCo does not answer."""
        answer = _run(self.python, [str(model), str(out)])
        if answer.get("error") is not None:
            return Compiled(self.version, error=str(answer["error"]))
        return Compiled(self.version, out, answer["names"], words=answer["words"])

    def move(self, model: Path, out: Path, asked: Mapping[str, Any]) -> dict[str, Any]:
        """Simulate a model as `motion.py` says; its arrays go to the file `out`. Raises OtherError."""
        return _run(self.python, [str(model), str(out), json.dumps(asked)], _MOTION)


def this_python() -> Path:
    return Path(sys.executable)


def open_python(python: Path) -> Other:
    """Return the MuJoCo of a Python. Raises OtherError."""
    if not os.path.exists(python):
        raise OtherError(f"the Python `{python}` does not exist", "name an interpreter: `VENV/bin/python`")
    if os.path.isdir(python):
        inside = _python_of(python)
        if not os.path.exists(inside):
            raise OtherError(f"`{python}` is a folder without a Python", "name an interpreter or its environment")
        python = inside
    return Other(python.absolute(), str(_run(python.absolute(), [])["version"]))


def make(
    version: str, environment: Mapping[str, str], progress: Callable[[str], None], *, offline: bool = False
) -> Other:
    """Return the MuJoCo of a version in an environment of its own, made if needed. Raises OtherError."""
    try:
        store = Store.of(environment)
        folder = store.folder / FOLDER / version
        with store.lock(mujoco_key(version), progress):
            if not is_complete(folder):
                if offline:
                    message = f"MuJoCo {version} is not installed, and nothing is fetched offline"
                    raise OtherError(message, "run it once without `--offline`")
                progress(f"installing MuJoCo {version}")
                _install(folder, version)
            with suppress(OSError), gate(store.folder):  # it is not pruned while this process lives
                hold(store.folder, mujoco_key(version))
    except SourceError as error:
        raise OtherError(error.diagnostic.message, error.diagnostic.help) from error
    with suppress(OSError):
        os.utime(folder / READY)
    return open_python(_python_of(folder))


def _install(folder: Path, version: str) -> None:
    """Raises OtherError, and OSError."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    try:
        for command in _commands(folder, version):
            _install_with(command, version)
        complete(folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _commands(folder: Path, version: str) -> list[list[str]]:
    """Return the commands that install it: with uv if it exists, else with this Python and pip."""
    wanted = [f"mujoco=={version}", "numpy"]
    uv = shutil.which("uv")
    if uv is not None:
        python = ["--python", "3.11"]  # all versions since 3.0 have a wheel for it
        return [
            [uv, "venv", "--quiet", *python, str(folder)],
            [uv, "pip", "install", "--quiet", "--python", str(_python_of(folder)), *wanted],
        ]
    quiet = ["--quiet", "--disable-pip-version-check", "--only-binary", ":all:"]
    return [
        [sys.executable, "-m", "venv", str(folder)],
        [str(_python_of(folder)), "-m", "pip", "install", *quiet, *wanted],
    ]


def _install_with(command: list[str], version: str) -> None:
    process = Process(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        _, said = process.communicate(timeout=_INSTALLING)
    except subprocess.TimeoutExpired:
        process.end()
        raise OtherError(f"installing MuJoCo {version} took longer than {_INSTALLING:g} seconds") from None
    finally:
        process.release()
    if process.returncode:
        lines = [line for line in said.decode("utf-8", "replace").splitlines() if line.strip()]
        errors = [line for line in lines if "error" in line.lower()] or lines
        raise OtherError(
            f"MuJoCo {version} cannot be installed: {errors[-1].strip()[:_LONGEST] if errors else 'without a reason'}",
            "install it into an environment yourself, and name its Python with `--with-python`",
        )


def _python_of(folder: Path) -> Path:
    return folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def _run(python: Path, arguments: list[str], program: Path = _DUMP) -> dict[str, Any]:
    """Return the answer of a program in that Python. Raises OtherError."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    try:
        process = Process([str(python), "-B", str(program), *arguments], env=clean, cwd=_DUMP.parent.parent,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)  # fmt: skip
    except OSError as error:
        raise OtherError(f"`{python}` cannot be run: {(error.strerror or str(error)).lower()}") from None
    try:
        out, said = process.communicate(timeout=in_force().time)
    except subprocess.TimeoutExpired:
        process.end()
        message = f"the MuJoCo of `{python}` gave no answer in {in_force().time:g} seconds"
        raise OtherError(message, "give it more with `--timeout`") from None
    finally:
        process.release()
    try:
        found = json.loads(out)
        found["version"] = release(str(found["version"])) or str(found["version"])
    except (ValueError, TypeError, KeyError):
        lines = said.decode("utf-8", "replace").strip().splitlines()
        why = lines[-1][:_LONGEST] if lines else f"it ended with {process.returncode}"
        raise OtherError(f"the MuJoCo of `{python}` gave no answer: {why}", None) from None
    assert isinstance(found, dict)
    return found

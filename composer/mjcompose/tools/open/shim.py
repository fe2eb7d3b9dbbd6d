"""The decoder as a library in MuJoCo's plugin folder, for programs without Python and for `import mujoco` alone."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from mjcompose.base.diagnostic import DiagnosticError
from mjcompose.base.files import read_regular
from mjcompose.base.scratch import scratch
from mjcompose.build.bundle.bundle import unwritable_error
from mjcompose.build.bundle.staging import staged_file

SOURCE = Path(__file__).with_name("decoder.c")
NAME = "libmjcompose_decoder.so"


class PluginError(DiagnosticError):
    """The library cannot be compiled or installed."""


def mujoco_folder(named: Path | None = None) -> Path:
    """Return the folder of a MuJoCo: the named folder, or the folder of the `mujoco` package. Raises PluginError."""
    if named is None:
        spec = find_spec("mujoco")
        if spec is None or not spec.submodule_search_locations:
            raise PluginError("mujoco-missing", "the package `mujoco` is not installed", "use `--mujoco`")
        named = Path(spec.submodule_search_locations[0])
    if not os.path.isfile(named / "include" / "mujoco" / "mjplugin.h"):
        raise PluginError(
            "mujoco-missing", f"`{named}` has no `include/mujoco/mjplugin.h`",
            "name the folder of a MuJoCo release, or of the package `mujoco`",
        )  # fmt: skip
    return named


def library_in(folder: Path) -> Path:
    """Return the place of the library for a MuJoCo: `plugin` in the package, `bin/mujoco_plugin` in a release."""
    release = folder / "bin" / "mujoco_plugin"
    return (release if os.path.isdir(release) else folder / "plugin") / NAME


def install(folder: Path) -> Path:
    """Compile the decoder for the MuJoCo in a folder and put it in its place. Raises PluginError and OutputError."""
    if sys.platform != "linux":
        raise PluginError(
            "not-supported", "the plugin for programs without Python exists for Linux only",
            "in Python, use `mjcompose.mujoco_plugin.register()`",
        )  # fmt: skip
    header = read_regular(folder / "include" / "mujoco" / "mujoco.h").decode(errors="replace")
    version = next((line.split()[-1] for line in header.splitlines() if "#define mjVERSION_HEADER" in line), "0")
    if int(version) < 4_000_000:
        raise PluginError("not-supported", f"the MuJoCo in `{folder}` is older than 4.0, the first that opens recipes",
                          "install `mujoco>=4`, or build a bundle with `mjcompose build`")  # fmt: skip
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise PluginError("not-installed", "there is no C compiler", "install one, such as `gcc`, or set `CC`")
    place = library_in(folder)
    with scratch("plugin") as build:
        made = build / NAME
        python = sys.executable.replace("\\", "\\\\").replace('"', '\\"')
        words = [compiler, "-O2", "-shared", "-fPIC", f"-I{folder / 'include'}", f'-DMJCOMPOSE_PYTHON="{python}"',
                 str(SOURCE), "-o", str(made), "-ldl"]  # fmt: skip
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode:
            lines = done.stderr.strip().splitlines() or ["no reason given"]
            raise PluginError("not-supported", f"`{compiler}` cannot compile the plugin: {lines[0]}")
        with staged_file(place) as stage:  # raises OutputError
            stage.write_bytes(read_regular(made))
    return place


def remove(folder: Path) -> Path | None:
    """Remove the library from the MuJoCo in a folder; return its place, or None if it is not there."""
    place = library_in(folder)
    try:
        place.unlink()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise unwritable_error(place, error) from None
    return place

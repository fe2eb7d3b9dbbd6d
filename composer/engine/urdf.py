"""URDF to MJCF by MuJoCo itself, with every digit and nothing compiled into the numbers that was not asked for."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from composer.engine.limits import Limits
from composer.engine.run import call, without_folder
from composer.engine.session import Session

PACKAGE = "package://"


@dataclass(frozen=True, slots=True)
class Converted:
    """The MJCF text of a URDF file, or why there is none.

    `meshes` are the files that MuJoCo asks for, as it looks for them: below the URDF's folder and `folder` (its
    `meshdir`) unless absolute, or still `package://…` where the package is not known. Empty where it was not
    read so far. `error` and `crash` are as in `Compiled`.

    In `text` each link is a body. One that MuJoCo fused with its parent is a `<frame>` that has the link's name
    (from MuJoCo 4.0 on; an older one leaves nothing of it).
    """

    text: str | None
    meshes: tuple[str, ...] = ()
    folder: str = ""
    error: str | None = None
    crash: str | None = None


def convert_urdf(path: Path, packages: Mapping[str, Path], *, limits: Limits | None = None) -> Converted:
    """Convert a file; `packages` has the folders that `package://NAME` stands for.

    Needs all meshes, for MuJoCo saves only what compiles. Never raises for what the file holds.
    """
    argument = {
        "path": str(path.absolute()),
        "packages": {name: folder.absolute().as_posix() for name, folder in packages.items()},
    }
    with Session(limits) as session:
        called = call(session, convert, (), argument)
    if not called.ok:
        return Converted(None, error=called.error, crash=called.crash)
    value = called.value
    error = value["error"] and without_folder(value["error"], path.parent)
    return Converted(value["text"], tuple(value["meshes"]), value["folder"], error)


def convert(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """Runs in the child."""
    answer: dict[str, Any] = {"text": None, "meshes": [], "folder": "", "error": None}
    try:
        spec = mujoco.MjSpec.from_file(argument["path"])
        for mesh in spec.meshes:
            mesh.file = _found(mesh.file, argument["packages"])
        answer |= {"meshes": [mesh.file for mesh in spec.meshes], "folder": spec.meshdir}
        return answer | {"text": _saved(mujoco, spec)}
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        return answer | {"error": str(error).strip() or type(error).__name__}


def _found(file: str, packages: Mapping[str, str]) -> str:
    name, _, inside = file.removeprefix(PACKAGE).partition("/")
    return f"{packages[name]}/{inside}" if file.startswith(PACKAGE) and name in packages else file


def _saved(mujoco: Any, spec: Any) -> str:
    """The text of a spec.

    What the compiler would do to the whole model is done here, where it is still a model of its own: in a
    composition it would reach the other parts. Numbers are saved as they were read.
    """
    compiler = spec.compiler
    compiler.saveinertial = False
    if not hasattr(compiler, "savecompiled"):
        _save_all_digits(mujoco)
        return str(spec.to_xml())
    for body in spec.bodies[1:]:
        body.add_frame(name=body.name)  # is carried along by what becomes of the body
    if compiler.discardvisual:
        spec.discard_visual()
    if compiler.fusestatic:
        spec.fuse_static()
    compiler.discardvisual = compiler.fusestatic = False
    compiler.savecompiled = compiler.savecanonical = False
    return str(spec.to_xml())


def _save_all_digits(mujoco: Any) -> None:
    """An older MuJoCo saves six digits, unless its library is told otherwise."""
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco*.dll"):
        for library in folder.glob(pattern):
            ctypes.CDLL(str(library))._mjPRIVATE__set_xml_precision(17)
            return
    raise ValueError("this version of MuJoCo saves rounded numbers only")

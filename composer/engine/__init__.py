"""MuJoCo in a child process with limits, so that a crash, a hang or a log file never reaches the user.

`compile` says whether a model compiles and what is in it, `measure` returns arrays of the compiled model,
`convert_urdf` converts URDF to MJCF, `Session` keeps the child process for several calls. The parent never imports
MuJoCo; a missing installation is an answer (`Compiled.crash == "missing"`), not an exception. Submodules are
imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from composer.compiled.index import Actuator, Camera, Index, Joint, Keyframe, Sensor
    from composer.engine.answer import Called, Compiled, Measured
    from composer.engine.limits import Limits
    from composer.engine.request import Request
    from composer.engine.run import call, compile, measure, run_many, without_folder
    from composer.engine.session import Session
    from composer.engine.urdf import PACKAGE, Converted, convert_urdf

__all__ = [
    "PACKAGE",
    "Actuator",
    "Called",
    "Camera",
    "Compiled",
    "Converted",
    "Index",
    "Joint",
    "Keyframe",
    "Limits",
    "Measured",
    "Request",
    "Sensor",
    "Session",
    "call",
    "compile",
    "convert_urdf",
    "measure",
    "run_many",
    "without_folder",
]

_MODULES = {
    "composer.compiled.index": ("Actuator", "Camera", "Index", "Joint", "Keyframe", "Sensor"),
    "composer.engine.answer": ("Called", "Compiled", "Measured"),
    "composer.engine.limits": ("Limits",),
    "composer.engine.request": ("Request",),
    "composer.engine.run": ("call", "compile", "measure", "run_many", "without_folder"),
    "composer.engine.session": ("Session",),
    "composer.engine.urdf": ("PACKAGE", "Converted", "convert_urdf"),
}
_HOME = {name: room for room, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)

"""Compose MuJoCo models from a YAML recipe into one verified bundle.

    import composer

    robot = composer.load("build/robot/")               # a bundle: its model, its manifest, an index of names
    arm = composer.mjcf.from_path("arm.xml")            # a model to read, edit, attach and write
    study = composer.worlds.load("build/study/")        # one model and the numbers that differ between its samples

What these refuse is a `MjcomposeError`, but for an index out of range. All of it is imported on first use, so
that the import costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from composer import mjcf as mjcf
    from composer import worlds as worlds
    from composer.diagnostics.failure import MjcomposeError as MjcomposeError
    from composer.loading.errors import BundleWarning as BundleWarning
    from composer.loading.errors import LoadError as LoadError
    from composer.loading.errors import UnknownNameError as UnknownNameError
    from composer.loading.load import load as load
    from composer.loading.many import load_many as load_many
    from composer.version import __version__ as __version__

_MODULES = {"mjcf": "composer.mjcf", "worlds": "composer.worlds"}
_HOMES = {
    "BundleWarning": "composer.loading.errors",
    "LoadError": "composer.loading.errors",
    "MjcomposeError": "composer.diagnostics.failure",
    "UnknownNameError": "composer.loading.errors",
    "__version__": "composer.version",
    "load": "composer.loading.load",
    "load_many": "composer.loading.many",
}

__all__ = [
    "BundleWarning",
    "LoadError",
    "MjcomposeError",
    "UnknownNameError",
    "__version__",
    "load",
    "load_many",
    "mjcf",
    "worlds",
]


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return import_module(_MODULES[name])
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`", name=name)
    value: object = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__

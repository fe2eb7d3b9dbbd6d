"""Compose MuJoCo models from a YAML recipe into one verified bundle.

    import mjcompose

    spec = mjcompose.spec("cell.yaml", tool="flange")    # a recipe as a `mujoco.MjSpec`; `mjcompose.tree` compiles it
    robot = mjcompose.load("build/robot/")               # a bundle: its model, its manifest, an index of names
    arm = mjcompose.mjcf.from_path("arm.xml")            # a model to read, edit, attach and write
    study = mjcompose.worlds.load("build/study/")        # one model and the numbers that differ between its samples

Input that these do not accept raises a `MjcomposeError`; an index out of range is an `IndexError`. The import costs
nothing: each name is imported when you first use it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mjcompose import mjcf as mjcf
    from mjcompose import mujoco_plugin as mujoco_plugin
    from mjcompose import worlds as worlds
    from mjcompose.base import __version__ as __version__
    from mjcompose.base.report import MjcomposeError as MjcomposeError
    from mjcompose.tools.open.recipe import BuildError as BuildError
    from mjcompose.tools.open.recipe import RecipeWarning as RecipeWarning
    from mjcompose.tools.open.recipe import model as model
    from mjcompose.tools.open.recipe import spec as spec
    from mjcompose.tools.open.stamp import stamp as stamp
    from mjcompose.tools.worlds.load import load as load
    from mjcompose.tools.worlds.load import load_many as load_many
    from mjcompose.tools.worlds.names import BundleWarning as BundleWarning
    from mjcompose.tools.worlds.names import LoadError as LoadError
    from mjcompose.tools.worlds.names import UnknownNameError as UnknownNameError

_MODULES = {name: f"mjcompose.{name}" for name in ("mjcf", "mujoco_plugin", "worlds")}
_HOMES = {
    "BuildError": "mjcompose.tools.open.recipe",
    "BundleWarning": "mjcompose.tools.worlds.names",
    "LoadError": "mjcompose.tools.worlds.names",
    "MjcomposeError": "mjcompose.base.report",
    "RecipeWarning": "mjcompose.tools.open.recipe",
    "UnknownNameError": "mjcompose.tools.worlds.names",
    "__version__": "mjcompose.base",
    "load": "mjcompose.tools.worlds.load",
    "load_many": "mjcompose.tools.worlds.load",
    "model": "mjcompose.tools.open.recipe",
    "spec": "mjcompose.tools.open.recipe",
    "stamp": "mjcompose.tools.open.stamp",
}

__all__ = [*_MODULES, *_HOMES]


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

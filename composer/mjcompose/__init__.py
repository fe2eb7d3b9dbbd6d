"""Compose MuJoCo models from a YAML recipe into one verified bundle.

    import mjcompose

    spec = mjcompose.spec("cell.yaml", tool="flange")    # a recipe as a `mujoco.MjSpec`; `mjcompose.model` compiles it
    model = mjcompose.model({"recipe": 1, "base": "./arm.xml"})    # a recipe as data, as a `mujoco.MjModel`
    robot = mjcompose.load("build/robot/")               # a bundle: its model, its manifest, an index of names
    arm = mjcompose.mjcf.from_path("arm.xml")            # a model to read, edit, attach and write
    study = mjcompose.worlds.load("build/study/")        # one model and the numbers that differ between its samples

Input that these do not accept raises a `MjcomposeError`; an index out of range is an `IndexError`. The import costs
nothing: each name is imported when you first use it.
"""

import sys

if sys.argv[:1] == ["-m"] and not sys.flags.safe_path:
    # `python -m mjcompose`: Python puts the current folder first, where anyone may have a `typing.py`.
    _module = sys.orig_argv[len(sys.orig_argv) - len(sys.argv)].split(".")[0]
    if _module == "mjcompose" or (_module.startswith("-") and _module.endswith("mmjcompose")):
        del sys.path[0]

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from mjcompose import mjcf, mujoco_plugin, worlds
    from mjcompose.base import __version__
    from mjcompose.base.report import MjcomposeError
    from mjcompose.text.dump import dumps
    from mjcompose.tools.open.recipe import BuildError, RecipeWarning, model, spec
    from mjcompose.tools.open.stamp import stamp
    from mjcompose.tools.worlds.load import load, load_many
    from mjcompose.tools.worlds.names import BundleWarning, LoadError, UnknownNameError

__all__ = [
    "BuildError",
    "BundleWarning",
    "LoadError",
    "MjcomposeError",
    "RecipeWarning",
    "UnknownNameError",
    "__version__",
    "dumps",
    "load",
    "load_many",
    "mjcf",
    "model",
    "mujoco_plugin",
    "spec",
    "stamp",
    "worlds",
]


def _lazy(own: dict[str, Any], homes: dict[str, str]) -> "tuple[Callable[[str], object], Callable[[], list[str]]]":
    """Return `__getattr__` and `__dir__` of a module that imports names on first use. `homes` has them by module."""
    home_of = {name: home for home, names in homes.items() for name in names.split()}

    def find(name: str) -> object:
        if name not in home_of:
            raise AttributeError(f"module `{own['__name__']}` has no attribute `{name}`", name=name)
        home = import_module(f"mjcompose.{home_of[name] or name}")
        own[name] = getattr(home, name) if home_of[name] else home
        return own[name]

    return find, lambda: list(own["__all__"])


__getattr__, __dir__ = _lazy(
    globals(),
    {
        "base.report": "MjcomposeError",
        "base": "__version__",
        "text.dump": "dumps",
        "tools.open.recipe": "BuildError RecipeWarning model spec",
        "tools.open.stamp": "stamp",
        "tools.worlds.load": "load load_many",
        "tools.worlds.names": "BundleWarning LoadError UnknownNameError",
        "": "mjcf mujoco_plugin worlds",
    },
)

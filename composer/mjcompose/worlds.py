"""Worlds: one model and the numbers that differ between its samples, for simulators that step many at once.

    from mjcompose import worlds

    study = worlds.load("build/study/")                 # built with `--as worlds`
    batch = worlds.mujoco(study, nthread=8)             # a mujoco.batch.Batch with the numbers of every world
    model = study.model(17)                             # one world as a mujoco.MjModel

Submodules are imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mjcompose.tools.worlds.join import gather as gather
    from mjcompose.tools.worlds.simulators import mjlab as mjlab
    from mjcompose.tools.worlds.simulators import mjx as mjx
    from mjcompose.tools.worlds.simulators import mujoco as mujoco
    from mjcompose.tools.worlds.simulators import warp as warp
    from mjcompose.tools.worlds.worlds import Table as Table
    from mjcompose.tools.worlds.worlds import Varying as Varying
    from mjcompose.tools.worlds.worlds import Worlds as Worlds
    from mjcompose.tools.worlds.worlds import load as load

_HOMES = {
    "Table": "mjcompose.tools.worlds.worlds",
    "Varying": "mjcompose.tools.worlds.worlds",
    "Worlds": "mjcompose.tools.worlds.worlds",
    "gather": "mjcompose.tools.worlds.join",
    "load": "mjcompose.tools.worlds.worlds",
    "mjlab": "mjcompose.tools.worlds.simulators",
    "mjx": "mjcompose.tools.worlds.simulators",
    "mujoco": "mjcompose.tools.worlds.simulators",
    "warp": "mjcompose.tools.worlds.simulators",
}

__all__ = ["Table", "Varying", "Worlds", "gather", "load", "mjlab", "mjx", "mujoco", "warp"]


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`", name=name)
    value: object = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__

"""Worlds: one model and the numbers that differ between its samples, for simulators that step many at once.

    from composer import worlds

    study = worlds.load("build/study/")                 # built from a recipe with `randomize: {emit: worlds}`
    batch = worlds.mujoco(study, nthread=8)             # a mujoco.batch.Batch with the numbers of every world
    model = study.model(17)                             # one world as a mujoco.MjModel

Submodules are imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from composer.worlds.batch import mujoco as mujoco
    from composer.worlds.gathering import gather as gather
    from composer.worlds.gpu import warp as warp
    from composer.worlds.jax_tree import mjx as mjx
    from composer.worlds.lab import mjlab as mjlab
    from composer.worlds.table import Table as Table
    from composer.worlds.table import Varying as Varying
    from composer.worlds.worlds import Worlds as Worlds
    from composer.worlds.worlds import load as load

_HOMES = {
    "Table": "composer.worlds.table",
    "Varying": "composer.worlds.table",
    "Worlds": "composer.worlds.worlds",
    "gather": "composer.worlds.gathering",
    "load": "composer.worlds.worlds",
    "mjlab": "composer.worlds.lab",
    "mjx": "composer.worlds.jax_tree",
    "mujoco": "composer.worlds.batch",
    "warp": "composer.worlds.gpu",
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

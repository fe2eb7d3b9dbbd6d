"""Worlds: one model and the numbers that differ between its samples, for simulators that step many at once.

    from mjcompose import worlds

    study = worlds.load("build/study/")                 # built with `--as worlds`
    batch = worlds.mujoco(study, nthread=8)             # a mujoco.batch.Batch with the numbers of every world
    model = study.model(17)                             # one world as a mujoco.MjModel

Submodules are imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mjcompose import _lazy

if TYPE_CHECKING:
    from mjcompose.tools.worlds.join import gather
    from mjcompose.tools.worlds.simulators import mjlab, mjx, mujoco, warp, warp_data
    from mjcompose.tools.worlds.switching import switch
    from mjcompose.tools.worlds.worlds import Table, Varying, Worlds, load

__all__ = ["Table", "Varying", "Worlds", "gather", "load", "mjlab", "mjx", "mujoco", "switch", "warp", "warp_data"]
__getattr__, __dir__ = _lazy(
    globals(),
    {
        "tools.worlds.join": "gather",
        "tools.worlds.simulators": "mjlab mjx mujoco warp warp_data",
        "tools.worlds.switching": "switch",
        "tools.worlds.worlds": "Table Varying Worlds load",
    },
)

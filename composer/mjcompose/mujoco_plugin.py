"""Let MuJoCo open recipes: `MjSpec.from_file("cell.yaml")`, and `<model file="cell.yaml">` in plain MJCF.

    import mujoco
    from mjcompose import mujoco_plugin

    mujoco_plugin.register()
    model = mujoco.MjSpec.from_file("cell.yaml").compile()

Needs MuJoCo 4.0. Without it, `mjcompose.spec` and `mjcompose.model` build a recipe in this process.
"""

from __future__ import annotations

from mjcompose.tools.open.decoder import is_registered, register
from mjcompose.tools.open.recipe import files_of

__all__ = ["files_of", "is_registered", "register"]


def __dir__() -> list[str]:
    return __all__

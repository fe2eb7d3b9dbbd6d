"""Pictures of two models from the same places."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from composer.compiled.kinds import names
from composer.pictures.framing import camera
from composer.pictures.png import png
from composer.pictures.stage import Look, NoOpenGL, Stage

WHOLE = "the whole"
# Renderers differ in the last bits of a colour value (0 to 255).
_SAME = 2


def pictures(mujoco: Any, a: Any, b: Any, folder: str) -> dict[str, Any]:
    """Write `N-a.png` and `N-b.png` below `folder` for each view N.

    `views` has their names and the share that differs. Views are the cameras that both models have by name, and one
    of the whole of both. Both are at their first common keyframe, otherwise at the reference configuration. `no
    OpenGL` says why there are none.
    """
    key = next(iter(_common(a, b, "key")), None)
    look = Look()
    try:
        stages = [Stage(mujoco, model, key, look=look) for model in (a, b)]
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    free = camera(mujoco, [(stage.model, stage.data) for stage in stages], look.aspect)
    views: list[tuple[str, Any]] = [(WHOLE, free), *((name, name) for name in _common(a, b, "camera"))]
    differing = []
    for number, (name, view) in enumerate(views):
        before, after = (stage.picture(view) for stage in stages)
        for side, picture in (("a", before), ("b", after)):
            Path(folder, f"{number}-{side}.png").write_bytes(png(picture))
        differs = (np.abs(before.astype(int) - after) > _SAME).any(axis=2)
        differing.append({"name": name, "differs": float(differs.mean())})
    for stage in stages:
        stage.close()
    return {"views": differing, "key": key}


def _common(a: Any, b: Any, kind: str) -> list[str]:
    known = set(names(b, kind))
    return [name for name in names(a, kind) if name and name in known]

"""Pictures of two models from the same places. Runs in the child process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from composer.engine.framing import brightened, camera, has_sky, prepared
from composer.engine.png import png

WHOLE = "the whole"
WIDTH, HEIGHT = 640, 480
# Renderers differ in the last bits of a colour, of 255.
_SAME = 2


def pictures(mujoco: Any, a: Any, b: Any, folder: str) -> dict[str, Any]:
    """Write `N-a.png` and `N-b.png` below `folder` for each view N; `views` has their names and the share that differs.

    Views are the cameras that both models have by name, and one of the whole of both. Both are at their first common
    keyframe, otherwise at the reference configuration. `no OpenGL` says why there are none.
    """
    key = next((name for name in _names(mujoco, a, "key") if name in _names(mujoco, b, "key")), None)
    try:
        scenes = [_Scene(mujoco, model, key) for model in (a, b)]
    except Exception as error:  # whatever a system without OpenGL raises
        return {"no OpenGL": str(error).strip() or type(error).__name__}
    free = camera(mujoco, [(scene.model, scene.data) for scene in scenes], WIDTH / HEIGHT)
    cameras = [name for name in _names(mujoco, a, "camera") if name in _names(mujoco, b, "camera")]
    views: list[tuple[str, Any]] = [(WHOLE, free), *((name, name) for name in cameras)]
    told = []
    for number, (name, view) in enumerate(views):
        before, after = (scene.picture(view) for scene in scenes)
        for side, picture in (("a", before), ("b", after)):
            Path(folder, f"{number}-{side}.png").write_bytes(png(picture))
        differs = (np.abs(before.astype(int) - after) > _SAME).any(axis=2)
        told.append({"name": name, "differs": float(differs.mean())})
    return {"views": told, "key": key}


class _Scene:
    def __init__(self, mujoco: Any, model: Any, key: str | None) -> None:
        limits = model.vis.global_
        limits.offwidth, limits.offheight = max(limits.offwidth, WIDTH), max(limits.offheight, HEIGHT)
        self.mujoco, self.model = mujoco, model
        self.data = mujoco.MjData(model)
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, self.data, model.key(key).id)
        mujoco.mj_forward(model, self.data)
        self.renderer = mujoco.Renderer(model, HEIGHT, WIDTH)

    def picture(self, camera: Any) -> Any:
        distance = 0.0 if isinstance(camera, str) else camera.distance
        with prepared(self.mujoco, self.model, distance):
            self.renderer.update_scene(self.data, camera)
            picture = self.renderer.render().copy()
            if has_sky(self.mujoco, self.model):
                return picture
            self.renderer.enable_segmentation_rendering()
            behind = self.renderer.render()[:, :, 0] < 0
            self.renderer.disable_segmentation_rendering()
        return brightened(picture, behind)


def _names(mujoco: Any, model: Any, kind: str) -> list[str]:
    code = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
    count = getattr(model, {"key": "nkey", "camera": "ncam"}[kind])
    return [name for index in range(count) if (name := mujoco.mj_id2name(model, code, index))]

"""Render pictures of a compiled model with MuJoCo's own renderer."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.diagnostics.call_site import call_site
from composer.mjcf.errors import failure
from composer.mjcf.physics.compile import engine
from composer.mujoco_errors.sentence import Topic, read_sentence


class Rendering:
    """A renderer that is reused while the size of the pictures stays the same."""

    __slots__ = ("_renderer", "_size")

    def __init__(self) -> None:
        self._renderer: Any = None
        self._size = (0, 0)

    def picture(self, model: Any, data: Any, height: int, width: int, camera: int) -> NDArray[np.uint8]:
        """Render an RGB image of the shape `(height, width, 3)`."""
        for what, number in (("height", height), ("width", width)):
            if not isinstance(number, int | np.integer) or number < 1:
                raise failure("out-of-range", f"`{what}` is a number of pixels, got `{number}`", call_site())
        if self._renderer is None or self._size != (height, width):
            self.close()
            self._renderer, self._size = _renderer(model, height, width), (height, width)
        self._renderer.update_scene(data, camera)
        picture: NDArray[np.uint8] = self._renderer.render()
        return picture.copy()

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


def _renderer(model: Any, height: int, width: int) -> Any:
    """Return MuJoCo's renderer. It is not bound by the model's image size, which is that of its author's window."""
    limits = model.vis.global_
    kept = limits.offwidth, limits.offheight
    limits.offwidth, limits.offheight = max(kept[0], width), max(kept[1], height)
    try:
        return engine().Renderer(model, height, width)
    except Exception as error:
        if read_sentence(str(error)).topic is Topic.FRAMEBUFFER:
            size = f"{width} times {height} pixels"
            message = f"OpenGL has no room for a picture of {size}: {error}"
            raise failure("out-of-range", message, call_site()) from error
        raise failure(
            "not-supported",
            f"OpenGL is not available for rendering: {error}",
            call_site(),
            help="without a display set `MUJOCO_GL=egl` (or `osmesa`) before MuJoCo is imported",
        ) from error
    finally:
        limits.offwidth, limits.offheight = kept

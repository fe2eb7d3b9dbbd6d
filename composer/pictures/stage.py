"""Render one compiled model."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.compiled.placed import place
from composer.dataclass import dataclass
from composer.pictures.background import over
from composer.pictures.framing import camera, corners, has_sky, prepared

_SHADOWS, _SHADOWS_OF_TILES = 4096, 1024
_SAMPLES_OF_TILES = 2
# The mask of the model is this much finer than the picture, so that its edges are smooth.
_FINER = 2


class NoOpenGL(Exception):
    """OpenGL is not available; the text is the system's message."""


@dataclass(frozen=True, slots=True)
class Look:
    """The settings of a picture.

    `background` is RGB of 255 and an opacity of 1 or 0; None is the model's sky, or light grey if it has none.
    `is_tile` says that the picture is one of many: it gets smaller shadows, which take most of the time without a
    GPU.
    """

    width: int = 640
    height: int = 480
    background: tuple[int, int, int, int] | None = None
    is_tile: bool = False

    @property
    def aspect(self) -> float:
        return self.width / self.height


class Stage:
    """A model with its data and a renderer of its own. Raises `NoOpenGL` if that is not available."""

    def __init__(self, mujoco: Any, model: Any, key: str | int | None, look: Look) -> None:
        self.mujoco, self.model, self.look = mujoco, model, look
        self.data = mujoco.MjData(model)
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, self.data, model.key(key).id)
        place(mujoco, model, self.data)
        self._prepare_buffers()
        try:
            from mujoco.gl_context import GLContext

            self._window = GLContext(look.width * _FINER, look.height * _FINER)
            self._window.make_current()
            self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        except Exception as error:
            raise NoOpenGL(str(error).strip() or type(error).__name__) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        self._scene = mujoco.MjvScene(model, maxgeom=_room(model))

    def _prepare_buffers(self) -> None:
        """Raise the model's limits, which are for its author's window, and limit shadows to what this picture needs."""
        limits, quality, look = self.model.vis.global_, self.model.vis.quality, self.look
        limits.offwidth = max(limits.offwidth, look.width * _FINER)
        limits.offheight = max(limits.offheight, look.height * _FINER)
        quality.shadowsize = min(quality.shadowsize, _SHADOWS_OF_TILES if look.is_tile else _SHADOWS)
        if look.is_tile:
            quality.offsamples = min(quality.offsamples, _SAMPLES_OF_TILES)

    def whole(self) -> Any:
        """Return the camera that shows the whole model."""
        return camera(self.mujoco, [(self.model, self.data)], self.look.aspect)

    def picture(self, view: Any) -> Any:
        """Return the picture of a camera, `(height, width, 3)` or with opacity `(height, width, 4)`, in bytes.

        `view` is the name of a camera of the model, or an `MjvCamera`.
        """
        mujoco, look = self.mujoco, self.look
        self._window.make_current()
        with prepared(mujoco, self.model, self._distance(view)):
            mujoco.mjv_updateScene(
                self.model, self.data, mujoco.MjvOption(), None, self._camera(view),
                mujoco.mjtCatBit.mjCAT_ALL.value, self._scene,
            )  # fmt: skip
            sky = has_sky(mujoco, self.model) and look.background is None
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = sky
            drawn = self._pixels(look.width, look.height)
            return drawn if sky else over(drawn, self._share_drawn(), look.background)

    def text(self, words: str, width: int, height: int, ink: Any, paper: Any) -> Any:
        """Return a line of text in MuJoCo's own font, `(height, width, 3)`; paper and ink are RGB from 0 to 1."""
        self._window.make_current()
        strip = self.mujoco.MjrRect(0, 0, width, height)
        self.mujoco.mjr_rectangle(strip, *paper, 1.0)
        font = self.mujoco.mjtFont.mjFONT_NORMAL.value
        room = max(1, (width - 8) // max(1, int(self._drawing.charWidth[ord("n")])))
        shown = words if len(words) <= room else f"{words[: max(1, room - 2)]}.."
        shown = shown.encode("ascii", "replace").decode("ascii")
        self.mujoco.mjr_text(font, shown, self._drawing, 6 / width, 2 / height, *ink)
        return self._read(width, height)

    def close(self) -> None:
        self._window.make_current()
        self._drawing.free()
        self._window.free()

    def _distance(self, view: Any) -> float:
        """Return the largest possible distance of visible things."""
        if not isinstance(view, str):
            return float(view.distance)
        away = corners(self.mujoco, self.model, self.data) - self.data.camera(view).xpos
        return float(np.linalg.norm(away, axis=1).max()) if len(away) else 0.0

    def _camera(self, view: Any) -> Any:
        if not isinstance(view, str):
            return view
        fixed = self.mujoco.MjvCamera()
        fixed.type, fixed.fixedcamid = self.mujoco.mjtCamera.mjCAMERA_FIXED, self.model.camera(view).id
        return fixed

    def _pixels(self, width: int, height: int) -> Any:
        self.mujoco.mjr_render(self.mujoco.MjrRect(0, 0, width, height), self._scene, self._drawing)
        return self._read(width, height)

    def _read(self, width: int, height: int) -> Any:
        found = np.empty((height, width, 3), np.uint8)
        self.mujoco.mjr_readPixels(found, None, self.mujoco.MjrRect(0, 0, width, height), self._drawing)
        return np.flipud(found).copy()

    def _share_drawn(self) -> Any:
        """Return the share of each pixel that is drawn, `(height, width)`, from 0 to 1.

        It uses depth, because MuJoCo's segmentation leaves out sites and tendons.
        """
        flags, kinds, look = self._scene.flags, self.mujoco.mjtRndFlag, self.look
        for costly in (kinds.mjRND_SHADOW, kinds.mjRND_REFLECTION):
            flags[costly] = 0
        width, height = look.width * _FINER, look.height * _FINER
        room = self.mujoco.MjrRect(0, 0, width, height)
        self.mujoco.mjr_render(room, self._scene, self._drawing)
        depth = np.empty((height, width), np.float32)
        self.mujoco.mjr_readPixels(None, depth, room, self._drawing)
        for costly in (kinds.mjRND_SHADOW, kinds.mjRND_REFLECTION):
            flags[costly] = 1
        seen = np.flipud(depth) < 1
        return seen.reshape(look.height, _FINER, look.width, _FINER).mean(axis=(1, 3))


def _room(model: Any) -> int:
    """Return the maximum number of objects in a scene: all of the model, and decorations."""
    return int(2 * (model.ngeom + model.nsite + model.nflex + model.nskin) + 100 * model.ntendon + 2000)

"""Pictures of compiled models: camera, lights, background, sheets."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mjcompose.base.dataclass import dataclass
from mjcompose.mujoco.attributes import names, place
from mjcompose.mujoco.controls import advance
from mjcompose.mujoco.film import NoEncoder, encoder, gif, png, write_mp4
from mjcompose.mujoco.subject import corners, decorate, explode, points_of

SKYLESS = (235, 235, 235, 1)
"""The background of a model without a sky. MuJoCo 4.0 leaves it black, which hides dark models."""


def over(picture: Any, drawn: Any, background: tuple[int, int, int, int] | None) -> Any:
    """Return a picture on black composited over a background; `drawn` is the share of each pixel that is drawn.

    MuJoCo blends edges with black, so only the background has to be added there.
    """
    *color, opacity = SKYLESS if background is None else background
    if opacity:
        behind = (1 - drawn)[:, :, None] * np.array(color)
        return np.clip(np.rint(picture + behind), 0, 255).astype(np.uint8)
    share = np.rint(drawn * 255).astype(np.uint8)
    # A PNG has colors that are not multiplied by their opacity.
    own = np.clip(picture / np.maximum(drawn, 1 / 255)[:, :, None], 0, 255)
    return np.dstack([np.rint(own).astype(np.uint8), share])


_MARGIN = 1.08
_ROUNDS = 4
# MuJoCo's default view: straight at one side, and steeply down.
_UNSAID = (90.0, -45.0)
_OBLIQUE = (135.0, -22.0)
_AMBIENT, _DIFFUSE, _SPECULAR = 0.3, 0.6, 0.3


def camera(mujoco: Any, scenes: Sequence[tuple[Any, Any]], aspect: float, subject: Any = None) -> Any:
    """Return the free camera that shows the whole of some models, each with its data.

    It looks in the direction of the first model's `azimuth` and `elevation` in `visual/global`, or obliquely if
    these are MuJoCo's defaults. `aspect` is the width of the picture divided by its height, `subject` the points to
    show instead of the whole.
    """
    model = scenes[0][0]
    free = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, free)
    if (free.azimuth, free.elevation) == _UNSAID:
        free.azimuth, free.elevation = _OBLIQUE
    points = np.concatenate([corners(mujoco, *each) for each in scenes]) if subject is None else subject
    if not len(points):
        return free
    azimuth, elevation = math.radians(free.azimuth), math.radians(free.elevation)
    forward = np.array(
        [math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)]
    )
    right = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    axes = np.stack([right, np.cross(right, forward), forward])
    # The `fovy` of an orthographic camera is a length.
    fovy = 45.0 if model.vis.global_.orthographic else float(model.vis.global_.fovy)
    high = math.tan(math.radians(fovy) / 2) / _MARGIN
    slopes = np.array([high * aspect, high])
    at, distance = (points.min(axis=0) + points.max(axis=0)) / 2, 0.0
    for _ in range(_ROUNDS):
        seen = (points - at) @ axes.T
        distance = float((np.abs(seen[:, :2]) / slopes - seen[:, 2:]).max())
        # Nearer things look larger: the middle of the picture is not the middle of the box.
        depth = np.maximum(seen[:, 2:] + distance, 1e-9)
        shown = seen[:, :2] / depth
        at = at + ((shown.min(axis=0) + shown.max(axis=0)) / 2 * distance) @ axes[:2]
    seen = (points - at) @ axes.T
    free.lookat[:] = at
    free.distance = max(float((np.abs(seen[:, :2]) / slopes - seen[:, 2:]).max()), 1e-6)
    return free


@contextmanager
def prepared(model: Any, distance: float = 0.0) -> Iterator[None]:
    """Make a model visible from that distance for the block, and restore it afterwards."""
    headlight, limits, clip = model.vis.headlight, model.vis.global_, model.vis.map
    kept = (
        headlight.active, headlight.ambient.copy(), headlight.diffuse.copy(), headlight.specular.copy(),
        limits.orthographic, clip.zfar,
    )  # fmt: skip
    if not is_lit(model):
        headlight.active = headlight.active or 1
        headlight.ambient[:] = np.maximum(headlight.ambient, _AMBIENT)
        headlight.diffuse[:] = np.maximum(headlight.diffuse, _DIFFUSE)
        headlight.specular[:] = np.maximum(headlight.specular, _SPECULAR)
    limits.orthographic = 0
    clip.zfar = max(clip.zfar, 3 * distance / max(model.stat.extent, 1e-9))
    try:
        yield
    finally:
        headlight.active, limits.orthographic, clip.zfar = kept[0], kept[4], kept[5]
        headlight.ambient[:], headlight.diffuse[:], headlight.specular[:] = kept[1:4]


def is_lit(model: Any) -> bool:
    """Return whether a light of the model is on."""
    return any(
        model.light_active[each] and (model.light_diffuse[each].any() or model.light_ambient[each].any())
        for each in range(model.nlight)
    )


def has_sky(mujoco: Any, model: Any) -> bool:
    """Return whether the model has a skybox."""
    return bool((model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX).any())


_SHADOWS, _SHADOWS_OF_TILES = 4096, 1024
_SAMPLES_OF_TILES = 2
# The mask of the model is this much finer than the picture, for smooth edges.
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
    explode: bool = False
    labels: tuple[str, ...] = ()

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
        self.links = explode(mujoco, model, self.data) if look.explode else []
        self._prepare_buffers()
        try:
            from mujoco.gl_context import GLContext

            self._window = GLContext(look.width * _FINER, look.height * _FINER)
            self._window.make_current()
            self._drawing = mujoco.MjrContext(model, self._font_scale())
        except Exception as error:
            raise NoOpenGL(str(error).strip() or type(error).__name__) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        # All of the model, and decorations.
        most = 2 * (model.ngeom + model.nsite + model.nflex + model.nskin) + 100 * model.ntendon + 2000
        self._scene = mujoco.MjvScene(model, maxgeom=int(most))

    def _prepare_buffers(self) -> None:
        """Raise the model's limits, which are for its author's window, and limit shadows to this picture."""
        limits, quality, look = self.model.vis.global_, self.model.vis.quality, self.look
        limits.offwidth = max(limits.offwidth, look.width * _FINER)
        limits.offheight = max(limits.offheight, look.height * _FINER)
        quality.shadowsize = min(quality.shadowsize, _SHADOWS_OF_TILES if look.is_tile else _SHADOWS)
        if look.is_tile:
            quality.offsamples = min(quality.offsamples, _SAMPLES_OF_TILES)

    def _font_scale(self) -> int:
        scale = 50 * min(6, max(2, round(self.look.width / 480)))
        return int(getattr(self.mujoco.mjtFontScale, f"mjFONTSCALE_{scale}").value)

    def whole(self, subject: Any = None) -> Any:
        """Return the camera that shows the whole model, or the points of a subject."""
        return camera(self.mujoco, [(self.model, self.data)], self.look.aspect, subject=subject)

    def picture(self, view: Any) -> Any:
        """Return the picture of a camera, `(height, width, 3)` or with opacity `(height, width, 4)`, in bytes.

        `view` is the name of a camera of the model, or an `MjvCamera`.
        """
        mujoco, look = self.mujoco, self.look
        self._window.make_current()
        with prepared(self.model, self._distance(view)):
            mujoco.mjv_updateScene(
                self.model, self.data, mujoco.MjvOption(), None, self._camera(view),
                mujoco.mjtCatBit.mjCAT_ALL.value, self._scene,
            )  # fmt: skip
            decorate(mujoco, self.model, self.data, scene=self._scene, links=self.links, labels=look.labels)
            sky = has_sky(mujoco, self.model) and look.background is None
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = sky
            mujoco.mjr_render(mujoco.MjrRect(0, 0, look.width, look.height), self._scene, self._drawing)
            drawn = self._read(look.width, look.height)
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


_TURN_SECONDS = 4.0
_RATES = {".gif": 20, ".mp4": 30}


class _StoppedError(Exception):
    """The simulation cannot go on, for the reason that it says."""


def draw(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write a file and return an empty answer, or why it could not be written; runs under
    `mjcompose.mujoco.engine.call`.

    ``asked`` has the fields of `mjcompose.tools.view.render.Wish` and ``out``, whose suffix is `.png`,
    `.gif` or `.mp4`. With ``tile``, a NumPy array of the picture with that text below goes to ``out`` instead.
    """
    for kind in ("key", "camera"):
        if asked[kind] is not None and asked[kind] not in names(model, kind):
            return {"unknown": kind, "known": [name for name in names(model, kind) if name]}
    if (subject := asked["look"]) is not None and subject[1] not in names(model, subject[0]):
        return {"unknown": subject[0], "known": [name for name in names(model, subject[0]) if name]}
    out = Path(asked["out"])
    background = None if asked["background"] is None else tuple(asked["background"])
    tile = asked.get("tile")
    width, height = asked["size"]
    look = Look(
        width, height, background, is_tile=tile is not None, explode=asked["explode"], labels=tuple(asked["labels"])
    )
    key = asked["key"] if asked["key"] is not None else (0 if model.nkey else None)
    try:
        if out.suffix == ".mp4":
            encoder()
        stage = Stage(mujoco, model, key, look=look)
    except NoEncoder as error:
        return {"no encoder": str(error)}
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    view = asked["camera"]
    if view is None:
        view = stage.whole(None if subject is None else points_of(mujoco, model, stage.data, *subject))
    try:
        if tile is not None:
            picture = stage.picture(view)[:, :, :3]
            high = round(_STRIP * max(1.0, picture.shape[1] / 480))
            strip = stage.text(tile, picture.shape[1], high, ink=_INK, paper=_DRAW_PAPER)
            np.save(out, np.concatenate([picture, strip]))
        elif out.suffix == ".png":
            out.write_bytes(png(stage.picture(view)))
        else:
            rate = _RATES[out.suffix]
            frames = list(_frames(stage, view, rate, turntable=asked["turntable"], play=asked["play"]))
            if out.suffix == ".mp4":
                write_mp4(out, frames, rate)
            else:
                out.write_bytes(gif(frames, 1 / rate))
    except _StoppedError as error:
        return {"stopped": str(error)}
    finally:
        stage.close()
    return {}


def _frames(stage: Stage, view: Any, rate: int, turntable: bool, play: float | None) -> Iterator[Any]:
    """Yield the pictures of a film: physics for `play` seconds, a turn around the model, or both at once.

    Raises _StoppedError if the simulation cannot go on.
    """
    seconds = _TURN_SECONDS if play is None else play
    count = max(2, round(seconds * rate))
    started = stage.data.time
    for number in range(count):
        if play is not None:
            stopped = advance(stage.mujoco, stage.model, stage.data, end=number / rate, begun=started)
            if stopped is not None:
                raise _StoppedError(stopped)
        yield stage.picture(view)
        if turntable:
            view.azimuth += 360 / count


_STRIP = 20
_INK, _DRAW_PAPER = (0.92, 0.93, 0.95), (0.13, 0.15, 0.19)


WHOLE = "the whole"
# Renderers differ in the last bits of a color value (0 to 255).
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


_GAP = 6
_SHEET_PAPER = 255


def sheet(mujoco: Any, asked: Mapping[str, Any]) -> None:
    """Write the PNG ``out`` from the arrays in the files ``tiles``; runs under `mjcompose.mujoco.engine.call`."""
    tiles = [np.load(each) for each in asked["tiles"]]
    height, width, _ = tiles[0].shape
    columns = columns_of(len(tiles), width / height)
    rows = math.ceil(len(tiles) / columns)
    paper = np.full((rows * (height + _GAP) + _GAP, columns * (width + _GAP) + _GAP, 3), _SHEET_PAPER, np.uint8)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, columns)
        top, left = _GAP + row * (height + _GAP), _GAP + column * (width + _GAP)
        paper[top : top + height, left : left + width] = tile
    Path(asked["out"]).write_bytes(png(paper))


def columns_of(count: int, aspect: float) -> int:
    """Return the number of tiles in a row of a sheet that is about as wide as high, or a little wider.

    >>> [columns_of(count, 4 / 3) for count in (1, 2, 6, 16, 100)]
    [1, 2, 3, 4, 11]
    """
    return max(1, min(count, round(math.sqrt(count * 1.6 / aspect))))

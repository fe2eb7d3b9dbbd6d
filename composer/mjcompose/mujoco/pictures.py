"""Pictures of compiled models: subject, exploded view, names, camera, lights, background, sheets."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.attributes import holder, names, place
from mjcompose.mujoco.controls import advance
from mjcompose.mujoco.film import NoEncoder, encoder, gif, png, write_mp4
from mjcompose.mujoco.labels import draw_line, projection, pushed_apart
from mjcompose.mujoco.solids import SIGNS, box_corners

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

Link = tuple[Any, Any]
_AROUND = 0.1  # how much of the model is around a point
_APART = 0.5  # how far parts move, as a share of their size
_INK = (0.96, 0.6, 0.1, 1.0)
_WIDTH = 2.0
_LABEL_INK = (0.1, 0.12, 0.16)
_LABEL_PAPER = (0.96, 0.97, 0.98)
_PLACES = {"site": "site_xpos", "body": "xipos", "joint": "xanchor", "geom": "geom_xpos"}
_SHOWN_GROUPS = 3


def corners(mujoco: Any, model: MjModel, data: MjData, some: Sequence[int] | None = None) -> Any:
    """Return the corners of the boxes around all drawn geoms, or only `some`; the ground counts only if it is alone."""
    drawn = [each for each in range(model.ngeom) if _is_drawn(model, each)] if some is None else some
    plane = int(mujoco.mjtGeom.mjGEOM_PLANE)
    terrain = int(mujoco.mjtGeom.mjGEOM_HFIELD)
    solid = [each for each in drawn if int(model.geom_type[each]) not in (plane, terrain)]
    found = [np.zeros((0, 3))]
    for geom in solid or drawn:
        center = model.geom_aabb[geom][:3]
        half = model.geom_aabb[geom][3:]
        if model.geom_type[geom] == plane:
            half = model.geom_size[geom][:2]  # 0 for infinite, which counts as 1
            center = np.zeros(3)
            half = np.array([*np.where(half > 0, half, 1.0), 0.0])
        found.append(box_corners(data, geom, center=center, half=half))
    if some is None:
        found += [data.flexvert_xpos.reshape(-1, 3), data.xpos[model.skin_bonebodyid]]
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def _is_drawn(model: MjModel, geom: int) -> bool:
    material = int(model.geom_matid[geom])
    rgba = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    return int(model.geom_group[geom]) < _SHOWN_GROUPS and float(rgba[3]) > 0


def points_of(mujoco: Any, model: MjModel, data: MjData, kind: str, name: str) -> Any:
    """Return the points around an element, for a camera; for a body, also the points around the bodies on it."""
    at = names(model, kind).index(name)
    geoms = [at] if kind == "geom" else []
    if kind in ("body", "joint"):
        body = at if kind == "body" else holder(model, kind, at)
        on_it = [each == body for each in range(model.nbody)]
        for each in range(1, model.nbody):  # a parent comes first
            on_it[each] |= on_it[model.body_parentid[each]]
        geoms = [geom for geom in range(model.ngeom) if on_it[model.geom_bodyid[geom]]]
    found = corners(mujoco, model, data, some=geoms) if geoms else np.zeros((0, 3))
    if len(found):
        return found
    whole = corners(mujoco, model, data)
    reach = _AROUND * float(np.ptp(whole, axis=0).max(initial=0) if len(whole) else 1)
    return getattr(data, _PLACES[kind])[at] + reach * np.array(SIGNS)


def explode(mujoco: Any, model: MjModel, data: MjData) -> list[Link]:
    """Move the parts (bodies with one prefix, or each body) away from the bodies below; return lines to those."""
    first = _first_of_part(model)
    boxes = _boxes(mujoco, model, data, first)
    middle = np.mean([center for part, (center, _) in boxes.items() if part], axis=0) if len(boxes) > 1 else np.zeros(3)
    moved = np.zeros((model.nbody, 3))
    links = []
    before = data.xpos.copy()
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        moved[body] = moved[parent]
        if first[body] == body:
            center, size = boxes[body]
            away = center - (boxes[first[parent]][0] if first[parent] else middle)
            away[2] = max(away[2], 0) if not first[parent] else away[2]  # nothing goes below the ground
            length = float(np.linalg.norm(away))
            on = max(size, boxes[first[parent]][1] if first[parent] else 0)
            moved[body] += _APART * on * (away / length if length > 1e-6 else np.array([0, 0, 1.0]))
            if first[parent]:
                links.append((before[body] + moved[parent], before[body] + moved[body]))
    for array, bodies in (
        ("xpos", np.arange(model.nbody)),
        ("xipos", np.arange(model.nbody)),
        ("geom_xpos", model.geom_bodyid),
        ("site_xpos", model.site_bodyid),
        ("xanchor", model.jnt_bodyid),
        ("cam_xpos", model.cam_bodyid),
    ):
        getattr(data, array)[:] += moved[bodies]
    if model.nflexvert:
        data.flexvert_xpos[:] += moved[np.maximum(model.flex_vertbodyid, 0)]
    return links


def _first_of_part(model: MjModel) -> list[int]:
    """Return for each body the first body of its part; without prefixes, each body is a part."""
    prefixes = [name.rpartition("/")[0] for name in names(model, "body")]
    has_parts = any(prefixes)
    first = list(range(model.nbody))
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        if has_parts and prefixes[body] == prefixes[parent] and parent:
            first[body] = first[parent]
    return first


def _boxes(mujoco: Any, model: MjModel, data: MjData, first: list[int]) -> dict[int, tuple[Any, float]]:
    """Return the center and the diagonal of the box around each part, by its first body."""
    geoms: dict[int, list[int]] = {part: [] for part in sorted(set(first))}
    for geom in range(model.ngeom):
        geoms[first[int(model.geom_bodyid[geom])]].append(geom)
    boxes = {}
    for part, own in geoms.items():
        points = corners(mujoco, model, data, some=own) if own else data.xpos[part][None]
        low = points.min(axis=0)
        high = points.max(axis=0)
        boxes[part] = (low + high) / 2, float(np.linalg.norm(high - low))
    return boxes


def draw_links(mujoco: Any, scene: Any, links: Iterable[Link]) -> None:
    """Add lines to a scene."""
    kinds = mujoco.mjtGeom
    for start, end in links:
        geom = _new(mujoco, scene, kinds.mjGEOM_LINE)
        if geom is not None:
            mujoco.mjv_connector(geom, kinds.mjGEOM_LINE, _WIDTH, start, end)


def _new(mujoco: Any, scene: Any, kind: Any) -> Any:
    if scene.ngeom >= scene.maxgeom:
        return None
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(_INK, np.float32))
    geom.category = mujoco.mjtCatBit.mjCAT_DECOR
    scene.ngeom += 1
    return geom


NEEDS_OPENGL = "without a display, set `MUJOCO_GL=egl` or `MUJOCO_GL=osmesa`, and install EGL or OSMesa"
SKYLESS = (235, 235, 235, 1)
"""The background of a model without a sky. MuJoCo 4.0 leaves it black, which hides dark models."""


def over(picture: Any, drawn: Any, background: tuple[int, int, int, int] | None) -> Any:
    """Put a picture on black over a background. `drawn` is the share of each pixel, for blended edges."""
    *color, opacity = SKYLESS if background is None else background
    if opacity:
        return np.clip(np.rint(picture + (1 - drawn)[:, :, None] * np.array(color)), 0, 255).astype(np.uint8)
    share = np.rint(drawn * 255).astype(np.uint8)
    # A PNG has colors that are not multiplied by their opacity.
    own = np.clip(picture / np.maximum(drawn, 1 / 255)[:, :, None], 0, 255)
    return np.dstack([np.rint(own).astype(np.uint8), share])


_MARGIN = 1.08
_ROUNDS = 4
# MuJoCo's default view: straight at one side, and steeply down.
_UNSAID = (90.0, -45.0)
_OBLIQUE = (135.0, -22.0)
_HEADLIGHT = {"ambient": 0.3, "diffuse": 0.6, "specular": 0.3}


def camera(mujoco: Any, scenes: Sequence[tuple[Any, Any]], aspect: float, subject: Any = None) -> Any:
    """Return the free camera that shows the whole of some models, each with its data.

    It looks in the direction of the first model's `azimuth` and `elevation` in `visual/global`, or obliquely if these
    have MuJoCo's default values. `aspect` is the width of the picture divided by its height, and `subject` has the
    points to show instead of the whole.
    """
    model = scenes[0][0]
    free = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, free)
    if (free.azimuth, free.elevation) == _UNSAID:
        free.azimuth, free.elevation = _OBLIQUE
    points = np.concatenate([corners(mujoco, *each) for each in scenes]) if subject is None else subject
    if not len(points):
        return free
    azimuth = math.radians(free.azimuth)
    elevation = math.radians(free.elevation)
    ahead, right = np.array([[math.cos(azimuth), math.sin(azimuth), 0], [math.sin(azimuth), -math.cos(azimuth), 0]])
    forward = math.cos(elevation) * ahead + np.array([0, 0, math.sin(elevation)])
    axes = np.stack([right, np.cross(right, forward), forward])
    # The `fovy` of an orthographic camera is a length.
    fovy = 45.0 if model.vis.global_.orthographic else float(model.vis.global_.fovy)
    high = math.tan(math.radians(fovy) / 2) / _MARGIN
    slopes = np.array([high * aspect, high])
    at = (points.min(axis=0) + points.max(axis=0)) / 2
    distance = 0.0
    for left in reversed(range(_ROUNDS + 1)):
        seen = (points - at) @ axes.T
        distance = float((np.abs(seen[:, :2]) / slopes - seen[:, 2:]).max())
        if left:  # nearer things look larger: the middle of the picture is not the middle of the box
            shown = seen[:, :2] / np.maximum(seen[:, 2:] + distance, 1e-9)
            at = at + ((shown.min(axis=0) + shown.max(axis=0)) / 2 * distance) @ axes[:2]
    free.lookat[:] = at
    free.distance = max(distance, 1e-6)
    return free


@contextmanager
def prepared(model: MjModel, distance: float = 0.0) -> Iterator[None]:
    """Make a model visible from that distance for the block, and restore it afterwards."""
    headlight = model.vis.headlight
    limits = model.vis.global_
    clip = model.vis.map
    colors = {name: getattr(headlight, name) for name in _HEADLIGHT}
    kept = headlight.active, limits.orthographic, clip.zfar
    kept_colors = {name: color.copy() for name, color in colors.items()}
    if not is_lit(model):
        headlight.active = headlight.active or 1
        for name, color in colors.items():
            color[:] = np.maximum(color, _HEADLIGHT[name])
    limits.orthographic = 0
    clip.zfar = max(clip.zfar, 3 * distance / max(model.stat.extent, 1e-9))
    try:
        yield
    finally:
        headlight.active, limits.orthographic, clip.zfar = kept
        for name, color in colors.items():
            color[:] = kept_colors[name]


def is_lit(model: MjModel) -> bool:
    """Return whether a light of the model is on."""
    shining = model.light_diffuse.any(axis=1) | model.light_ambient.any(axis=1)
    return bool((model.light_active.astype(bool) & shining).any())


def has_sky(mujoco: Any, model: MjModel) -> bool:
    """Return whether the model has a skybox."""
    return bool((model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX).any())


_SHADOWS = 4096
_SHADOWS_OF_TILES = 1024
_SAMPLES_OF_TILES = 2
# The mask of the model is this much finer than the picture, for smooth edges.
_FINER = 2


class NoOpenGL(Exception):
    """OpenGL is not available; the text is the system's message."""


class Look(Struct):
    """The settings of a picture.

    `background` is RGB of 255 and an opacity of 1 or 0; None is the model's sky, or light grey if it has no sky.
    `is_tile` says that the picture is one of many, so it gets smaller shadows, which take most of the time without a
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

    def __init__(self, mujoco: Any, model: MjModel, key: str | int | None, look: Look) -> None:
        self.mujoco = mujoco
        self.model = model
        self.look = look
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
            scale = 50 * min(6, max(2, round(look.width / 480)))
            self._drawing = mujoco.MjrContext(model, getattr(mujoco.mjtFontScale, f"mjFONTSCALE_{scale}").value)
        except Exception as error:
            raise NoOpenGL(str(error).strip() or type(error).__name__) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        # All of the model, and decorations.
        most = 2 * (model.ngeom + model.nsite + model.nflex + model.nskin) + 100 * model.ntendon + 2000
        self._scene = mujoco.MjvScene(model, maxgeom=int(most))

    def _prepare_buffers(self) -> None:
        """Raise the model's limits, which are for its author's window, and limit shadows to this picture."""
        limits = self.model.vis.global_
        quality = self.model.vis.quality
        look = self.look
        limits.offwidth = max(limits.offwidth, look.width * _FINER)
        limits.offheight = max(limits.offheight, look.height * _FINER)
        quality.shadowsize = min(quality.shadowsize, _SHADOWS_OF_TILES if look.is_tile else _SHADOWS)
        if look.is_tile:
            quality.offsamples = min(quality.offsamples, _SAMPLES_OF_TILES)

    def whole(self, subject: Any = None) -> Any:
        """Return the camera that shows the whole model, or the points of a subject."""
        return camera(self.mujoco, [(self.model, self.data)], self.look.aspect, subject=subject)

    def picture(self, view: Any) -> Any:
        """Return the picture of a camera, by name or `MjvCamera`, in bytes: `(height, width, 3 or 4 with opacity)`."""
        mujoco = self.mujoco
        look = self.look
        self._window.make_current()
        with prepared(self.model, self._distance(view)):
            mujoco.mjv_updateScene(
                self.model,
                self.data,
                mujoco.MjvOption(),
                None,
                self._camera(view),
                mujoco.mjtCatBit.mjCAT_ALL.value,
                self._scene,
            )
            draw_links(mujoco, self._scene, self.links)
            sky = has_sky(mujoco, self.model) and look.background is None
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = sky
            mujoco.mjr_render(mujoco.MjrRect(0, 0, look.width, look.height), self._scene, self._drawing)
            drawn = self._read(look.width, look.height)
            found = drawn if sky else over(drawn, self._share_drawn(), look.background)
            self._write_names(found)
            return found

    def _write_names(self, picture: Any) -> None:
        """Write the names of elements into a picture, with a line from each name to its element.

        MuJoCo's own drawing of names puts them over each other.
        """
        at = projection(self._scene, self.look.width, self.look.height)
        elements = [
            (name, point)
            for kind in self.look.labels
            for name, there in zip(names(self.model, kind), getattr(self.data, _PLACES[kind]), strict=True)
            if name not in ("", "world") and (point := at(there)) is not None
        ]
        points = [point for _, point in elements]
        font = self._drawing
        height = int(font.charHeight) + 4
        widths = [sum(int(font.charWidth[ord(each)]) for each in _ascii(name)) + 14 for name, _ in elements]
        room = (0.0, 0.0, float(picture.shape[1]), float(picture.shape[0]))
        boxes = pushed_apart(points, [(width, height) for width in widths], room)
        for point, box in zip(points, boxes, strict=True):
            near = min(max(point[0], box[0]), box[2]), min(max(point[1], box[1]), box[3])
            draw_line(picture, point, near, [round(255 * each) for each in _INK[:3]])
        for (name, _), (left, top, *_), width in zip(elements, boxes, widths, strict=True):
            shown = self._line(_ascii(name), width, height, ink=_LABEL_INK, paper=_LABEL_PAPER)
            place = picture[round(top) : round(top) + height, round(left) : round(left) + width]
            place[:, :, :3] = shown[: place.shape[0], : place.shape[1]]
            place[:, :, 3:] = 255

    def text(self, words: str, width: int, height: int, ink: Any, paper: Any) -> Any:
        """Return a line of text in MuJoCo's own font, `(height, width, 3)`; paper and ink are RGB from 0 to 1."""
        self._window.make_current()
        room = max(1, (width - 8) // max(1, int(self._drawing.charWidth[ord("n")])))
        shown = words if len(words) <= room else f"{words[: max(1, room - 2)]}.."
        return self._line(_ascii(shown), width, height, ink=ink, paper=paper)

    def _line(self, shown: str, width: int, height: int, ink: Any, paper: Any) -> Any:
        """Return a line of text that fits."""
        self.mujoco.mjr_rectangle(self.mujoco.MjrRect(0, 0, width, height), *paper, 1.0)
        font = self.mujoco.mjtFont.mjFONT_NORMAL.value
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
        fixed.type = self.mujoco.mjtCamera.mjCAMERA_FIXED
        fixed.fixedcamid = self.model.camera(view).id
        return fixed

    def _read(self, width: int, height: int) -> Any:
        found = np.empty((height, width, 3), np.uint8)
        self.mujoco.mjr_readPixels(found, None, self.mujoco.MjrRect(0, 0, width, height), self._drawing)
        return np.flipud(found).copy()

    def _share_drawn(self) -> Any:
        """Return the drawn share of each pixel, `(height, width)`, by depth: segmentation lacks sites and tendons."""
        kinds = self.mujoco.mjtRndFlag
        look = self.look
        costly = [int(kinds.mjRND_SHADOW), int(kinds.mjRND_REFLECTION)]
        self._scene.flags[costly] = 0
        room = self.mujoco.MjrRect(0, 0, look.width * _FINER, look.height * _FINER)
        self.mujoco.mjr_render(room, self._scene, self._drawing)
        depth = np.empty((room.height, room.width), np.float32)
        self.mujoco.mjr_readPixels(None, depth, room, self._drawing)
        self._scene.flags[costly] = 1
        seen = np.flipud(depth) < 1
        return seen.reshape(look.height, _FINER, look.width, _FINER).mean(axis=(1, 3))


def _ascii(words: str) -> str:
    """Return words as MuJoCo's font has them."""
    return words.encode("ascii", "replace").decode("ascii")


_TURN_SECONDS = 4.0
_RATES = {".gif": 20, ".mp4": 30}


class _StoppedError(Exception):
    """The simulation cannot continue, with the reason."""


def draw(mujoco: Any, model: MjModel, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write a file, and return an empty answer or the fault. Runs under `mjcompose.mujoco.engine.call`.

    ``asked`` has the fields of `mjcompose.tools.view.render.RenderRequest` and ``out``, whose suffix is `.png`,
    `.gif` or `.mp4`. With ``tile``, a NumPy array of the picture with that text below goes to ``out`` instead.
    """
    subject = asked["look"]
    for kind, name in (("key", asked["key"]), ("camera", asked["camera"]), subject or ("", None)):
        known = names(model, kind) if name is not None else []
        if name is not None and name not in known:
            return {"unknown": kind, "known": list(filter(None, known))}
    out = Path(asked["out"])
    width, height = asked["size"]
    background = None if asked["background"] is None else tuple(asked["background"])
    labels = tuple(asked["labels"])
    look = Look(
        width, height, background, is_tile=asked.get("tile") is not None, explode=asked["explode"], labels=labels
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
        _write(stage, view, asked, out=out)
    except _StoppedError as error:
        return {"stopped": str(error)}
    finally:
        stage.close()
    return {}


def _write(stage: Stage, view: Any, asked: Mapping[str, Any], out: Path) -> None:
    """Write a picture for a tile, a picture, or a film. Raises _StoppedError."""
    tile = asked.get("tile")
    if tile is not None:
        picture = stage.picture(view)[:, :, :3]
        height = round(_STRIP * max(1.0, picture.shape[1] / 480))
        strip = stage.text(tile, picture.shape[1], height, ink=_CAPTION_INK, paper=_CAPTION_PAPER)
        np.save(out, np.concatenate([picture, strip]))
        return
    if out.suffix == ".png":
        out.write_bytes(png(stage.picture(view)))
        return
    rate = _RATES[out.suffix]
    frames = list(_frames(stage, view, rate, turntable=asked["turntable"], play=asked["play"]))
    if out.suffix == ".mp4":
        write_mp4(out, frames, rate)
    else:
        out.write_bytes(gif(frames, 1 / rate))


def _frames(stage: Stage, view: Any, rate: int, turntable: bool, play: float | None) -> Iterator[Any]:
    """Yield a film's pictures: physics for `play` s, a turn around the model, or both. Raises _StoppedError."""
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
_CAPTION_INK = (0.92, 0.93, 0.95)
_CAPTION_PAPER = (0.13, 0.15, 0.19)
WHOLE = "the whole"
# Renderers differ in the last bits of a color value (0 to 255).
_SAME = 2


def pictures(mujoco: Any, a: Any, b: Any, folder: str) -> dict[str, Any]:
    """Write `N-a.png` and `N-b.png` below `folder` for each view N.

    `views` has their names and the share that differs. Views are the cameras that both models have by name, and one
    view of both whole models. Both models are at their first common keyframe, or else at the reference configuration.
    `no OpenGL` is the reason if there are none.
    """
    keys, cameras = ([name for name in names(a, kind) if name and name in names(b, kind)] for kind in ("key", "camera"))
    key = next(iter(keys), None)
    look = Look()
    try:
        stages = [Stage(mujoco, model, key, look=look) for model in (a, b)]
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    free = camera(mujoco, [(stage.model, stage.data) for stage in stages], look.aspect)
    views: list[tuple[str, Any]] = [(WHOLE, free), *zip(cameras, cameras, strict=True)]
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
        top = _GAP + row * (height + _GAP)
        left = _GAP + column * (width + _GAP)
        paper[top : top + height, left : left + width] = tile
    Path(asked["out"]).write_bytes(png(paper))


def columns_of(count: int, aspect: float) -> int:
    """Return the number of tiles in a row of a sheet that is about as wide as it is high, or a little wider.

    >>> [columns_of(count, 4 / 3) for count in (1, 2, 6, 16, 100)]
    [1, 2, 3, 4, 11]
    """
    return max(1, min(count, round(math.sqrt(count * 1.6 / aspect))))

"""A compiled model and its state, and pictures of it."""

from __future__ import annotations

import base64
import copy
import math
import os
import warnings
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.diagnostic import Note, call_site
from mjcompose.base.files import CODE
from mjcompose.base.report import short_traceback
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import exists_note, unknown_name
from mjcompose.link.linking import Policy
from mjcompose.mjcf.asset import Folders, as_files, as_index, as_path, door_of
from mjcompose.mjcf.attributed import view
from mjcompose.mjcf.binding import Binding, EmptyBinding, as_slice, binding_of
from mjcompose.mjcf.compile import Snapshot, compile_error, compile_model, compile_text, engine, snapshot
from mjcompose.mjcf.errors import MjcfError, MjcfWarning, error_of, failure, raise_errors
from mjcompose.mjcf.model import ModelState, page
from mjcompose.mjcf.node_view import NodeView, RootView, model_of
from mjcompose.mujoco.attributes import KINDS, NameTable
from mjcompose.mujoco.film import png
from mjcompose.mujoco.index import compiled_kind
from mjcompose.mujoco.messages import Topic, read_sentence
from mjcompose.tree.edit import is_copy
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.select import WORLD_SECTION


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
                raise failure("out-of-range", f"`{what}` is a number of pixels, got `{number}`")
        if self._renderer is None or self._size != (height, width):
            self.close()
            self._renderer = _renderer(model, height, width)
            self._size = (height, width)
        self._renderer.update_scene(data, camera)
        picture: NDArray[np.uint8] = self._renderer.render()
        return picture.copy()

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


# MuJoCo (4.0) ends the process if it looks for OpenGL once more where there is none: its first message.
_without_opengl: list[str] = []


def _renderer(model: Any, height: int, width: int) -> Any:
    """Return MuJoCo's renderer. It ignores the model's image size, which only describes its author's window."""
    if _without_opengl:
        raise _no_rendering(_without_opengl[0])
    limits = model.vis.global_
    kept = limits.offwidth, limits.offheight
    limits.offwidth = max(kept[0], width)
    limits.offheight = max(kept[1], height)
    try:
        return engine().Renderer(model, height, width)
    except Exception as error:
        topic = read_sentence(str(error)).topic
        if topic is Topic.FRAMEBUFFER:
            message = f"OpenGL has no room for a picture of {width} times {height} pixels: {error}"
            raise failure("out-of-range", message) from error
        if topic is Topic.OPENGL:
            _without_opengl.append(str(error))
        raise _no_rendering(str(error)) from error
    finally:
        limits.offwidth, limits.offheight = kept


def _no_rendering(reason: str) -> MjcfError:
    help = "without a display, set `MUJOCO_GL=egl` (or `osmesa`) before MuJoCo is imported"
    return failure("not-supported", f"OpenGL is not available for rendering: {reason}", help=help)


class Physics:
    """A compiled model with its state: MuJoCo's own `MjModel` and `MjData`, and views for elements of a tree.

    It reflects the tree at the time it was compiled. Elements that have been edited, renamed, attached or detached
    since then are still bound to their earlier state.

    >>> from mjcompose import mjcf
    >>> root = mjcf.from_xml_string('<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body>'
    ...                             '</worldbody></mujoco>')
    >>> physics = root.compile_model()
    >>> physics.bind(root.find('joint', 'j')).qvel = 2
    >>> physics.step(10)
    >>> round(float(physics.data.qpos[0]), 3)
    0.04
    """

    __slots__ = (
        "__weakref__",
        "_bindings",
        "_data",
        "_model",
        "_of_tree",
        "_rendering",
        "_roster",
        "_snapshots",
        "legacy_step",
    )

    def __init__(self, model: Any, data: Any = None, *, snapshot: Snapshot | None = None) -> None:
        """Make physics of an `MjModel`, and of its `MjData` if one is given. Neither is copied."""
        for what, value, kind in (("model", model, "MjModel"), ("data", data, "MjData")):
            if not isinstance(value, getattr(engine(), kind)) and not (value is None and what == "data"):
                raise failure("wrong-type", f"`{what}` expects an `{kind}`, got `{type(value).__name__}`")
        self._model = model
        self._data = engine().MjData(model) if data is None else data
        self.legacy_step = False
        """Whether `step` also computes all that depends on positions and velocities, as dm_control does by default."""
        self._roster = NameTable(model)
        self._of_tree = snapshot is not None
        self._snapshots: list[Snapshot] = [] if snapshot is None else [snapshot]
        self._bindings: dict[object, Binding] = {}
        self._rendering = Rendering()
        if data is None:
            self.forward()

    @classmethod
    @short_traceback
    def from_mjcf_model(cls, root: RootView, *, conflict: Policy = "error") -> Physics:
        """Compile a model and everything attached to it. This is the same as `root.compile_model()`.

        `conflict` is described in `RootElement.to_xml_string`. Raises `MjcfError` with the faults of the model and the
        origin of each fault, even if MuJoCo refuses the model.
        """
        compiled, taken = compile_model(model_of(root, "what is compiled"), conflict)
        return cls(compiled, snapshot=taken)

    @classmethod
    @short_traceback
    def from_xml_string(cls, xml_string: str, assets: Mapping[str, bytes] | None = None) -> Physics:
        """Compile MJCF text as MuJoCo reads it. `assets` has the bytes of files by name.

        `bind` accepts elements of any tree: it finds them by their names, or by their places if they have none.
        Raises `MjcfError` if MuJoCo refuses the text.
        """
        if not isinstance(xml_string, str):
            raise failure("wrong-type", f"`xml_string` expects text, got `{type(xml_string).__name__}`")
        files = as_files("assets", assets)
        try:
            text = xml_string.encode()
        except UnicodeEncodeError as error:
            raise failure("not-mjcf", f"`xml_string` is not Unicode text: {error.reason}") from None
        return cls(compile_text(text, files))

    @classmethod
    @short_traceback
    def from_path(cls, path: str | os.PathLike[str], *, confine_to: Folders | None = None) -> Physics:
        """Compile an MJCF file as MuJoCo reads it, or load a compiled one (`.mjb`).

        `confine_to` is described in `mjcf.from_path`. Raises `MjcfError`.
        """
        file = as_path("path", path)
        if not os.path.isfile(file):
            raise failure("file-not-found", f"the file `{file}` does not exist")
        mujoco = engine()
        binary = file.suffix.lower() == ".mjb"
        if not binary:
            # Refuse files that the model may not read. MuJoCo reports all other faults.
            found = Sink()
            aside = Sink()
            unit = parse_file(file, aside, door=door_of(confine_to))
            if unit is not None:
                all_admitted(unit, found)
            for each in aside.errors:
                if each.code in (CODE, "xml-syntax"):  # the files that such a text names are unknown
                    found.add(each)
            raise_errors(found)
        load = mujoco.MjModel.from_binary_path if binary else mujoco.MjModel.from_xml_path
        try:
            return cls(load(str(file)))
        except (ValueError, mujoco.FatalError) as error:
            raise compile_error(error) from None

    @property
    def model(self) -> Any:
        """MuJoCo's `MjModel`."""
        return self._model

    @property
    def data(self) -> Any:
        """MuJoCo's `MjData`."""
        return self._data

    @property
    def time(self) -> float:
        """The simulation time in seconds. It can be set."""
        return float(self._data.time)

    @time.setter
    def time(self, seconds: float) -> None:
        self._data.time = _seconds("time", seconds)

    @property
    def timestep(self) -> float:
        """The time step in seconds. It can be set."""
        return float(self._model.opt.timestep)

    @timestep.setter
    def timestep(self, seconds: float) -> None:
        number = _seconds("timestep", seconds)
        if number <= 0:
            raise failure("out-of-range", f"`timestep` must be greater than zero, got `{number}`")
        self._model.opt.timestep = number

    @short_traceback
    def step(self, n: int = 1) -> None:
        """Advance the simulation by `n` steps, as `mj_step` does.

        Afterwards, positions and velocities are those at the new time. Quantities computed from them (`xpos`,
        `sensordata`) are those at the beginning of the last step, until `forward()` is called; see `legacy_step`.
        """
        try:
            if n >= 0:
                engine().mj_step(self._model, self._data, n)
                if self.legacy_step:
                    engine().mj_step1(self._model, self._data)
                return
        except TypeError:  # no integer, or one that is too large for C
            as_index("n", n)
        raise failure("out-of-range", f"`n` is a number of steps, got `{n}`")

    def forward(self) -> None:
        """Compute all quantities that depend on the state and the controls, without advancing the time."""
        engine().mj_forward(self._model, self._data)

    @short_traceback
    def reset(self, keyframe: int | str | NodeView | None = None) -> None:
        """Reset to the reference configuration, or to a keyframe by index, name or element. Then call `forward()`."""
        if keyframe is None:
            engine().mj_resetData(self._model, self._data)
        else:
            engine().mj_resetDataKeyframe(self._model, self._data, self._row("key", keyframe))
        self.forward()

    def copy(self) -> Physics:
        """Return an independent copy in the same state. Neither the state nor the compiled model is shared."""
        twin = self._copied({})
        twin._of_tree = self._of_tree
        return twin

    def __copy__(self) -> Physics:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Physics:
        """Return a copy. Bindings and trees that are copied together with it belong to the copy."""
        memo[id(self)] = twin = self._copied(memo)
        return twin

    def _copied(self, memo: dict[int, Any]) -> Physics:
        """Return a copy that finds the elements of other trees by their names."""
        data = copy.deepcopy(self._data, memo)
        memo[id(self._model)] = data.model
        twin = _restored(data, self.legacy_step)
        twin._snapshots = list(self._snapshots)
        return twin

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the physics with its state but without the tree. Elements of any tree are then bound by name."""
        return _restored, (self._data, self.legacy_step)

    @short_traceback
    def render(self, height: int = 240, width: int = 320, camera: int | str | NodeView = -1) -> NDArray[np.uint8]:
        """Render the state at the last `forward()` or `step()` as an RGB image of the shape `(height, width, 3)`.

        `height` and `width` are in pixels. `camera` is the index, name or element of a camera; -1 is the free camera.
        Raises `MjcfError` if OpenGL is not available. Without a display, set `MUJOCO_GL=egl` before MuJoCo is imported.
        """
        free = isinstance(camera, int | np.integer) and camera == -1
        number = -1 if free else self._row("camera", camera)
        return self._rendering.picture(self._model, self._data, height, width=width, camera=number)

    # Any: the fields of a binding are only known when the program runs.
    @short_traceback
    def bind(self, elements: NodeView | Iterable[NodeView] | None) -> Any:
        """Return a `Binding`: a view on the values in MuJoCo of an element, or of several elements of one kind.

            physics.bind(hinge).qpos = 0.5
            physics.bind(model.find_all('actuator')).ctrl = [0, 1, 0]
            physics.bind(site).xpos

        An element does not need a name. All elements of a sequence must be of the same kind. Raises `MjcfError` for an
        element that has no object in a compiled model, that was removed or was added after compiling, or of which
        MuJoCo makes several copies (`replicate`). It also raises `MjcfError` for None, which `find` returns if nothing
        matches.
        """
        if isinstance(elements, NodeView):
            elements._alive()
            known = self._bindings.get(elements)
            return self._bind([elements], True, elements) if known is None else known
        several = tuple(elements) if isinstance(elements, Iterable) else None
        if several is None or not all(isinstance(each, NodeView) for each in several):
            got = next((each for each in several or () if not isinstance(each, NodeView)), elements)
            message = f"elements are bound, or sequences of them, got `{type(got).__name__}`"
            help = "`find` returns None if no such element exists" if got is None else None
            raise failure("wrong-type", message, help=help)
        for each in several:
            each._alive()
        if not several:
            return EmptyBinding()
        known = self._bindings.get(several)
        return self._bind(several, False, several) if known is None else known

    def _bind(self, elements: Iterable[NodeView], one: bool, key: object) -> Binding:
        kinds = {self._kind(each): each for each in elements}
        if len(kinds) > 1:
            (kind, first), (other, second) = list(kinds.items())[:2]
            got = f"the {kind} {first._described()} and the {other} {second._described()}"
            raise failure("wrong-type", f"elements of one kind are bound together, got {got}")
        kind = next(iter(kinds))
        ids = [self._found(each, kind) for each in elements]
        labels = [each._described() for each in elements]
        binding_class = binding_of(kind, as_slice(ids) is not None)
        self._bindings[key] = binding = binding_class(kind, ids, labels, one, self._model, self._data)
        return binding

    def _kind(self, element: NodeView) -> str:
        kind = compiled_kind(element._node)
        if kind is None:
            message = f"{element._described()} is not an object of a compiled model"
            raise failure("not-supported", message, notes=(exists_note("kind", sorted(KINDS), element.tag),))
        return kind

    def _found(self, element: NodeView, kind: str) -> int:
        """Return the row of an element in the arrays of its kind."""
        node = element._node
        model = element._model
        taken = next((each for each in self._snapshots if node in each.known or model in each.models), None)
        if taken is None and not self._of_tree:
            taken = snapshot(model.top, self._roster)
            self._snapshots.append(taken)
        row = None if taken is None else taken.rows.get(node)
        if row is not None:
            return row
        raise self._not_found(element, kind, taken)

    def _not_found(self, element: NodeView, kind: str, taken: Snapshot | None) -> MjcfError:
        what = element._described()
        help = None
        notes: tuple[Note, ...] = ()
        if taken is None:
            message = f"{what} is of the model `{element._model.name}`, which was not compiled here"
            help = "compile the model that contains it, or bind before you copy"
        elif element._model.frame_above(element._node) is element._node and not len(element._node):
            message = f"the frame of `{element.name}` is not a body of the compiled model: it had no joint"
            help = "bind the element that it is attached to, or the bodies of the attached model"
        elif element.tag == WORLD_SECTION:
            message = f"`{element._model.name}` is attached, so its world is not a body of the compiled model"
            help = "bind its mount, the bodies in it, or its attachment frame once that has a joint"
        elif self._of_tree and element._node not in taken.known:
            message = f"{what} came after the model was compiled"
            help = "compile it again"
        elif any(above.tag == "replicate" for above in element._node.iterancestors()):
            message = f"{what} is in a `<replicate>`: MuJoCo has made several copies of it"
            help = f"`physics.model.{kind}(NAME)` has each of them"
        elif element.name is None:
            message = f"{what} has no name, and which {kind} of the compiled model it is cannot be determined"
            help = "give it a name"
        else:
            own = str(element.full_identifier)
            names = [name for name in self._roster.names[kind] if name]
            if any(is_copy(name, own) for name in names):
                message = f"MuJoCo has made several copies of {what}, which refers to something in a `<replicate>`"
                help = f"`physics.model.{kind}(NAME)` has each of them"
            else:
                message = f"the compiled model has no {kind} `{own}`"
            notes = (exists_note(kind, names, own),)
        return failure("unknown-name", message, notes=notes, help=help)

    def _row(self, kind: str, given: int | str | NodeView) -> int:
        """Return the index of a keyframe or a camera, given its index, name or element."""
        if isinstance(given, NodeView):
            if self._kind(given._alive()) != kind:
                raise failure("wrong-type", f"expects a {kind}, got {given._described()}")
            return self._found(given, kind)
        names = self._roster.names[kind]
        if isinstance(given, str) and given in self._roster.ids[kind]:
            return self._roster.ids[kind][given]
        if isinstance(given, int | np.integer) and not isinstance(given, bool) and 0 <= given < len(names):
            return int(given)
        known = [name or str(at) for at, name in enumerate(names)]
        message = f"the compiled model has no {kind} `{given}`"
        if isinstance(given, str):
            raise error_of(unknown_name(kind, given, known, span=call_site(), message=message))
        raise failure("out-of-range", message, notes=(exists_note(kind, known, str(given)),))

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name}={getattr(self._model, name)}" for name in ("nq", "nv", "nu", "nbody"))
        return f"<Physics {sizes}, time={self.time:.6g}>"


def _seconds(what: str, value: object) -> float:
    """Return a time in seconds that the caller sets. Raises `MjcfError` for an invalid one."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise failure("wrong-type", f"`{what}` expects a number of seconds, got `{value!r}`")
    return number


def _restored(data: Any, legacy_step: bool = False) -> Physics:
    physics = Physics(data.model, data)
    physics.legacy_step = legacy_step
    return physics


def page_with_picture(model: ModelState) -> str:
    """Return HTML of a model's tree, with a picture if OpenGL is available and the model compiles."""
    tree = page(model, model.unit.root)
    image = picture(model)
    if image is None:
        return tree
    data = base64.b64encode(image).decode()
    return (
        '<div style="display: flex; gap: 1em; align-items: flex-start">'
        f'<img alt="{escape(model.name)}" src="data:image/png;base64,{data}"/>{tree}</div>'
    )


def picture(model: ModelState) -> bytes | None:
    """Return the whole composition in its reference configuration as a PNG, or None if it cannot be rendered."""
    top = model.top
    if not len(top.section(WORLD_SECTION)):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MjcfWarning)
        try:
            return png(Physics.from_mjcf_model(view(top, top.unit.root), conflict="base").render())
        except MjcfError:
            return None

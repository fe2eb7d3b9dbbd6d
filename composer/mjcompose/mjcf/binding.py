"""Views on the arrays of `mjModel` and `mjData` that have rows for the elements of a kind, by all their names.

The running MuJoCo describes its own structs and the size that determines each array's rows. MuJoCo ignores a pose
that it has marked as equal to the pose of another frame: writing a pose here clears the mark.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.suggest import did_you_mean
from mjcompose.mjcf.compile import IN_PLACE, ScatteredRows, flat_indices
from mjcompose.mjcf.errors import MjcfAttributeError, MjcfError, failure
from mjcompose.mujoco.addresses import RUNS, RowRange
from mjcompose.mujoco.attributes import KINDS
from mjcompose.tree.values import shorten

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

# A short name belongs to the first array: `solref` of a joint is `jnt_solref` and the other one is `dof_solref`.
_MORE_WORDS = {"joint": ("dof",), "tendon": ("ten",), "skin": ("skin",), "flex": ("flexedge", "flexvert")}
_ALIASES = {"sensor": {"data": "sensordata"}}
# Lists of indices, and rows that MuJoCo assigns again in every step: no row of an element.
_NO_ROWS = frozenset({"body_awake_ind", "parent_awake_ind", "dof_awake_ind", "wrap_obj", "wrap_xpos"})


class Field(Struct):
    """An array by MuJoCo's name, whether it belongs to `mjData`, and the size that determines its rows (`nv`)."""

    array: str
    of_data: bool
    size: str


@cache
def fields(kind: str) -> Mapping[str, Field]:
    """Return the fields of a kind by MuJoCo's full names and by the names without the kind (`geom_xpos` and `xpos`)."""
    own_size = next(field.size for field in _arrays() if field.array == KINDS[kind].addresses)
    sizes = {own_size, *RUNS.get(kind, ())}
    found = {field.array: field for field in _arrays() if field.size in sizes}
    short: dict[str, Field] = {}
    for word in (KINDS[kind].arrays, *_MORE_WORDS.get(kind, ())):
        for name, field in found.items():
            if name.startswith(f"{word}_"):
                short.setdefault(name.removeprefix(f"{word}_"), field)
    for name, array in _ALIASES.get(kind, {}).items():
        short[name] = found[array]
    return MappingProxyType({**short, **found})


@cache
def _arrays() -> tuple[Field, ...]:
    """Return every array of numbers in both structs whose memory does not move during the life of the struct."""
    from mujoco.introspect.structs import STRUCTS

    arrays: list[Field] = []
    for name in ("mjModel", "mjData"):
        struct: Any = STRUCTS[name]
        for field in struct.fields:
            if field.name == "contact":  # from here on MuJoCo makes the arrays of mjData again in every step
                break
            extent = getattr(field, "array_extent", None)
            # Python returns text as bytes and not as a view.
            is_text = getattr(getattr(field.type, "inner_type", None), "name", None) == "char"
            if extent and field.name not in _NO_ROWS and not is_text:
                arrays.append(Field(field.name, name == "mjData", str(extent[0])))
    return tuple(arrays)


_NAMES = (
    (re.compile(r"(pos|pos0|axis|dir|anchor|inertia|com|size)$"), ("x", "y", "z")),
    (re.compile(r"quat$"), ("qw", "qx", "qy", "qz")),
    (re.compile(r"rgba$"), ("r", "g", "b", "a")),
    (re.compile(r"mat$"), ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")),
)


def column_names(array: str, width: int) -> tuple[str, ...]:
    """Return the names of the columns of a MuJoCo array, or an empty tuple if they have no names."""
    return next((found for ends, found in _NAMES if ends.search(array) and len(found) == width), ())


def number_columns(columns: Any, known: Sequence[str]) -> Any:
    """Return an index with the column names replaced by numbers. Raises KeyError with the first unknown name.

    >>> number_columns(['x', 'z'], column_names('geom_pos', 3)), number_columns(slice(0, 2), ())
    ([0, 2], slice(0, 2, None))
    """
    if isinstance(columns, str):
        if columns not in known:
            raise KeyError(columns)
        return known.index(columns)
    if isinstance(columns, list | tuple | np.ndarray):
        return [number_columns(each, known) if isinstance(each, str) else each for each in columns]
    return columns


Release: TypeAlias = "Callable[[MjModel, str, NDArray[np.intp]], None]"

# mjtSameFrame: geoms and sites that have the place or the turn of their body's inertia.
_WITH_INERTIA = (2, 4)


def _of_frame(model: MjModel, array: str, rows: NDArray[np.intp]) -> None:
    getattr(model, f"{array.partition('_')[0]}_sameframe")[rows] = 0


def _of_inertia(model: MjModel, array: str, rows: NDArray[np.intp]) -> None:
    """Clear the marks of bodies whose inertia poses are written, and of the geoms and sites that share these frames.

    These geoms and sites keep their poses. Raises `MjcfError` for a simple body.
    """
    simple = (model.body_simple[rows] != 0) & (model.body_dofnum[rows] > 0)
    if simple.any():
        # Its part of the mass matrix has only the diagonal. MuJoCo 4.0 refuses `mj_setConst` after such a change.
        row = int(rows[simple][0])
        name = array.removeprefix("body_")
        message = f"`{name}` of the body `{model.body(row).name or row}` cannot be changed after compiling"
        notes = (Note("MuJoCo compiled it as a simple body, whose part of the mass matrix is a diagonal"),)
        raise failure("not-supported", message, notes=notes, help="compile it with `simple='false'` on the body")
    for same, bodies in ((model.geom_sameframe, model.geom_bodyid), (model.site_sameframe, model.site_bodyid)):
        same[np.isin(bodies, rows) & np.isin(same, _WITH_INERTIA)] = 0
    model.body_sameframe[rows] = model.body_simple[rows] = 0


RELEASES: dict[str, Release] = {
    **dict.fromkeys(("geom_pos", "geom_quat", "site_pos", "site_quat"), _of_frame),
    **dict.fromkeys(("body_ipos", "body_iquat"), _of_inertia),
}
"""Actions by array of poses, before some of its rows are written; a row may be named repeatedly."""


class Posed(np.ndarray[Any, np.dtype[Any]]):
    """Rows of an array of poses, in MuJoCo's own memory, or a slice of them. Writing clears the marks of the rows."""

    __slots__ = ("array", "model")
    array: str
    model: MjModel

    @classmethod
    def of(cls, view: NDArray[Any], model: MjModel, array: str) -> Posed:
        posed = view.view(cls)
        posed.model = model
        posed.array = array
        return posed

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Return results computed from poses as plain numpy arrays."""
        return array.view(np.ndarray) if array.ndim else array[()]

    def __repr__(self) -> str:
        return repr(self.view(np.ndarray))

    def __setitem__(self, key: Any, value: Any) -> None:
        # Nothing is released for a value that does not fit.
        tried = np.empty(self.shape, self.dtype)
        tried[key] = value
        self._release(key)
        super().__setitem__(key, value)

    def _release(self, key: Any = ...) -> None:
        # numpy makes that the base of a view, however many views lie between.
        top = self if hasattr(self, "array") else self.base
        if not isinstance(top, Posed) or not hasattr(top, "array"):
            return  # a copy
        source = getattr(top.model, top.array)
        RELEASES[top.array](top.model, top.array, flat_indices(source, self)[key] // source.shape[-1])


def _in_place(name: str) -> Any:
    compute = getattr(np.ndarray, name)

    def write(self: Posed, other: object) -> Posed:
        self[...] = compute(np.array(self), other)
        return self

    write.__name__ = name
    return write


for _name in IN_PLACE:
    setattr(Posed, _name, _in_place(_name))


Array = NDArray[Any]
Data = Any
"""A `mujoco.MjData`; untyped as the model is."""


class Binding:
    """The fields of `mjModel` and `mjData` for one element, or for several of one kind.

    A field has MuJoCo's full name and one without the kind: `geom_xpos` and `xpos`. Names also work as an index:
    `binding['xpos']`, `binding['xpos', 'z']`. Reading returns MuJoCo's own memory, which changes with the
    simulation; take a `copy()` to keep it. Assignments, to a field or to its items, are written there. MuJoCo uses
    a `pos`, `quat`, `ipos` or `iquat` that was written here even if it had compiled the pose away because it was
    equal to that of another frame.

    Shapes, for one element: a number has `()`, a row `(3,)`. A field that can have several numbers per element has
    their count as its length, even if it is one: `qpos` of a hinge is `(1,)`, of a free joint `(7,)`, `sensordata`
    of a force `(3,)`. For an actuator with one control, `ctrl` is a number; for one without state, `act` is empty.
    For a sequence of n elements, in its order: `(n,)`, `(n, 3)`, and the sum of the lengths. Units are MuJoCo's:
    radians, meters, kilograms, seconds.

    If the rows of a sequence are not evenly spaced in MuJoCo's array, a field is a copy made when it is read;
    assignments to items and slices, and `+=`, are still written to MuJoCo.
    """

    __slots__ = ("__dict__", "_data", "_homes", "_ids", "_kind", "_labels", "_model", "_one")

    def __init__(
        self, kind: str, ids: Sequence[int], labels: Sequence[str], one: bool, model: MjModel, data: Data
    ) -> None:
        """For internal use. To get a binding, call `Physics.bind`."""
        values: tuple[object, ...] = (kind, ids, labels, one, model, data, {})
        for name, value in zip(("_kind", "_ids", "_labels", "_one", "_model", "_data", "_homes"), values, strict=True):
            object.__setattr__(self, name, value)

    @property
    def element_id(self) -> int | NDArray[np.intp]:
        """The index of the element in MuJoCo's arrays, or for several elements an array of indices."""
        return self._ids[0] if self._one else np.array(self._ids, dtype=np.intp)

    @property
    def id(self) -> int | NDArray[np.intp]:
        """The same as `element_id`, by MuJoCo's name for it."""
        return self.element_id

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        field = fields(self._kind).get(name)
        if field is None:
            raise self._unknown(name)
        return self._read(name, field)  # Python asks here for fields that raised; they do so again

    def __setattr__(self, name: str, value: Any) -> None:
        view = self.__dict__.get(name)
        if view is None:
            field = fields(self._kind).get(name)
            if field is None and name in ("element_id", "id"):
                message = f"`{name}` is the number that MuJoCo has given and cannot be set"
                raise failure("wrong-type", message, kind=MjcfAttributeError)
            if field is None:
                raise self._unknown(name)
            view = self._view(name, field)
        if value is None:
            raise self._cannot_take(name, value)
        try:
            if isinstance(view, ScatteredRows):
                view.write(value)
            else:
                view[...] = value
        except MjcfError:
            raise
        except (TypeError, ValueError):
            raise self._cannot_take(name, value) from None

    def __getitem__(self, key: str | tuple[str, Any]) -> Any:
        """Return a field by its name, `binding['xpos']`, or some of its columns, `binding['xpos', 'z']`.

        Columns are given by index or by name. The names are `x y z`, `qw qx qy qz`, `r g b a` and, for a rotation
        matrix, `xx xy … zz`.
        """
        name, at = self._parts(key)
        value = getattr(self, name)
        return value if at is None else value[at]

    def __setitem__(self, key: str | tuple[str, Any], value: Any) -> None:
        """Write a field, or some of its columns, to MuJoCo. The keys are those of `binding[key]`."""
        name, at = self._parts(key)
        if at is None:
            setattr(self, name, value)
            return
        has = getattr(self, name)
        try:
            has[at] = value
        except MjcfError:
            raise
        except (TypeError, ValueError):
            raise self._cannot_take(name, value, has[at]) from None

    def _parts(self, key: str | tuple[str, Any]) -> tuple[str, Any]:
        """Return the name of a field and an index into its columns, which is None for all columns."""
        name, *rest = key if isinstance(key, tuple) else (key,)
        if not isinstance(name, str) or len(rest) > 1:
            message = f"a binding is indexed by the name of a field, got `{shorten(repr(key))}`"
            help = "`binding['xpos']`, `binding['xpos', 'z']` or `binding['xpos', [0, 2]]`"
            raise failure("wrong-type", message, help=help)
        if not rest:
            return name, None
        has = getattr(self, name)
        if has.ndim < (1 if self._one else 2):
            raise failure("wrong-type", f"`{name}` of {self._labelled()} has one number per element, and no columns")
        known = column_names(fields(self._kind)[name].array, has.shape[-1])
        try:
            at = number_columns(rest[0], known)
            has[..., at]
        except (KeyError, IndexError, TypeError) as fault:
            column = fault.args[0] if isinstance(fault, KeyError) else shorten(repr(rest[0]))
            notes = (Note(f"it has {has.shape[-1]}" + (f": {', '.join(known)}" if known else "")),)
            raise failure("out-of-range", f"`{name}` has no column `{column}`", notes=notes) from None
        return name, (..., at)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle or copy the binding with its state. If its `Physics` is copied too, it becomes a view on that copy."""
        return _bound, (self._kind, self._ids, self._labels, self._one, self._data)

    def __dir__(self) -> list[str]:
        return sorted({"element_id", "id", *fields(self._kind)})

    def __repr__(self) -> str:
        return f"<Binding of {self._labelled()}>"

    def _labelled(self) -> str:
        return ", ".join(self._labels[:3]) + (", …" if len(self._labels) > 3 else "")

    def _read(self, name: str, field: Field) -> Array:
        view = self._view(name, field)
        if isinstance(view, ScatteredRows):
            return view.read()
        return view if view.ndim else view[()]

    def _view(self, name: str, field: Field) -> Array | ScatteredRows[Any]:
        """Return a field and cache it: MuJoCo's memory does not move during the life of the model."""
        known: Array | ScatteredRows[Any] | None = self._homes.get(name, self.__dict__.get(name))
        if known is not None:
            return known
        array = getattr(self._data if field.of_data else self._model, field.array)
        view = self._one_view(array, field) if self._one else self._view_of_all(array, field)
        if isinstance(view, ScatteredRows) or not view.ndim:  # a single number is returned as it is
            self._homes[name] = view
            return view
        if field.array in RELEASES:
            view = Posed.of(view, self._model, field.array)
        self.__dict__[name] = view
        return view

    def _one_view(self, array: Array, field: Field) -> Array:
        index = self._ids[0]
        run = RUNS.get(self._kind, {}).get(field.size)
        if run is None:
            return array[index, ...]
        rows = self._rows(run, 0, field)
        if run.as_row and len(rows) == 1:
            return array[rows.start, ...]
        view = array[rows.start : rows.stop]
        return view if run.shape is None else view.reshape(run.shape(self._model, index))

    def _view_of_all(self, array: Array, field: Field) -> Array | ScatteredRows[Any]:
        run = RUNS.get(self._kind, {}).get(field.size)
        index = np.array(self._ids, dtype=np.intp)
        if run is not None:
            runs = (self._rows(run, at, field) for at in range(len(self._ids)))
            index = np.concatenate([np.arange(rows.start, rows.stop, dtype=np.intp) for rows in runs])
        regular = as_slice(index)
        if regular is not None:
            return array[regular]
        release = RELEASES.get(field.array)
        return ScatteredRows.of(array, index, *([partial(release, self._model, field.array)] if release else []))

    def _rows(self, run: RowRange, at: int, field: Field) -> range:
        rows = run.rows(self._model, self._ids[at])
        if run.required is not None and not rows:
            message = f"{self._labels[at]} is not {run.required} and has no `{field.array}`"
            raise failure("unknown-attribute", message, kind=MjcfAttributeError)
        return rows

    def _cannot_take(self, name: str, value: object, of: Array | None = None) -> Exception:
        has = self._read(name, fields(self._kind)[name]) if of is None else of
        got = None
        what = f"`{name}` of {self._labelled()}"
        with suppress(TypeError, ValueError):
            got = np.asarray(value, dtype=has.dtype) if value is not None else None
        if got is None:
            return failure("wrong-type", f"{what} expects numbers, got `{shorten(repr(value))}`")
        return failure("wrong-length", f"{what} has the shape {has.shape}, got {got.shape}")

    def _unknown(self, name: str) -> Exception:
        notes = (Note("fields that exist: " + ", ".join(_shortest(self._kind))),)
        message = f"a compiled {self._kind} has no field `{name}`"
        help = did_you_mean(name, sorted(fields(self._kind)))
        return failure("unknown-attribute", message, notes=notes, help=help, kind=MjcfAttributeError)


class EmptyBinding:
    """The binding of an empty sequence of elements: every field is an empty array."""

    __slots__ = ()

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_"):
            raise AttributeError(name)
        return np.empty(0)

    def __setattr__(self, name: str, value: Any) -> None:
        if np.size(value):
            raise failure("wrong-length", f"`{name}` of nothing has the shape (0,), got {np.shape(value)}")

    def __getitem__(self, key: object) -> Array:
        return np.empty(0)

    def __setitem__(self, key: object, value: Any) -> None:
        setattr(self, str(key[0] if isinstance(key, tuple) else key), value)

    def __repr__(self) -> str:
        return "<Binding of nothing>"


@cache
def binding_of(kind: str, regular: bool) -> type[Binding]:
    """Return the class of bindings of a kind, with the fields that MuJoCo has for this kind.

    With `regular`, the rows are evenly spaced and the fields are views. Otherwise the fields are read again on each
    access.
    """
    field_of: Callable[[str, Field], object] = _FieldView if regular else _scattered_field
    members: dict[str, Any] = {name: field_of(name, field) for name, field in fields(kind).items()}
    return type(f"{kind.capitalize()}Binding", (Binding,), {"__slots__": (), **members})


def _bound(kind: str, ids: Sequence[int], labels: Sequence[str], one: bool, data: Data) -> Binding:
    return binding_of(kind, as_slice(ids) is not None)(kind, ids, labels, one, data.model, data)


class _FieldView:
    """A descriptor for a field. Python finds a view that the binding has cached before it calls the descriptor."""

    __slots__ = ("field", "name")

    def __init__(self, name: str, field: Field) -> None:
        self.name = name
        self.field = field

    def __get__(self, binding: Binding | None, owner: type[Binding]) -> Any:
        return self if binding is None else binding._read(self.name, self.field)


def _scattered_field(name: str, field: Field) -> property:
    """Return a property for a field. Python reads properties faster than other descriptors."""

    def read(binding: Binding) -> Any:
        home = binding._homes.get(name)
        return home.read() if isinstance(home, ScatteredRows) else binding._read(name, field)

    return property(read)


def _shortest(kind: str) -> list[str]:
    """Return each field once, by the shortest of its names."""
    names: dict[Field, str] = {}
    for name, field in fields(kind).items():
        names[field] = min(name, names.get(field, name), key=len)
    return sorted(names.values())


def as_slice(index: Sequence[int] | NDArray[np.intp]) -> slice | None:
    """Return the slice that selects the same rows, or None if the rows are not evenly spaced."""
    rows = np.asarray(index, dtype=np.intp)
    if not rows.size:
        return slice(0, 0)
    steps = np.diff(rows)
    step = int(steps[0]) if steps.size else 1
    if step == 0 or (steps != step).any():
        return None
    end = int(rows[-1]) + step
    return slice(int(rows[0]), end if end >= 0 else None, step)

"""Poses of a compiled model. MuJoCo ignores a pose that it has marked as equal to the pose of another frame.

Writing a pose here clears that mark, so that MuJoCo reads the new pose.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.compiled.kinds import Model
from composer.diagnostics.call_site import call_site
from composer.diagnostics.diagnostic import Note
from composer.mjcf.errors import failure
from composer.mjcf.physics.scattered import IN_PLACE, places

Release = Callable[[Model, str, NDArray[np.intp]], None]

# mjtSameFrame: geoms and sites that stand where the inertia of their body does, or are turned as it is.
_WITH_INERTIA = (2, 4)


def _own(of: str) -> Release:
    def release(model: Model, array: str, rows: NDArray[np.intp]) -> None:
        getattr(model, of)[rows] = 0

    return release


def _of_inertia(model: Model, array: str, rows: NDArray[np.intp]) -> None:
    """Clear the marks of bodies whose inertia poses are written, and of the geoms and sites that share these frames.

    These geoms and sites keep their poses. Raises `MjcfError` for a simple body.
    """
    simple = (model.body_simple[rows] != 0) & (model.body_dofnum[rows] > 0)
    if simple.any():
        raise _is_simple(model, array, int(rows[simple][0]))
    for kind in ("geom", "site"):
        same = getattr(model, f"{kind}_sameframe")
        stays = np.isin(getattr(model, f"{kind}_bodyid"), rows) & np.isin(same, _WITH_INERTIA)
        same[stays] = 0
    model.body_sameframe[rows] = 0
    model.body_simple[rows] = 0


def _is_simple(model: Model, array: str, row: int) -> Exception:
    """Return the error that the inertia pose of a simple body cannot be changed.

    Its part of the mass matrix has room for the diagonal only. MuJoCo 4.0 refuses `mj_setConst` after such a change.
    """
    name = model.body(row).name
    return failure(
        "not-supported",
        f"`{array.removeprefix('body_')}` of the body `{name or row}` cannot be changed after compiling",
        call_site(),
        notes=(Note("MuJoCo compiled it as a simple body, whose part of the mass matrix is a diagonal"),),
        help="compile it with `simple='false'` on the body",
    )


RELEASES: dict[str, Release] = {
    "geom_pos": _own("geom_sameframe"),
    "geom_quat": _own("geom_sameframe"),
    "site_pos": _own("site_sameframe"),
    "site_quat": _own("site_sameframe"),
    "body_ipos": _of_inertia,
    "body_iquat": _of_inertia,
}
"""By array of poses: what is done before some of its rows are written; a row may be named repeatedly."""


class Posed(np.ndarray[Any, np.dtype[Any]]):
    """Rows of an array of poses, in MuJoCo's own memory, or a slice of them. Writing clears the marks of the rows."""

    __slots__ = ("array", "model")
    array: str
    model: Model

    @classmethod
    def of(cls, view: NDArray[Any], model: Model, array: str) -> Posed:
        posed = view.view(cls)
        posed.model, posed.array = model, array
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
        RELEASES[top.array](top.model, top.array, places(source, self)[key] // source.shape[-1])


def _in_place(name: str) -> Any:
    compute = getattr(np.ndarray, name)

    def write(self: Posed, other: object) -> Posed:
        self[...] = compute(np.array(self), other)
        return self

    write.__name__ = name
    return write


for _name in IN_PLACE:
    setattr(Posed, _name, _in_place(_name))

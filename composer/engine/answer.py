"""MuJoCo's answers to requests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

from composer.compiled.index import Index
from composer.dataclass import dataclass

if TYPE_CHECKING:
    import numpy


@dataclass(frozen=True, slots=True)
class Compiled:
    """A model that compiled, or why it did not.

    `error` is MuJoCo's own text, or one sentence if MuJoCo gave none; paths in it are relative to the folder.
    `crash` is set if there is no verdict on the model: `timeout`, `memory`, `signal N`, `exit N`, `missing` (no
    MuJoCo in this Python) or `start` (no child process). `forward` is the error in one mj_forward at the reference
    configuration; None if all numbers are finite, or if it was not requested. `sizes` are all integer sizes of
    mjModel (nq, nv, nu, na, nbody, ...) and `nactuator`, which counts actuators while `nu` counts controls.
    """

    ok: bool
    error: str | None = None
    crash: str | None = None
    warnings: tuple[str, ...] = ()
    mujoco_version: str | None = None
    sizes: Mapping[str, int] = field(default_factory=dict)
    forward: str | None = None
    index: Index | None = None
    names: Mapping[str, tuple[str, ...]] | None = None


@dataclass(frozen=True, slots=True)
class Measured:
    """A compiled model with some of its arrays.

    `arrays` has the requested attributes that this version of MuJoCo has, sizes as arrays of one; it is empty if
    `compiled.ok` is false. `names` has for each kind of object (body, joint, geom, site, camera, light, mesh, ...)
    the names in the order of the arrays' rows.
    """

    compiled: Compiled
    arrays: Mapping[str, numpy.ndarray]

    @property
    def names(self) -> Mapping[str, tuple[str, ...]]:
        return self.compiled.names or {}


@dataclass(frozen=True, slots=True)
class Called:
    """The result of a function that ran in the child; `value` is JSON data, None unless `ok`.

    `error` and `crash` are as in `Compiled`; an exception of the function is an `error`.
    """

    ok: bool
    value: Any = None
    error: str | None = None
    crash: str | None = None
    warnings: tuple[str, ...] = ()

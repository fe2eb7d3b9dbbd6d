"""What MuJoCo said to a request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from composer.compiled.index import Index

if TYPE_CHECKING:
    import numpy


@dataclass(frozen=True, slots=True)
class Compiled:
    """A model that compiled, or why it did not.

    `error` is MuJoCo's own text, or one sentence when MuJoCo gave none; paths in it are relative to the
    folder.
    `crash` is set when no verdict on the model could be had: `timeout`, `memory`, `signal N`, `exit N`,
    `missing` (no MuJoCo in this Python) or `start` (no child process).
    `forward` is what went wrong in one mj_forward at the reference configuration; None when all is finite, or
    when it was not asked for.
    `sizes` are all integer sizes of mjModel (nq, nv, nu, na, nbody, ...) and `nactuator`, which counts
    actuators where `nu` counts controls.
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

    `arrays` has those of the wanted attributes that this version of MuJoCo has, sizes as arrays of one; it is
    empty when `compiled.ok` is false. `names` gives for each kind of object (body, joint, geom, site, camera,
    light, mesh, ...) the names in the order of the arrays' rows.
    """

    compiled: Compiled
    arrays: Mapping[str, numpy.ndarray]

    @property
    def names(self) -> Mapping[str, tuple[str, ...]]:
        return self.compiled.names or {}


@dataclass(frozen=True, slots=True)
class Called:
    """What a function that ran in the child returned; `value` is JSON data, None unless `ok`.

    `error` and `crash` are as in `Compiled`; an exception of the function is an `error`.
    """

    ok: bool
    value: Any = None
    error: str | None = None
    crash: str | None = None
    warnings: tuple[str, ...] = ()

"""Worlds for MuJoCo's own batch, which steps many simulations on all cores."""

from __future__ import annotations

from typing import Any

from composer.compiled.varying import MEANS
from composer.worlds.errors import failure
from composer.worlds.worlds import Worlds


def mujoco(worlds: Worlds, nthread: int = 0, *, persistent: bool = False) -> Any:
    """Return a `mujoco.batch.Batch` with a simulation for each world, on `nthread` threads (0: all cores).

        batch = worlds.mujoco(study)
        batch.expand("body_mass")      # (worlds, nbody): expanded already, with each world's masses

    Every array that differs is expanded and filled, including those that mj_setConst computes: `batch.set_const()`
    would change nothing. `stat.meaninertia`, which scales the tolerances of solvers, and `stat.meanmass` are those
    of the nominal model: a batch has one `stat` for all.

    Needs MuJoCo 3.17 or newer; raises LoadError without it, and for an array that a batch cannot expand.
    """
    try:
        from mujoco.batch import MODEL_FIELDS, Batch
    except ImportError as error:
        import mujoco as installed

        help = "install `mujoco>=3.17`, or step `worlds.models()` one after another"
        raise failure(
            "not-installed", f"MuJoCo {installed.__version__} has no `mujoco.batch`", help
        ) from error
    names = [name for name in worlds.arrays if name not in MEANS]
    if shared := [name for name in names if name not in MODEL_FIELDS]:
        listed = ", ".join(f"`{name}`" for name in shared)
        help = "step `worlds.models()` one after another, or leave out of `randomize` what changes them"
        raise failure("not-per-world", f"a batch of MuJoCo has {listed} once for all simulations", help)
    batch = Batch(worlds.nominal, worlds.count, nthread, persistent=persistent)
    for name in names:
        varying, numbers = worlds.arrays[name], batch.expand(name).view()
        numbers.shape = (worlds.count, -1)  # the same memory
        numbers[:, varying.index] = varying.values
    return batch

"""Worlds for MJX, and for training with mujoco_playground and brax."""

from __future__ import annotations

from typing import Any

from composer.worlds.errors import failure
from composer.worlds.probing import check_nothing_is_shared, is_stepped
from composer.worlds.simulator import Simulator
from composer.worlds.worlds import Worlds

_INSTEAD = "leave out of the recipe what changes it, or use `worlds.mujoco`"


def mjx(worlds: Worlds, model: Any = None) -> tuple[Any, Any]:
    """Return the model with a row for each world in every array that differs, and the tree of axes for `jax.vmap`.

        batched, in_axes = worlds.mjx(study)
        step = jax.vmap(mjx.step, in_axes=(in_axes, 0))

    `model` is an `mjx.Model` or a `brax.System` of the same bundle; without one it is made from the nominal model.
    So a `randomization_fn` of mujoco_playground or brax is `lambda model: worlds.mjx(study, model)`. Inertia is
    included with mass, and values that mj_setConst computes, including `stat.meaninertia`, with their inputs.

    Needs `mujoco-mjx`; raises LoadError without it, for a model that MJX does not take, for arrays that it shares
    between worlds, and for another model.
    """
    try:
        import jax
        from mujoco import mjx as module
    except ImportError as error:
        help = "`pip install mujoco-mjx`"
        raise failure("not-installed", f"`mujoco.mjx` cannot be used: {error}", help) from error
    simulator = Simulator("mjx", module.put_model)
    plain = simulator.take(worlds, worlds.nominal)
    base = plain if model is None else model
    replaced: dict[str, Any] = {}
    for name in worlds.arrays:
        leaf = _leaf(plain, name)
        if leaf is None or not isinstance(leaf, jax.Array):
            if leaf is not None and is_stepped(name):
                raise failure("not-per-world", f"MJX has `{name}` once for all worlds", _INSTEAD)
            continue
        theirs = _leaf(base, name)
        if getattr(theirs, "shape", None) != leaf.shape:
            found = (
                "does not have it" if theirs is None else f"has the shape {theirs.shape}, not {leaf.shape}"
            )
            help = "make it of `study.nominal`, or leave it out"
            raise failure(
                "bundle-changed",
                f"the model is another one than that of the worlds: of `{name}` it {found}",
                help,
            )
        replaced[name] = jax.numpy.asarray(worlds.values(name).reshape(worlds.count, *leaf.shape), leaf.dtype)
    check_nothing_is_shared(worlds, simulator, replaced, instead=_INSTEAD)
    axes = jax.tree_util.tree_map(lambda _: None, base).tree_replace(dict.fromkeys(replaced, 0))
    return base.tree_replace(replaced), axes


def _leaf(model: Any, name: str) -> Any:
    """Return an array of a model by its path, such as `opt.timestep`, or None if it does not exist."""
    for each in name.split("."):
        model = getattr(model, each, None)
    return model

"""Worlds for mjlab: an event that gives each environment the numbers of its world."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.compiled.kinds import Model
from composer.compiled.varying import flat
from composer.compiled.whose import whose
from composer.worlds.errors import failure
from composer.worlds.gpu import per_world, unread
from composer.worlds.probing import check_nothing_is_shared, is_stepped
from composer.worlds.simulator import Simulator
from composer.worlds.worlds import Worlds

_INSTEAD = "leave out of the recipe what changes it, or use `worlds.mujoco`"
_WORLD = "world"
_ON_BODY = re.compile(r"(#\d+ of body `)(.*`)")


def mjlab(worlds: Worlds, entity: str | None = None) -> dict[str, Any]:
    """Return the terms for `events` of an environment's configuration: environment `n` is world `n` from its start.

        events = {**worlds.mjlab(study, entity="robot"), "push": EventTermCfg(...)}

    `entity` is what the scene calls the entity that the bundle is; without one the scene's model is the bundle's. The
    function of the term says in `model_fields` which arrays are for each world, which mjlab's `expand_model_fields`
    takes, and is one like those of `mjlab.envs.mdp.dr`. In a scene mjlab computes again what follows from masses and
    poses, for of the world body more than the entity is part.

    Needs `mjlab`; raises LoadError without it, for a model that MuJoCo Warp does not take, and for arrays that it
    shares between worlds. A missing
    element in the scene, or a number of environments other than that of worlds, raises LoadError when the
    environment is made.
    """
    try:
        import mujoco_warp
        from mjlab.managers.event_manager import EventTermCfg, RecomputeLevel
    except ImportError as error:
        raise failure("not-installed", f"`mjlab` cannot be used: {error}", "`pip install mjlab`") from error
    simulator = Simulator("warp", mujoco_warp.put_model)
    model = simulator.take(worlds, worlds.nominal)
    names = [name for name in per_world(model, worlds) if is_stepped(name)]
    if dotted := [name for name in names if "." in name]:
        raise failure("not-per-world", f"mjlab has `{dotted[0]}` once for all worlds", _INSTEAD)
    check_nothing_is_shared(worlds, simulator, [*names, *unread(worlds)], instead=_INSTEAD)

    def set_worlds(env: Any, env_ids: Any = None) -> None:
        _set(worlds, names, entity, sim=env.sim, env_ids=env_ids)

    set_worlds.model_fields = tuple(names)  # type: ignore[attr-defined]
    set_worlds.recompute = RecomputeLevel.none if entity is None else RecomputeLevel.set_const  # type: ignore[attr-defined]
    return {"worlds": EventTermCfg(func=set_worlds, mode="startup")}


def _set(worlds: Worlds, names: list[str], entity: str | None, sim: Any, env_ids: Any) -> None:
    """Write the numbers of some environments, or of all for None."""
    import torch
    import warp

    if sim.num_envs != worlds.count:
        help = f"make `num_envs` {worlds.count}, or choose worlds: `study.take(range({sim.num_envs}))`"
        raise failure(
            "bundle-changed", f"there are {sim.num_envs} environments and {worlds.count} worlds", help
        )
    chosen = torch.arange(sim.num_envs) if env_ids is None else env_ids.cpu()
    for name in names:
        ours, theirs = _places(worlds, name, entity, scene=sim.mj_model)
        numbers = warp.to_torch(getattr(sim.wp_model, name)).view(sim.num_envs, -1)
        values = torch.as_tensor(worlds.arrays[name].values[:, ours][chosen.numpy()], dtype=numbers.dtype)
        numbers[chosen[:, None].to(numbers.device), torch.as_tensor(theirs, device=numbers.device)] = (
            values.to(numbers.device)
        )


def _places(
    worlds: Worlds, name: str, entity: str | None, scene: Model
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return which numbers of an array a scene takes, and their indices there.

    Raises LoadError for one that it lacks.
    """
    index = worlds.arrays[name].index
    if entity is None:
        if flat(scene, name).size != flat(worlds.nominal, name).size:
            help = "say what the scene calls the bundle: `worlds.mjlab(study, entity=...)`"
            raise failure("bundle-changed", "the scene's model is another one than that of the worlds", help)
        return np.arange(index.size), index
    there = {
        (each.element, each.attribute): at
        for at, each in enumerate(whose(scene, name, range(flat(scene, name).size)))
    }
    ours, theirs = [], []
    for at, each in enumerate(whose(worlds.nominal, name, index)):
        if each.kind == "body" and each.element == _WORLD:
            continue  # mjlab recomputes it
        called = _in_scene(each.element, entity)
        if (found := there.get((called, each.attribute))) is None:
            help = (
                "keep in the entity what differs between worlds, or leave out of the recipe what changes it"
            )
            raise failure(
                "bundle-changed", f"the scene has no {each.kind} `{called}` with `{each.attribute}`", help
            )
        ours.append(at)
        theirs.append(found)
    return np.array(ours, np.int64), np.array(theirs, np.int64)


def _in_scene(element: str, entity: str) -> str:
    """Return the name in a scene of an element of an entity.

    >>> _in_scene("arm/elbow", "robot"), _in_scene("#0 of body `hand`", "robot")
    ('robot/arm/elbow', '#0 of body `robot/hand`')
    """
    without_name = _ON_BODY.fullmatch(element)
    return f"{without_name[1]}{entity}/{without_name[2]}" if without_name else f"{entity}/{element}"

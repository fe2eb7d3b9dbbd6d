"""Convert models with different parts to worlds of one model with all parts; see `union_values` for absent parts."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from composer.bundle.bundle import Bundle
from composer.bundle.folder import write_folder
from composer.compiled.kinds import Model
from composer.compiled.varying import MEAN_INERTIA, MEAN_MASS, Differences, flat, put
from composer.context import Context
from composer.engine import Session
from composer.loading.load import load
from composer.verify.run_time import are_close
from composer.worlds.errors import failure
from composer.worlds.joining import Group, Joining
from composer.worlds.parts import CODE, Tree
from composer.worlds.table import Varying
from composer.worlds.union_model import Placed, bodies_of, compose_union, plan_union
from composer.worlds.union_values import Mapped, derived, numbers, silenced
from composer.worlds.worlds import Worlds


def unite(joining: Joining, name: str, context: Context, session: Session) -> tuple[Worlds, Bundle]:
    """Return the worlds of all models, and the bundle of their common model. Raises LoadError."""
    import mujoco

    groups = joining.groups
    trees = [Tree(each.first.loaded.model, each.first.name) for each in groups]
    plan = plan_union(trees, [_label(each, groups) for each in groups])
    folders = [each.first.folder for each in groups if each.first.folder is not None]
    separator = groups[0].first.loaded.manifest.separator
    bundle = compose_union(plan, name, folders, separator=separator, context=context, session=session)
    folder = folders[0].parent / "union"
    write_folder(bundle, folder)
    loaded = load(folder)
    union, count = loaded.model, sum(len(each.worlds) for each in groups)
    found = Differences(union, count)
    for group, active in zip(groups, plan.active, strict=True):
        prefix_of = {
            body: each.prefix for each in active for body in _own_bodies(trees, groups.index(group), each)
        }
        mapped = Mapped(union, group.first.loaded.model, group.first.name, prefix_of=prefix_of)
        unused = [body for each in plan.placed if each not in active for body in bodies_of(trees, each)]
        mapped.check_no_more_acts(unused)
        for place, (world, model) in enumerate(zip(group.worlds, _models(group), strict=True)):
            made = _world(mujoco, union, mapped, model=model, unused=unused)
            if place in (0, len(group.worlds) - 1):
                _check(mapped, made, model, name=group.first.name)
            found.take(world, made)
    varying = {name: Varying(index, values) for name, index, values in found.found()}
    parts = tuple(each.prefix + each.part.body for each in plan.placed)
    has = np.zeros((count, len(parts)), bool)
    for group, active in zip(groups, plan.active, strict=True):
        has[np.ix_(group.worlds, [plan.placed.index(each) for each in active])] = True
    table = replace(joining.table(loaded, varying), parts=parts, has=has)
    return Worlds(union, loaded.manifest, loaded.index, table=table), bundle


def _label(group: Group, groups: Sequence[Group]) -> str:
    """Return the values of axes that distinguish the models of a group from those of the first."""
    ours, first = group.first.cell, groups[0].first.cell
    other = [str(value) for axis, value in ours.items() if axis != "name" and first.get(axis) != value]
    return "-".join(Path(each).stem for each in other) or str(ours["name"])


def _own_bodies(trees: Sequence[Tree], number: int, each: Placed) -> list[str]:
    return list(trees[number].below(each.part.body))


def _models(group: Group) -> Iterator[Model]:
    """Yield the models of a group, in the order of its worlds."""
    nominal, varying = group.first.loaded.model, dict(group.varying())
    for place in range(len(group.worlds)):
        model = copy.copy(nominal)
        for name, own in varying.items():
            values = flat(model, name).copy()
            values[own.index] = own.values[place]
            put(model, name, values)
        yield model


def _world(mujoco: object, union: Model, mapped: Mapped, model: Model, unused: Sequence[str]) -> Model:
    """Return the union in the state of a model's world."""
    made = copy.copy(union)
    for name in numbers(union):
        if hasattr(model, name):
            to, of = mapped.pairs(name)
            flat(made, name)[to] = flat(model, name)[of]
    mapped.put_keys(made, model)
    for name in dir(model.opt):
        if not name.startswith("_") and isinstance(getattr(model.opt, name), np.ndarray | float | int):
            put(made, f"opt.{name}", flat(model, f"opt.{name}"))
    for name, index, value in silenced(union, unused):
        flat(made, name)[index] = value
    mujoco.mj_setConst(made, mujoco.MjData(made))  # type: ignore[attr-defined]
    # Solvers stop when a step improves less than their tolerance, in units of this times the number of dofs.
    put(made, MEAN_INERTIA, flat(model, MEAN_INERTIA) * model.nv / max(1, made.nv))
    put(made, MEAN_MASS, flat(model, MEAN_MASS))
    return made


def _check(mapped: Mapped, made: Model, model: Model, name: str) -> None:
    """Check that MuJoCo computes the same for the union in a world as for the model. Raises LoadError."""
    different = []
    for array in (*numbers(model), *derived(model)):
        to, of = mapped.pairs(array) if hasattr(made, array) else (np.empty(0, int), np.empty(0, int))
        if not are_close(flat(made, array)[to], flat(model, array)[of]):
            different.append(array)
    if different:
        listed = ", ".join(f"`{each}`" for each in different)
        help = "build this cell by itself with `--pick`"
        raise failure(
            CODE, f"`{name}` is not what the union of all models is in its world: {listed} differ", help
        )

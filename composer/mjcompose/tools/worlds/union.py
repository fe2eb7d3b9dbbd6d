"""Models with different parts become worlds of one model with all parts."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mjcompose.base.dataclass import dataclass
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.bundle import MANIFEST, Bundle
from mjcompose.build.bundle.manifest import Input, Read, files_of, from_json, with_manifest
from mjcompose.build.bundle.read import read
from mjcompose.build.bundle.staging import write_folder
from mjcompose.build.stages import Request, build
from mjcompose.build.verify.draws import are_close
from mjcompose.mujoco.attributes import Model
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.varying import MEAN_INERTIA, MEAN_MASS, Differences, flat, put
from mjcompose.sources.context import Context
from mjcompose.tools.worlds.join import CODE, Group, Joining, Part, Tree, common
from mjcompose.tools.worlds.join import parts as joined_parts
from mjcompose.tools.worlds.load import load
from mjcompose.tools.worlds.names import LoadError, failure
from mjcompose.tools.worlds.union_values import Mapped, derived, numbers, silenced
from mjcompose.tools.worlds.worlds import Varying, Worlds


@dataclass(frozen=True, slots=True)
class Placed:
    """A part of a union: its prefix there, and the number of the model that it comes from."""

    part: Part
    prefix: str
    source: int


@dataclass(frozen=True, slots=True)
class Plan:
    """The contents of a union: bodies that all models share, all parts, and the parts of each model."""

    shared: set[str]
    placed: list[Placed]
    active: list[list[Placed]]


def plan_union(trees: Sequence[Tree], labels: Sequence[str]) -> Plan:
    """Plan a union: parts of all models but the first get prefixes from their labels. Raises LoadError."""
    shared = common(trees)
    placed: list[Placed] = []
    active: list[list[Placed]] = []
    for number, tree in enumerate(trees):
        own = []
        for each in joined_parts(tree, shared):
            known = next((other for other in placed if other.part == each), None)
            if known is None:
                known = Placed(each, _prefix(labels[number], placed) if number else "", number)
                placed.append(known)
            own.append(known)
        active.append(own)
    return Plan(shared, placed, active)


def _prefix(label: str, placed: Sequence[Placed]) -> str:
    """Return an unused prefix, such as `can/` for `./props/can.xml`."""
    stem = "".join(each if each.isalnum() else "_" for each in Path(label).stem) or "part"
    taken = {each.prefix for each in placed}
    names = (f"{stem}{number or ''}/" for number in range(len(placed) + 1))
    return next(name for name in names if name not in taken)


def compose_union(
    plan: Plan, name: str, folders: Sequence[Path], separator: str, context: Context, session: Session
) -> Bundle:
    """Return the bundle of a union of the bundles in folders. Raises LoadError if it cannot be composed."""
    attach = {}
    for each in plan.placed:
        if each.source:
            place = {} if each.part.parent == "world" else {"body": each.part.parent}
            model = f"./{folders[each.source].name}/model.xml"
            part = {"model": model, "subtree": each.part.body, "drop": [{"key": "**", "optional": True}], **place}
            attach[each.prefix.rstrip("/")] = part
    recipe = {
        "recipe": 1, "name": name, "separator": separator, "base": f"./{folders[0].name}/model.xml",
        "attach": attach, "conflict": "base",
    }  # fmt: skip
    path = folders[0].parent / "union.yaml"
    path.write_text(json.dumps(recipe))
    own = replace(context, sink=Sink(), timings=[], folder=path.parent)
    made = build(Request(path), own, session=session)
    if made is None:
        raise LoadError(own.sink.errors)
    return of_sources(made.bundle, [read(folder) for folder in folders])


def bodies_of(trees: Sequence[Tree], each: Placed) -> Iterator[str]:
    return (each.prefix + body for body in trees[each.source].below(each.part.body))


_LICENSES = "LICENSES/"


def of_sources(bundle: Bundle, models: Sequence[Bundle]) -> Bundle:
    """Return a union with the inputs, licenses and recipe from the manifests of its models."""
    manifests = [from_json(each.files[MANIFEST]) for each in models]
    texts: dict[str, bytes] = {}
    inputs: dict[tuple[str, str], Input] = {}
    licenses: dict[str, dict[str, None]] = {}
    read: dict[tuple[str, str], Read] = {}
    for model, manifest in zip(models, manifests, strict=True):
        moved = {path: _free(path, model.files[path], texts) for path in model.files if path.startswith(_LICENSES)}
        texts |= {moved[path]: model.files[path] for path in moved}
        for each in manifest.inputs:
            known = each.model_copy(update={"licenses": tuple(moved.get(path, path) for path in each.licenses)})
            inputs.setdefault((each.path, each.sha256), known)
        for license, parts in manifest.licenses.items():
            licenses.setdefault(license, {}).update(dict.fromkeys(parts))
        read |= {(each.path, each.sha256): each for each in manifest.read}
    files = {path: content for path, content in bundle.files.items() if not path.startswith(_LICENSES)}
    whole = Bundle({**files, **texts}, bundle.model)
    first = manifests[0]
    changes = {
        "recipe": first.recipe, "seed": first.seed, "adopted": first.adopted, "inputs": tuple(inputs.values()),
        "parts": (),  # a part of several models is compared with its source in each of them
        "read": tuple(each for _, each in sorted(read.items())), "files": files_of(whole), "union": len(models),
        "licenses": {license: tuple(parts) for license, parts in sorted(licenses.items())},
    }  # fmt: skip
    return with_manifest(whole, from_json(bundle.files[MANIFEST]).model_copy(update=changes))


def _free(path: str, content: bytes, texts: dict[str, bytes]) -> str:
    number, free = 1, path
    while texts.get(free, content) != content:
        number += 1
        free = f"{_LICENSES}{number}/{path.removeprefix(_LICENSES)}"
    return free


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
    for group, tree, active in zip(groups, trees, plan.active, strict=True):
        prefix_of = {body: each.prefix for each in active for body in tree.below(each.part.body)}
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
    ours, first = group.first.cell, groups[0].first.cell
    other = [str(value) for axis, value in ours.items() if axis != "name" and first.get(axis) != value]
    return "-".join(Path(each).stem for each in other) or str(ours["name"])


def _models(group: Group) -> Iterator[Model]:
    nominal, varying = group.first.loaded.model, dict(group.varying())
    for place in range(len(group.worlds)):
        model = copy.copy(nominal)
        for name, own in varying.items():
            values = flat(model, name).copy()
            values[own.index] = own.values[place]
            put(model, name, values)
        yield model


def _world(mujoco: object, union: Model, mapped: Mapped, model: Model, unused: Sequence[str]) -> Model:
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
        raise failure(CODE, f"`{name}` differs from the union of all models in its world: {listed}", help)

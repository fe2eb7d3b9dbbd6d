"""Worlds for batches, MJX, MuJoCo Warp and mjlab."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import mujoco as mujoco_module
import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note
from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.varying import MEANS, flat, value_of, whose
from mjcompose.targets.table import TARGETS
from mjcompose.targets.target import OPTION, UnsupportedElement
from mjcompose.tools.worlds.names import LoadError, failure
from mjcompose.tools.worlds.shared import INSTEAD, check_shapes, shared_error
from mjcompose.tools.worlds.start import of_arrays, put_starts
from mjcompose.tools.worlds.worlds import Varying, Worlds, with_numbers

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def mujoco(worlds: Worlds, nthread: int = 0, *, persistent: bool = False) -> Any:
    """Return a `mujoco.batch.Batch` with a simulation for each world, on `nthread` threads (0: all cores).

        batch = worlds.mujoco(study)
        batch.expand("body_mass")      # (worlds, nbody): expanded already, with each world's masses

    Every array that differs is expanded and filled, including those that mj_setConst computes: `batch.set_const()`
    would change nothing. `stat.meaninertia`, which scales the tolerances of solvers, and `stat.meanmass` come from the
    nominal model: a batch has one `stat` for all.

    Needs MuJoCo 3.17 or newer; raises LoadError without it, and for an array that a batch cannot expand.
    """
    try:
        from mujoco.batch import MODEL_FIELDS, Batch
    except ImportError as error:
        help = "install `mujoco>=3.17`, or step `worlds.models()` one after another"
        raise failure("not-installed", f"MuJoCo {mujoco_module.__version__} has no `mujoco.batch`", help) from error
    names = [name for name in worlds.arrays if name not in MEANS]
    shared = [name for name in names if name not in MODEL_FIELDS]
    if shared:
        help = "step `worlds.models()` one after another, or remove the fields of `randomize` that change them"
        message = f"a batch of MuJoCo has {_listed(shared)} once for all simulations"
        raise failure("not-per-world", message, help)
    batch = Batch(worlds.nominal, worlds.count, nthread, persistent=persistent)
    for name in names:
        varying = worlds.arrays[name]
        numbers = batch.expand(name).view()
        numbers.shape = (worlds.count, -1)  # the same memory
        numbers[:, varying.index] = varying.values
    return batch


_OF_SLEEP = "dof_length"
_FLUID = ("opt.density", "opt.viscosity", "opt.wind")
"""The options of a fluid."""
_IN_FLUID = ("body_fluid_box_adr", "body_fluid_ellipsoid_adr", "body_fluid_ellipsoid")
"""Arrays of Warp's model that its steps read only in a fluid."""
_FACTORS = ("efm0_", "dof_M0", _OF_SLEEP)
"""Arrays of Warp's model that its steps do not read, except with sleep or the discrete integrator."""


def warp(worlds: Worlds) -> Any:
    """Return a `mujoco_warp.Model` whose arrays have a row for each world, on Warp's default device.

        model = worlds.warp(study)
        data = worlds.warp_data(study)
        mujoco_warp.step(model, data)

    Every array that differs is per world, including those that mj_setConst computes, which would be shared
    otherwise. Keys are not per world: `study.values("key_qpos")` has them. Arrays that Warp's model does not have
    play no part in its steps. Needs `mujoco_warp`; raises LoadError without it, for a model that Warp does not take,
    and for arrays that it shares between worlds.
    """
    mujoco_warp = _mujoco_warp()
    simulator = Simulator("warp", mujoco_warp.put_model)
    model = simulator.take(worlds, worlds.nominal)
    names = per_world(model, worlds)
    check_nothing_is_shared(worlds, simulator, [*names, *unread(worlds)])
    for name in names:
        put_worlds(model, name, worlds)
    return model


def warp_data(worlds: Worlds, **sizes: Any) -> Any:
    """Return a `mujoco_warp.Data` in which each world starts as its own model, on Warp's default device.

        data = worlds.warp_data(study, nconmax=60, njmax=200)

    `sizes` are arguments of `mujoco_warp.make_data`, which has the start of the nominal model for all worlds. No step
    computes the poses of geoms that are fixed in the world, such as a table, so they are right only in this data.
    Needs `mujoco_warp`; raises LoadError without it.
    """
    data = _mujoco_warp().make_data(worlds.nominal, nworld=worlds.count, **sizes)
    put_starts(data, worlds.nominal, of_arrays(worlds.arrays), range(worlds.count), state=True)
    return data


def _mujoco_warp() -> Any:
    try:
        import mujoco_warp
    except ImportError as error:
        raise failure("not-installed", f"`mujoco_warp` cannot be used: {error}", "`pip install mujoco-warp`") from error
    return mujoco_warp


def per_world(model: Any, worlds: Worlds) -> list[str]:
    """Return the differing arrays that a `mujoco_warp.Model` can have for each world. Raises LoadError for others."""
    names = []
    for name in worlds.arrays:
        if _can_vary(model, name):
            names.append(name)
        elif hasattr(*_owner(model, name)) and is_stepped(name) and name not in unread(worlds):
            raise shared_error("MuJoCo Warp", worlds, name)
    return names


def put_worlds(model: Any, name: str, worlds: Worlds) -> None:
    import warp as wp

    owner, field = _owner(model, name)
    plain = getattr(owner, field)
    shape = (worlds.count, *plain.shape[1:], *getattr(plain.dtype, "_shape_", ()))
    numbers = worlds.values(name)
    kind = np.float32 if numbers.dtype.kind == "f" else numbers.dtype
    made = wp.array(numbers.reshape(shape).astype(kind), dtype=plain.dtype, device=plain.device)
    made._is_batched = True  # marks an array for each world, as opposed to one for all
    setattr(owner, field, made)


def _can_vary(model: Any, name: str) -> bool:
    owner, field = _owner(model, name)
    if not hasattr(owner, field):
        return False
    spec = next((each.type for each in dataclasses.fields(owner) if each.name == field), None)
    return bool((getattr(spec, "shape", None) or ("",))[0] == "*")


def unread(worlds: Worlds) -> list[str]:
    """Return the arrays that the steps of these worlds do not use."""
    flag = getattr(mujoco_module.mjtEnableBit, "mjENBL_SLEEP", None)
    sleeps = flag is not None and bool(worlds.nominal.opt.enableflags & int(flag))
    discrete = getattr(mujoco_module.mjtIntegrator, "mjINT_DISCRETE", None)
    factored = discrete is not None and worlds.nominal.opt.integrator == int(discrete)
    read = (*((_OF_SLEEP,) if sleeps else ()), *(("efm0_",) if factored else ()))
    factors = [name for name in dir(worlds.nominal) if name.startswith(_FACTORS) and not name.startswith(read)]
    fluid = [name for name in _FLUID if name in worlds.arrays or np.any(value_of(worlds.nominal, name))]
    return [*factors, *MEANS, *(() if fluid else _IN_FLUID)]


def _owner(model: Any, name: str) -> tuple[Any, str]:
    path, _, field = name.rpartition(".")
    return (getattr(model, path, None) if path else model), field


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
    check_shapes(worlds)
    simulator = Simulator("mjx", module.put_model)
    plain = simulator.take(worlds, worlds.nominal)
    base = plain if model is None else model
    replaced: dict[str, Any] = {}
    for name in worlds.arrays:
        leaf = _leaf(plain, name)
        if leaf is None or not isinstance(leaf, jax.Array):
            if leaf is not None and is_stepped(name):
                raise shared_error("MJX", worlds, name)
            continue
        theirs = _leaf(base, name)
        if getattr(theirs, "shape", None) != leaf.shape:
            found = "does not have it" if theirs is None else f"has the shape {theirs.shape}, not {leaf.shape}"
            message = f"`model` differs from the worlds' model: of `{name}` it {found}"
            raise failure("bundle-changed", message, "make it from `study.nominal`, or omit it")
        replaced[name] = jax.numpy.asarray(worlds.values(name).reshape(worlds.count, *leaf.shape), leaf.dtype)
    check_nothing_is_shared(worlds, simulator, replaced)
    axes = jax.tree_util.tree_map(lambda _: None, base).tree_replace(dict.fromkeys(replaced, 0))
    return base.tree_replace(replaced), axes


def _leaf(model: Any, name: str) -> Any:
    """Return an array of a model by its path, such as `opt.timestep`, or None if it does not exist."""
    for each in name.split("."):
        model = getattr(model, each, None)
    return model


_WORLD = "world"
_ON_BODY = re.compile(r"(#\d+ of body `)(.*`)")


def mjlab(worlds: Worlds, entity: str | None = None) -> dict[str, Any]:
    """Return the terms for `events` of an environment's configuration: environment `n` is world `n` from its start.

        events = {**worlds.mjlab(study, entity="robot"), "push": EventTermCfg(...)}

    `entity` is the name of the bundle in the scene; without it the scene's model is the bundle's. The function of the
    term is like the functions of `mjlab.envs.mdp.dr`. Its `model_fields` lists the arrays with a row for each world,
    for mjlab's `expand_model_fields`. In a scene, mjlab recomputes values that depend on masses and poses, because
    the world body has more than the entity.

    Needs `mjlab`; raises LoadError without it, for a model that MuJoCo Warp does not take, and for arrays that it
    shares between worlds. If the scene lacks an element, or its number of environments differs from the number of
    worlds, creating the environment raises LoadError.
    """
    try:
        import mujoco_warp
        from mjlab.managers.event_manager import EventTermCfg, RecomputeLevel
    except ImportError as error:
        raise failure("not-installed", f"`mjlab` cannot be used: {error}", "`pip install mjlab`") from error
    simulator = Simulator("warp", mujoco_warp.put_model)
    names = [name for name in per_world(simulator.take(worlds, worlds.nominal), worlds) if is_stepped(name)]
    dotted = [name for name in names if "." in name]
    if dotted:
        raise failure("not-per-world", f"mjlab shares `{dotted[0]}` among all worlds", INSTEAD)
    check_nothing_is_shared(worlds, simulator, [*names, *unread(worlds)])

    def set_worlds(env: Any, env_ids: Any = None) -> None:
        _set(worlds, names, entity, sim=env.sim, env_ids=env_ids)

    set_worlds.model_fields = tuple(names)  # type: ignore[attr-defined]
    set_worlds.recompute = RecomputeLevel.none if entity is None else RecomputeLevel.set_const  # type: ignore[attr-defined]
    return {"worlds": EventTermCfg(func=set_worlds, mode="startup")}


def _set(worlds: Worlds, names: list[str], entity: str | None, sim: Any, env_ids: Any) -> None:
    import torch
    import warp

    if sim.num_envs != worlds.count:
        help = f"make `num_envs` {worlds.count}, or choose worlds: `study.take(range({sim.num_envs}))`"
        raise failure("bundle-changed", f"there are {sim.num_envs} environments and {worlds.count} worlds", help)
    chosen = torch.arange(sim.num_envs) if env_ids is None else env_ids.cpu()
    written = {}
    for name in names:
        ours, theirs = _places(worlds, name, entity, scene=sim.mj_model)
        values = worlds.arrays[name].values[:, ours][chosen.numpy()]
        if entity is not None and name in REFERENCES:
            values = in_scene(worlds, name, ours, values=values, entity=entity, scene=sim.mj_model)
        written[name] = Varying(theirs, values)
        numbers = warp.to_torch(getattr(sim.wp_model, name)).view(sim.num_envs, -1)
        rows = chosen[:, None].to(numbers.device)
        columns = torch.as_tensor(theirs, device=numbers.device)
        numbers[rows, columns] = torch.as_tensor(values, dtype=numbers.dtype, device=numbers.device)
    put_starts(sim.wp_data, sim.mj_model, written, chosen.tolist(), state=False)


def _places(
    worlds: Worlds, name: str, entity: str | None, scene: MjModel
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the numbers of an array that a scene takes, and their indices there. Raises LoadError."""
    index = worlds.arrays[name].index
    if entity is None:
        if flat(scene, name).size != flat(worlds.nominal, name).size:
            help = "give the name of the bundle in the scene: `worlds.mjlab(study, entity=...)`"
            raise failure("bundle-changed", "the scene's model differs from the worlds' model", help)
        return np.arange(index.size), index
    every = whose(scene, name, range(flat(scene, name).size))
    there = {(each.element, each.attribute): at for at, each in enumerate(every)}
    ours = []
    theirs = []
    for at, each in enumerate(whose(worlds.nominal, name, index)):
        if each.kind == "body" and each.element == _WORLD:
            continue  # mjlab recomputes it
        called = _in_scene(each.element, entity)
        found = there.get((called, each.attribute))
        if found is None:
            help = "keep it in the entity, or remove its changes from the recipe"
            raise failure("bundle-changed", f"the scene has no {each.kind} `{called}` with `{each.attribute}`", help)
        ours.append(at)
        theirs.append(found)
    return np.array(ours, np.int64), np.array(theirs, np.int64)


REFERENCES = ("geom_dataid", "geom_matid", "site_matid", "tendon_matid", "mat_texid", "light_texid")
"""Arrays of ids of assets, which have other numbers in a scene."""


def in_scene(
    worlds: Worlds, name: str, ours: NDArray[np.int64], values: NDArray[Any], *, entity: str, scene: MjModel
) -> NDArray[Any]:
    """Return ids of assets of an entity as ids of the scene; `ours` are columns of the table. Raises LoadError."""
    model = worlds.nominal
    index = worlds.arrays[name].index[ours]
    own_names = NameTable(model)
    scene_names = NameTable(scene)
    found = values.copy()
    for column, place in enumerate(index.tolist()):
        kind = _kind_of_asset(model, name, place)
        names = own_names.names[kind]
        ids = scene_names.ids[kind]
        for number in np.unique(values[:, column]).tolist():
            if number < 0:
                continue
            called = _in_scene(names[number], entity)
            if not names[number] or called not in ids:
                help = "keep it in the entity: name it, and let the scene have all assets of the bundle"
                raise failure("bundle-changed", f"the scene has no {kind} `{called}`", help)
            found[values[:, column] == number, column] = ids[called]
    return found


def _kind_of_asset(model: MjModel, name: str, place: int) -> str:
    if name == "geom_dataid":
        return "hfield" if model.geom_type[place] == int(mujoco_module.mjtGeom.mjGEOM_HFIELD) else "mesh"
    return "material" if name.endswith("matid") else "texture"


def _in_scene(element: str, entity: str) -> str:
    """Return the name in a scene of an entity's element: `robot/arm/elbow`, or `#0 of body `robot/hand``."""
    without_name = _ON_BODY.fullmatch(element)
    return f"{without_name[1]}{entity}/{without_name[2]}" if without_name else f"{entity}/{element}"


_CANNOT = "target-cannot"
_OR_MUJOCO = "use `worlds.mujoco`, which takes all that MuJoCo compiles"


class Simulator(Struct):
    """`target` is its name in the table of targets, and `put_model` is its own function for a `mujoco.MjModel`."""

    target: str
    put_model: Callable[[MjModel], Any]

    @property
    def name(self) -> str:
        """Return its name in sentences: `MuJoCo Warp`."""
        return TARGETS[self.target].title

    def take(self, worlds: Worlds, model: MjModel) -> Any:
        """Return the simulator's own model of the nominal model of these worlds, or of another one of these worlds.

        Raises LoadError for a model that it does not take. The simulator decides; `build --target` knows the same
        limits, so it can name the elements.
        """
        try:
            return self.put_model(model)
        except Exception as error:
            package = TARGETS[self.target].package or self.name
            with suppress(PackageNotFoundError):
                package = f"{package} {version(package)}"
            note = Note(f"{package} says: {' '.join(str(error).split()) or type(error).__name__}")
            raise LoadError(list(self._refused(worlds, model, note))) from error

    def _refused(self, worlds: Worlds, model: MjModel, note: Note) -> Iterator[Diagnostic]:
        """Yield an error for each known reason, or one error with the words of the simulator."""
        found: dict[tuple[str, str], list[UnsupportedElement]] = {}
        for limit in TARGETS[self.target].limits:
            if limit.refuses is not None:
                for each in limit.refuses(mujoco_module, model):
                    found.setdefault((each.why, each.help), []).append(each)
        if not found:
            message = f"{self.name} does not take the model of the worlds"
            help = f"remove unsupported elements from the recipe, or {_OR_MUJOCO}"
            yield Diagnostic(_CANNOT, message, notes=(note,), help=help)
        table = NameTable(model)
        for (why, help), (first, *others) in found.items():
            help = f"in the recipe {help}, and build it again; or {_OR_MUJOCO}"
            notes = (*_written(worlds, first), note)
            alike = tuple(Note(_shown(table, each)) for each in others)
            yield Diagnostic(_CANNOT, f"{_shown(table, first)}: {why}", notes=notes, help=help, others=alike)


def _shown(table: NameTable, refusal: UnsupportedElement) -> str:
    if refusal.kind == OPTION:
        return OPTION
    return _called(table, refusal.kind, refusal.number)


def _called(table: NameTable, kind: str, number: int) -> str:
    name = table.names[kind][number]
    return f"{kind} " + (f"`{name}`" if name else table.describe(kind, number))


def _written(worlds: Worlds, refusal: UnsupportedElement) -> Iterator[Note]:
    """Yield the place of an element if the manifest knows it, as for joints, actuators and sensors."""
    elements = getattr(worlds.manifest.index, f"{refusal.kind}s", ())
    if refusal.number < len(elements) and elements[refusal.number].origin is not None:
        yield Note(f"it is written in {elements[refusal.number].origin}")


_FLAG = "has"
NOT_STEPPED = ("key_", "light_", "mat_", "tex_", "cam_", "geom_rgba", "site_rgba", "tendon_rgba", "names", "stat.")
"""Arrays that a step does not read: if a simulator shares them, only its rendering and resets are affected."""


def is_stepped(name: str) -> bool:
    """Return whether a step reads the array."""
    return not name.startswith(NOT_STEPPED)


def check_nothing_is_shared(worlds: Worlds, simulator: Simulator, varied: Collection[str]) -> None:
    """Compare a simulator's conversions of the nominal model and of a model in which every varying number differs.

    Every difference must be among the `varied` arrays. MuJoCo Warp, for instance, leaves springs of tendons out of
    its steps if the converted model has none, regardless of the arrays of the worlds. Raises LoadError.
    """
    before, after = (dict(_leaves(simulator.take(worlds, each))) for each in (worlds.nominal, _otherwise(worlds)))
    last = {name.rpartition(".")[2] for name in varied}
    shared = []
    for name, value in before.items():
        reads = name in after and name.rpartition(".")[2] not in last and is_stepped(name.removeprefix("_impl."))
        if name not in varied and reads and not _same(value, after[name]):
            only_more_flags = _FLAG in name and not np.any(np.asarray(after[name], bool) & ~np.asarray(value, bool))
            shared += [] if only_more_flags else [name]  # additional flags only cost time
    if shared:
        message = f"{simulator.name} shares {_listed(shared)} among all worlds, computed from what differs"
        raise failure("not-per-world", message, INSTEAD, notes=[f"these worlds differ in {_listed(worlds.arrays)}"])


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _otherwise(worlds: Worlds) -> MjModel:
    """Return a model in which each varying number is the largest of the values that are not nominal."""
    largest = {}
    for name, varying in worlds.arrays.items():
        other = varying.values != flat(worlds.nominal, name)[varying.index]
        chosen = np.where(other, np.abs(varying.values), -1).argmax(axis=0)
        largest[name] = varying.index, varying.values[chosen, np.arange(varying.index.size)]
    return with_numbers(worlds.nominal, largest)


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    if dataclasses.is_dataclass(value):
        for each in dataclasses.fields(value):
            if hasattr(value, each.name):
                yield from _leaves(getattr(value, each.name), f"{name}.{each.name}" if name else each.name)
    else:
        yield name, value


def _same(a: Any, b: Any) -> bool:
    if hasattr(a, "numpy"):
        a = a.numpy()
        b = b.numpy()
    if hasattr(a, "shape"):
        a = np.asarray(a)
        b = np.asarray(b)
        kind = a.dtype.kind
        return a.shape == b.shape and (kind not in "biufc" or np.array_equal(a, b, equal_nan=kind in "fc"))
    return not isinstance(a, bool | int | float | str) or a == b

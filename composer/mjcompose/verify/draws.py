"""Draws at run time, and numbers that differ between worlds."""

from __future__ import annotations

import io
import itertools
import json
import math
import zipfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.distribution import CHOICE
from mjcompose.base.scratch import scratch
from mjcompose.bundle.bundle import DRAWS, MODEL, WORLDS, Bundle
from mjcompose.bundle.listing import write_rows
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import FREE
from mjcompose.mujoco.messages import CRASH_HELP, CRASHES
from mjcompose.mujoco.settable import DerivedValues, are_close, resolve_addresses
from mjcompose.mujoco.varying import Numbers, Recorder, arrays, flat, put, stored
from mjcompose.plan.plan import ElementDraws, Plan
from mjcompose.sources.context import Context
from mjcompose.text.expression import UNITS, Angle
from mjcompose.text.node import locate
from mjcompose.tree.values import is_in_degrees
from mjcompose.verify.compile import WHOLE

if TYPE_CHECKING:
    from mjcompose.language.randomize import DrawField
    from mjcompose.mujoco.model_types import MjModel
    from mjcompose.plan.measured_draws import DrawnNumber

SAMPLES = "samples.csv"
SAMPLE = "sample"
"""The name under which a session keeps the sample that a table is compared with."""
CODE = "draw-at-run-time"
_FORMAT = 1


class DrawTable:
    """The table of draws for the model that `session` keeps. Draws that are impossible at run time are reported."""

    def __init__(self, plan: Plan, tabled: Sequence[ElementDraws], session: engine.Session, context: Context) -> None:
        self.plan = plan
        self.tabled = tabled
        self.session = session
        self.context = context
        self.columns: dict[str, dict[str, Any]] = {}
        self.values: dict[str, Sequence[Any]] = {}

    def fill(self) -> bool:
        """Look up the address of every number, and return whether each has one."""
        before = self.context.sink.error_count
        numeric = []
        questions = []
        for each in self.tabled:
            first = each.first.value if isinstance(each.first.value, tuple) else (each.first.value,)
            if any(isinstance(value, str) for value in first):
                self._fault(each.field, f"field `{each.field.name}` draws names, which a compiled model cannot change")
                continue
            numeric.append(each)
            questions.append(
                {
                    "tag": each.tag,
                    "family": each.family,
                    "name": each.name,
                    "place": each.place,
                    "attribute": each.first.attribute,
                    "start": each.first.start,
                    "count": len(each.first.columns()),
                }
            )
        answers = self.ask(resolve_addresses, [WHOLE], questions)
        if answers is None:
            return False
        for each, found in zip(numeric, answers, strict=True):
            if "error" in found:
                message = f"field `{each.field.name}` cannot be drawn at run time: {found['error']}"
                if found.get("nameless"):
                    advice = f"give each `{each.tag}` a name, or select only elements with names"
                    self._fault(each.field, message, advice=advice)
                    continue
                instead = "or draw the `mass` of its body" if each.first.attribute == "density" else ""
                self._fault(each.field, message, instead)
            else:
                self._add(each, found)
        return self.context.sink.error_count == before

    def added(self, bundle: Bundle) -> Bundle:
        wanted = self.plan.randomize
        assert wanted is not None
        data = {
            "randomize": _FORMAT,
            "model": MODEL,
            "samples_file": SAMPLES,
            "seed": wanted.seed,
            "samples": wanted.samples,
            "mujoco": self.session.mujoco_version,
            "fields": {each.name: _field(each) for each in wanted.fields},
            "columns": [{"column": name, **column} for name, column in self.columns.items()],
        }
        table = io.StringIO(newline="")
        nominal = [0, *[None] * len(self.columns)]
        rows = zip(range(1, wanted.samples + 1), *self.values.values(), strict=True)
        write_rows(table, ["sample", *self.columns], itertools.chain([nominal], rows))
        described = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        return bundle.with_files({DRAWS: described.encode(), SAMPLES: table.getvalue().encode()})

    def _add(self, each: ElementDraws, found: dict[str, Any]) -> None:
        for component, (name, _) in enumerate(each.first.columns()):
            if name not in self.columns:
                low, high = _bounds(each, component)
                about = {"field": each.field.name, "operation": each.field.operation, "low": low, "high": high}
                self.columns[name] = {**about, "targets": []}
                self.values[name] = each.numbers[component]
            of = {"type": each.family, "name": each.name or "", "id": found["id"]}
            self.columns[name]["targets"] += [{**of, **target} for target in found["targets"][component]]

    def _fault(
        self, field: DrawField | DrawnNumber, message: str, instead: str = "", *, advice: str | None = None
    ) -> None:
        help = "build without `--as worlds`" + (f", {instead}" if instead else ", so each sample is a model")
        help = help if advice is None else advice
        self.context.sink.error(CODE, message, locate(self.plan.document, (*field.at, "attr")), help=help)

    def ask(self, question: Callable[..., Any], models: Sequence[str], argument: Any) -> Any:
        """Return the answer of MuJoCo's process, or None if it crashes, which is reported."""
        answer = engine.call(self.session, question, models, argument=argument)
        if answer.ok:
            return answer.value
        code = CRASHES.get(answer.crash or "", "mujoco-crash")
        span = locate(self.plan.document, ("randomize", "samples"))
        message = f"the table of draws: {answer.error or answer.crash}"
        self.context.sink.error(code, message, span, help=CRASH_HELP.get(code))
        return None


def _bounds(each: ElementDraws, component: int) -> tuple[float | None, float | None]:
    """Return the smallest and the largest number that may be drawn, in the table's unit; None for no bound."""
    distribution = each.field.distribution
    numbers = distribution.extremes(component)
    if distribution.kind == CHOICE and not numbers:
        numbers = tuple(map(float, each.numbers[component]))  # type: ignore[arg-type]
    unit = distribution.unit
    if unit is None and each.unit == "degree" and each.angles[component : component + 1] == (True,):
        unit = "deg"
    own = "deg" if is_in_degrees(each.tag, each.first.attribute) else "rad"
    turned = [Angle(end, UNITS[unit]).in_unit(own) if unit else end for end in (min(numbers), max(numbers))]
    low, high = (number if math.isfinite(number) else None for number in turned)
    return low, high


def _field(field: DrawField) -> dict[str, Any]:
    distribution = field.distribution
    parameters = {name: list(each) if len(each) > 1 else each[0] for name, each in distribution.parameters.items()}
    return {
        "select": None if field.select is None else str(field.select),
        "attribute": field.attr or None,
        "operation": field.operation,
        "per": field.per,
        "distribution": distribution.kind,
        "parameters": parameters,
        "unit": distribution.unit,
    }


Build = Callable[[int], bool]
"""Builds a sample, which the session keeps as `SAMPLE`; returns whether it succeeded."""


def with_worlds(table: DrawTable, bundle: Bundle, build: Build) -> Bundle:
    """Return the bundle with the worlds of a filled table, three of which are compared with samples; report errors."""
    wanted = table.plan.randomize
    assert wanted is not None
    with scratch("worlds") as folder:
        paths = {"draws": str(folder / "draws.npy"), "out": str(folder / "worlds.npz")}
        np.save(paths["draws"], np.array(list(table.values.values()), float).T)
        if table.ask(compute_worlds, [WHOLE], {**paths, "columns": list(table.columns.values())}) is None:
            return bundle
        for sample in sorted({1, (wanted.samples + 1) // 2, wanted.samples}):
            if not build(sample):
                return bundle
            different = table.ask(compare_world, [WHOLE, SAMPLE], {**paths, "world": sample - 1})
            if different is None:
                return bundle
            if different:
                listed = ", ".join(f"`{name}`" for name in different)
                message = f"world {sample - 1} differs from sample {sample} as a build makes it: {listed}"
                help = "remove the fields that change these, or build without `--as worlds`"
                span = locate(table.plan.document, ("randomize",), key=True)
                table.context.sink.error(CODE, message, span, help=help)
                return bundle
        about = {
            "worlds": _FORMAT,
            "model": MODEL,
            "mujoco": table.session.mujoco_version,
            "seed": wanted.seed,
            "samples": wanted.samples,
        }
        with zipfile.ZipFile(paths["out"], "a") as archive:
            archive.writestr(zipfile.ZipInfo("about.json"), json.dumps(about))
        return bundle.with_files({WORLDS: Path(paths["out"]).read_bytes()})


Place = tuple[str, int]
"""A number of mjModel: its array and its index in the flattened array."""
_BLOCK = 1024


def compute_worlds(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> list[str]:
    """Write all numbers that differ in some world to `out`; return the arrays. `draws` is `(worlds, columns)`."""
    draws = np.load(asked["draws"], allow_pickle=False)
    columns = asked["columns"]
    found = Recorder(model)
    computed = DerivedValues(mujoco, model, mujoco.MjData(model))
    following = list(_following(model, columns))
    for first in range(0, len(draws), _BLOCK):
        drawn = list(_drawn(model, columns, following, rows=draws[first : first + _BLOCK], found=found))
        for world in range(len(draws[first : first + _BLOCK])):
            for memory, places, values in drawn:
                memory[places] = values[world]
            computed.settle()
            found.take()
    entries = stored(model, found.found())
    with open(asked["out"], "wb") as file:
        np.savez(file, allow_pickle=False, **entries)
    return sorted({name.partition("/")[0] for name in entries})


def _drawn(
    model: MjModel,
    columns: list[dict[str, Any]],
    following: list[tuple[Place, list[Place]]],
    rows: Numbers,
    found: Recorder,
) -> Iterator[tuple[Numbers, Numbers, Numbers]]:
    """Yield the place of drawn numbers in the model's memory, and the numbers, `(worlds, numbers)`."""
    values: dict[Place, Numbers] = {}
    with np.errstate(all="ignore"):  # as with single numbers
        for column, drawn in zip(columns, rows.T, strict=True):
            is_drawn = ~np.isnan(drawn)
            ratio = np.ones(len(rows))
            for target in column["targets"]:
                array = getattr(model, target["array"])
                place = target["array"], int(np.ravel_multi_index(target["index"], array.shape))
                before = values[place] if place in values else np.repeat(flat(model, place[0])[place[1]], len(rows))
                before = before.astype(float)
                signed = drawn * target.get("sign", 1)
                follows = target.get("follows")
                now = (
                    before * ratio
                    if follows
                    else {
                        "set": signed,
                        "scale": before * drawn,
                        "offset": before + signed,
                    }[column["operation"]]
                )
                values[place] = np.where(is_drawn, now, before).astype(array.dtype)
                if not follows:
                    ratio = np.where(before != 0, values[place].astype(float) / before, 1.0)
        for source, targets in following:
            for name, index in targets:
                values[name, index] = values[source].astype(getattr(model, name).dtype)
    for dtype in {value.dtype for value in values.values()}:
        places = [place for place, value in values.items() if value.dtype == dtype]
        memory = np.array([found.first_of(name) + index for name, index in places])
        yield found.view(dtype), memory, np.stack([values[place] for place in places], axis=1)


def compare_world(mujoco: Any, nominal: MjModel, sample: MjModel, asked: dict[str, Any]) -> list[str]:
    """Return the arrays in which `world` of the file `out` differs from a built sample; runs under `engine.call`."""
    before = {name: flat(nominal, name).copy() for name in arrays(nominal)}
    with np.load(asked["out"], allow_pickle=False) as stored:
        for name in {each.partition("/")[0] for each in stored.files}:
            numbers = flat(nominal, name).copy()
            numbers[stored[f"{name}/index"]] = stored[f"{name}/values"][asked["world"]]
            put(nominal, name, numbers)
    different = [name for name in before if not are_close(flat(nominal, name), flat(sample, name))]
    for name, numbers in before.items():
        put(nominal, name, numbers)
    return sorted(different)


_OF_INERTIA = {"body_pos": "body_ipos", "body_quat": "body_iquat"}
_OF_KEYS = {"body_pos": "key_mpos", "body_quat": "key_mquat"}


def _following(model: MjModel, columns: list[dict[str, Any]]) -> Iterator[tuple[Place, list[Place]]]:
    """Yield numbers that the compiler copies from a body's pose but mj_setConst does not, even for free joints."""
    every = [(target["array"], *target["index"]) for column in columns for target in column["targets"]]
    for array, at, width in (("body_pos", 0, 3), ("body_quat", 3, 4)):
        for body, component in sorted({(each[1], each[2]) for each in every if each[0] == array}):
            targets = [
                *_of_free_joint(model, body, at + component),
                *_of_mocap(model, body, array, component=component),
                *_of_inertial_frame(model, body, array, component=component),
            ]
            if targets:
                yield (array, body * width + component), targets


def _of_free_joint(model: MjModel, body: int, component: int) -> Iterator[Place]:
    joint = model.body_jntadr[body]
    if joint < 0 or model.jnt_type[joint] != FREE:
        return
    first = int(model.jnt_qposadr[joint])
    pose = slice(first, first + 7)
    yield "qpos0", first + component
    yield "qpos_spring", first + component
    for key in range(model.nkey):
        if (model.key_qpos[key, pose] == model.qpos0[pose]).all():
            yield "key_qpos", key * model.nq + first + component


def _of_inertial_frame(model: MjModel, body: int, array: str, component: int) -> Iterator[Place]:
    """Yield the number of the inertial frame: MuJoCo gives a massless body its own pose as the inertial frame."""
    name = _OF_INERTIA[array]
    if model.body_mass[body] == 0 and (getattr(model, name)[body] == getattr(model, array)[body]).all():
        yield name, body * getattr(model, name).shape[1] + component


def _of_mocap(model: MjModel, body: int, array: str, component: int) -> Iterator[Place]:
    mocap = int(model.body_mocapid[body])
    if mocap < 0:
        return
    name = _OF_KEYS[array]
    pose = getattr(model, array)[body]
    for key in range(model.nkey):
        first = pose.size * mocap
        if (getattr(model, name)[key, first : first + pose.size] == pose).all():
            yield name, key * pose.size * model.nmocap + first + component

"""In MuJoCo's process: find drawn attributes in a compiled model; tell whether numbers are equal but for rounding."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.compiled.addresses import rows_of
from composer.compiled.attributes import TAGS, array_of, attributes
from composer.compiled.kinds import ON_BODIES, Model
from composer.compiled.servos import GAINS
from composer.recipe.verbs.values import MASS

_CLOSE = 1e-9
"""Tolerance for numbers that were computed in two ways, relative to the larger of 1 and the number."""


def resolve(mujoco: Any, model: Model, asked: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for each element its id and the addresses of its numbers in mjModel, or an `error`.

    Runs under `composer.engine.call`. Each of `asked` has `tag`, `family`, `name` or `place`, `attribute`,
    and `start` and `count` of its numbers. The answer has `id`, and under `targets` for each number a list of
    `{array, index}`; with a `sign` if it is not 1, and with `follows` if the value changes in proportion to
    the first.
    """
    return [_resolved(mujoco, model, each) for each in asked]


def _resolved(mujoco: Any, model: Model, asked: dict[str, Any]) -> dict[str, Any]:
    tag, family, attribute = asked["tag"], asked["family"], asked["attribute"]
    gains = GAINS.get((tag, attribute))
    known = family in TAGS and (gains or attribute in attributes(family))
    if not known:
        return {"error": f"`{attribute}` of `{tag}` is not an array of mjModel"}
    number = _id(mujoco, model, asked)
    if isinstance(number, str):
        return {"error": number}
    if family == "body" and attribute == MASS:
        inertia: list[dict[str, Any]] = [
            {"array": "body_inertia", "index": [number, n], "follows": True} for n in range(3)
        ]
        return {"id": number, "targets": [[{"array": "body_mass", "index": [number]}, *inertia]]}
    if gains is not None:
        targets = [{"array": array, "index": [number, n], "sign": sign} for array, n, sign in gains]
        return {"id": number, "targets": [targets]}
    array = array_of(family, attribute)
    rows = rows_of(model, family, array, index=number)
    if family == "actuator":  # if an actuator has several controls, the draw is for the first
        rows = range(rows.start, rows.start + 1)
    found = getattr(model, array, None)
    width = 1 if found is None or found.ndim == 1 else int(np.prod(found.shape[1:]))
    last = asked["start"] + asked["count"]
    if found is None or last > width:
        return {"error": f"`{attribute}` of `{tag}` has not as many numbers in mjModel"}
    found_at: list[list[dict[str, Any]]] = [
        [{"array": array, "index": [row] if found.ndim == 1 else [row, n]} for row in rows]
        for n in range(asked["start"], last)
    ]
    return {"id": number, "targets": found_at}


def _id(mujoco: Any, model: Model, asked: dict[str, Any]) -> int | str:
    """Return the id of an element, or why it has none."""
    family, name, place = asked["family"], asked["name"], asked["place"]
    if name:
        kind = getattr(mujoco.mjtObj, f"mjOBJ_{family.upper()}")
        number = int(mujoco.mj_name2id(model, kind, name))
        return number if number >= 0 else f"the compiled model has no {family} `{name}`"
    if place is None:
        return f"`{asked['tag']}` without a name cannot be found in the compiled model"
    body, position, count = place
    number = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body))
    if number < 0 or family not in ON_BODIES:
        return f"`{asked['tag']}` without a name cannot be found in the compiled model"
    there = np.flatnonzero(getattr(model, ON_BODIES[family]) == number)
    if len(there) != count:
        return f"of the {family}s in body `{body}` that have no name it is not known which is which"
    return int(there[position])


def are_close(a: Any, b: Any) -> bool:
    """Return whether numbers are equal up to the rounding of two ways to compute them."""
    a, b = np.asarray(a), np.asarray(b)
    if a.shape != b.shape:
        return False
    if a.dtype.kind not in "fc":
        return bool(np.array_equal(a, b))
    part = _CLOSE if a.dtype.itemsize == 8 else 1e-5
    scale = np.maximum(1.0, np.abs(b))
    with np.errstate(invalid="ignore"):  # of two infinite numbers
        near = (np.abs(a - b) <= part * scale) & np.isfinite(b)  # everything is near an infinite number
    return bool(np.all(near | (a == b) | (np.isnan(a) & np.isnan(b))))

"""Hashes of the numbers on which measured numbers depend, by topic: numbers of the moving parts that were not measured.

Only the kinematic trees with a measured element count, from the first body that a joint moves. So a camera, a cube or
another place of the robot changes no hash. The measured numbers themselves are left out, and all others are rounded to
nine digits, on which versions of MuJoCo agree.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.settable import resolve_addresses

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_JOINT_TRANSMISSION = 0
_WITH_MASS = {"body_mass": ("body_inertia", "body_iquat")}
"""Arrays that change with a measured one, by the rows of the same body."""
_OF_GAINS = ("actuator_gainprm", "actuator_biasprm", "actuator_gear", "actuator_forcerange", "actuator_dynprm")
_TAGS = ("position", "velocity")


def fingerprints(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the hash of each topic; runs under `mjcompose.mujoco.engine.call`.

    `asked` has `numbers`, each with `kind`, `names` and `attribute`, and the `prefix` of the recipe's names. The answer
    has `missing` instead, the first name that the model does not have, if there is one.
    """
    prefix = asked["prefix"]
    bodies: set[int] = set()
    measured: dict[str, set[int]] = {}
    for number in asked["numbers"]:
        for name in number["names"]:
            identity = _identity(mujoco, model, number["kind"], prefix + name)
            if identity < 0:
                return {"missing": f"{number['kind']} `{prefix}{name}`"}
            bodies.update(_moved_bodies(model, number["kind"], identity))
            _note_measured(mujoco, model, number, prefix + name, measured=measured)
    tree = _trees(model, bodies, prefix, mujoco=mujoco)
    return {"topics": {topic: _hash(content) for topic, content in _contents(model, tree, measured).items()}}


def _identity(mujoco: Any, model: MjModel, kind: str, name: str) -> int:
    return int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), name))


def _moved_bodies(model: MjModel, kind: str, identity: int) -> Iterator[int]:
    """Yield the body that an element belongs to, or all bodies for an element between bodies."""
    if kind == "body":
        yield identity
    elif kind == "joint":
        yield int(model.jnt_bodyid[identity])
    elif kind in ("geom", "site"):
        yield int(getattr(model, f"{kind}_bodyid")[identity])
    elif kind == "actuator" and model.actuator_trntype[identity] == _JOINT_TRANSMISSION:
        yield int(model.jnt_bodyid[model.actuator_trnid[identity, 0]])
    else:
        yield from range(1, model.nbody)


def _note_measured(
    mujoco: Any, model: MjModel, number: dict[str, Any], name: str, measured: dict[str, set[int]]
) -> None:
    """Add the places of a number in the arrays of the model, and of those that change with it."""
    for array, place in places_of(mujoco, model, number["kind"], name, number["attribute"]):
        measured.setdefault(array, set()).add(place)
        for other in _WITH_MASS.get(array, ()):
            width = getattr(model, other).shape[1]
            measured.setdefault(other, set()).update(range(place * width, (place + 1) * width))


def places_of(mujoco: Any, model: MjModel, kind: str, name: str, attribute: str) -> Iterator[tuple[str, int]]:
    """Yield the array and the flat index of each place of a number; nothing for numbers that no topic contains."""
    base, _, index = attribute.partition("[")
    if base == "com":
        identity = _identity(mujoco, model, "body", name)
        yield "body_ipos", 3 * identity + int(index[:-1])
        return
    if base == "shape":
        identity = _identity(mujoco, model, "body", name)
        yield from (("body_inertia", 3 * identity + axis) for axis in range(3))
        return
    start = int(index[:-1]) if index else 0
    tags = (kind, *_TAGS) if kind == "actuator" else (kind,)
    for tag in tags:
        question = {"tag": tag, "family": kind, "name": name, "place": None, "attribute": base}
        (answer,) = resolve_addresses(mujoco, model, [{**question, "start": start, "count": 1}])
        if "error" not in answer:
            for target in answer["targets"][0]:
                array = getattr(model, target["array"])
                yield target["array"], int(np.ravel_multi_index(target["index"], array.shape))


def _trees(model: MjModel, bodies: set[int], prefix: str, mujoco: Any) -> list[int]:
    """Return the bodies of the recipe that move together with one of these, in their order in the model."""
    tops = {_top(model, body) for body in bodies if model.body_weldid[body] != 0}
    owned = _owned(mujoco, model, prefix)
    return [
        body
        for body in range(1, model.nbody)
        if model.body_weldid[body] != 0 and owned[body] and _top(model, body) in tops
    ]


def _top(model: MjModel, body: int) -> int:
    """Return the outermost body that moves with a body."""
    while model.body_weldid[model.body_parentid[body]] != 0:
        body = int(model.body_parentid[body])
    return body


def _owned(mujoco: Any, model: MjModel, prefix: str) -> list[bool]:
    """Return for each body whether its name starts with the prefix; a body without a name follows its parent."""
    owned = [not prefix] * model.nbody
    for body in range(1, model.nbody):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
        owned[body] = name.startswith(prefix) if name else owned[model.body_parentid[body]]
    return owned


def _contents(model: MjModel, bodies: Sequence[int], measured: dict[str, set[int]]) -> dict[str, Any]:
    tops = [body for body in bodies if _top(model, body) == body]
    inner = [body for body in bodies if body not in tops]
    joints = [joint for joint in range(model.njnt) if model.jnt_bodyid[joint] in bodies]
    dofs = [dof for dof in range(model.nv) if model.dof_bodyid[dof] in bodies]
    actuators = [
        actuator
        for actuator in range(model.nu)
        if model.actuator_trntype[actuator] == _JOINT_TRANSMISSION and model.actuator_trnid[actuator, 0] in joints
    ]

    def rows(array: str, indices: Sequence[int]) -> list[list[float]]:
        numbers = np.array(getattr(model, array), float)
        numbers.reshape(-1)[list(measured.get(array, ()))] = 0
        return [_rounded(numbers[index].reshape(-1)) for index in indices]

    parents = [bodies.index(parent) if (parent := model.body_parentid[body]) in bodies else -1 for body in bodies]
    return {
        "links": [
            parents,
            *(rows(array, inner) for array in ("body_pos", "body_quat")),
            *(rows(array, joints) for array in ("jnt_axis", "jnt_pos", "jnt_type")),
        ],
        "inertia": [
            *(rows(array, bodies) for array in ("body_mass", "body_ipos", "body_inertia", "body_gravcomp")),
            rows("dof_armature", dofs),
        ],
        "friction": [
            *(rows(array, dofs) for array in ("dof_damping", "dof_frictionloss")),
            rows("jnt_stiffness", joints),
        ],
        "actuators": [rows(array, actuators) for array in _OF_GAINS],
        "options": [_rounded([model.opt.timestep, model.opt.integrator, *model.opt.gravity])],
    }


def _rounded(numbers: Any) -> list[float]:
    return [float(f"{float(number):.9g}") + 0.0 for number in numbers]


def _hash(content: Any) -> str:
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:16]

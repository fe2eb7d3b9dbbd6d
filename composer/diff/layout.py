"""How large the vectors of the two models are, and where elements stand in them."""

from __future__ import annotations

from collections.abc import Iterator

from composer.compiled.correspondence import Correspondence
from composer.compiled.kinds import KINDS, Model
from composer.diff.change import Count, Move
from composer.diff.values import close

_SIZES = ("nq", "nv", "nu", "na", "nmocap", "nsensordata")

_ADDRESSES = {
    "joint": (("qpos", "jnt_qposadr"), ("qvel", "jnt_dofadr")),
    "actuator": (("ctrl", "actuator_ctrladr"), ("act", "actuator_actadr")),
    "sensor": (("sensordata", "sensor_adr"),),
    "body": (("mocap_pos", "body_mocapid"),),
}


def counts(a: Model, b: Model, tolerance: float) -> Iterator[Count]:
    """Sizes of vectors, numbers of elements, the mass of all."""
    for name in _SIZES:
        if getattr(a, name) != getattr(b, name):
            yield Count(name, int(getattr(a, name)), int(getattr(b, name)))
    for kind, known in KINDS.items():
        before, after = (len(getattr(model, known.addresses)) for model in (a, b))
        if before != after:
            yield Count(kind, before, after)
    mass = float(a.body_mass.sum()), float(b.body_mass.sum())
    if not close(*mass, max(tolerance, 1e-12)):
        yield Count("total mass", *mass, "kg")


def moves(matching: Correspondence) -> Iterator[Move]:
    """Joints, actuators, sensors and mocap bodies that both have, and that stand elsewhere in a vector."""
    a, b = matching.alone.model, matching.composed.model
    for kind, vectors in _ADDRESSES.items():
        pairs = sorted(matching.pairs(kind), key=lambda pair: pair[1])
        for vector, array in vectors:
            before, after = (_addresses(model, array) for model in (a, b))
            for index, target in pairs:
                if before[index] != after[target] and min(before[index], after[target]) >= 0:
                    name = matching.composed.describe(kind, target)
                    yield Move(vector, kind, name, before[index], after[target])


def _addresses(model: Model, array: str) -> list[int]:
    found = getattr(model, array, None)
    if found is None:  # before MuJoCo 4 an actuator had one control
        return list(range(len(model.actuator_actadr)))
    addresses: list[int] = found.tolist()
    return addresses

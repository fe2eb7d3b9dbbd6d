"""Describe what elements outside the body tree refer to; elements with equal descriptions act alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from composer.compiled.kinds import OF_OBJECT_TYPE, Model
from composer.worlds.errors import failure
from composer.worlds.parts import CODE

Label = Callable[[str, int], str]
"""Returns an element's name by kind and number."""
References = Iterator[tuple[str, int]]
"""The kind and number of each element."""

ACTING = ("actuator", "tendon", "equality", "pair", "exclude", "sensor")
"""Kinds of elements that act on their references."""
_JOINT, _JOINT_IN_PARENT, _SLIDERCRANK, _TENDON, _SITE, _BODY = range(6)
_TRANSMISSIONS = {
    _JOINT: "joint", _JOINT_IN_PARENT: "joint", _SLIDERCRANK: "site", _TENDON: "tendon", _SITE: "site", _BODY: "body",
}  # fmt: skip
_EQUALITIES = {2: "joint", 3: "tendon"}
_ALONE = "build these cells by themselves with `--pick`"
_WRAP_JOINT, _PULLEY, _WRAP_SITE = 1, 2, 3


def references(model: Model, kind: str, number: int) -> References:
    """Return the kind and number of each element that one refers to.

    Raises LoadError for an unknown type of reference, when the iterator reaches it.
    """
    found = _REFERENCES.get(kind)
    return iter(()) if found is None else found(model, number)


def _of_actuator(model: Model, number: int) -> References:
    transmission = int(model.actuator_trntype[number])
    known = _TRANSMISSIONS.get(transmission)
    if known is None:
        message = f"an actuator with a transmission of type {transmission} cannot be in a union"
        raise failure(CODE, message, _ALONE)
    for part, target in enumerate(model.actuator_trnid[number].ravel()[:2].tolist()):
        if target >= 0 and (part == 0 or known == "site"):
            yield known, target


def _of_tendon(model: Model, number: int) -> References:
    first = int(model.tendon_adr[number])
    for wrap in range(first, first + int(model.tendon_num[number])):
        shape, target = int(model.wrap_type[wrap]), int(model.wrap_objid[wrap])
        if shape != _PULLEY:
            yield {_WRAP_JOINT: "joint", _WRAP_SITE: "site"}.get(shape, "geom"), target


def _of_equality(model: Model, number: int) -> References:
    shape = int(model.eq_type[number])
    known = _EQUALITIES.get(shape) or OF_OBJECT_TYPE.get(int(model.eq_objtype[number]))
    if known is None:
        raise failure(CODE, f"an equality of type {shape} cannot be in a union", _ALONE)
    for each in (model.eq_obj1id[number], model.eq_obj2id[number]):
        if each >= 0:
            yield known, int(each)


def _of_pair(model: Model, number: int) -> References:
    yield from (("geom", int(each)) for each in (model.pair_geom1[number], model.pair_geom2[number]))


def _of_exclude(model: Model, number: int) -> References:
    signature = int(model.exclude_signature[number])
    yield from (("body", each) for each in (signature >> 16, signature & 0xFFFF))


def _of_sensor(model: Model, number: int) -> References:
    for types, targets in (("sensor_objtype", "sensor_objid"), ("sensor_reftype", "sensor_refid")):
        known = OF_OBJECT_TYPE.get(int(getattr(model, types)[number]))
        if known is not None:
            yield known, int(getattr(model, targets)[number])


_REFERENCES: Mapping[str, Callable[[Model, int], References]] = {
    "actuator": _of_actuator,
    "tendon": _of_tendon,
    "equality": _of_equality,
    "pair": _of_pair,
    "exclude": _of_exclude,
    "sensor": _of_sensor,
}


def words(model: Model, kind: str, number: int, label: Label) -> str:
    """Return an element's type and references: `equality 1 body a body b`."""
    of_type = {"actuator": "actuator_trntype", "equality": "eq_type", "sensor": "sensor_type"}.get(kind)
    head = f"{kind} {int(getattr(model, of_type)[number])}" if of_type else kind
    return " ".join([head, *(f"{of} {label(of, each)}" for of, each in references(model, kind, number))])


def bodies(model: Model, kind: str, number: int) -> Iterator[int]:
    """Yield the bodies of the elements that one refers to."""
    for of, each in references(model, kind, number):
        if of == "body":
            yield each
        elif of in ("joint", "site", "geom", "camera"):
            yield int(getattr(model, {"joint": "jnt", "camera": "cam"}.get(of, of) + "_bodyid")[each])
        elif of == "tendon":
            yield from bodies(model, "tendon", each)

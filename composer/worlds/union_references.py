"""Describe what elements outside the body tree refer to; elements with equal descriptions act alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from composer.compiled.kinds import OF_OBJECT_TYPE, Model
from composer.worlds.errors import failure
from composer.worlds.parts import CODE

Label = Callable[[str, int], str]
"""Returns an element's name by kind and number."""

ACTING = ("actuator", "tendon", "equality", "pair", "exclude", "sensor")
"""Kinds of elements that act on their references."""
_JOINT, _JOINT_IN_PARENT, _SLIDERCRANK, _TENDON, _SITE, _BODY = range(6)
_TRANSMISSIONS = {
    _JOINT: "joint", _JOINT_IN_PARENT: "joint", _SLIDERCRANK: "site", _TENDON: "tendon", _SITE: "site", _BODY: "body",
}  # fmt: skip
_EQUALITIES = {2: "joint", 3: "tendon"}
_ALONE = "build these cells by themselves with `--pick`"
_WRAP_JOINT, _PULLEY, _WRAP_SITE = 1, 2, 3


def references(model: Model, kind: str, number: int) -> Iterator[tuple[str, int]]:
    """Yield the kind and number of elements that one refers to. Raises LoadError for unknown types of reference."""
    match kind:
        case "actuator":
            for part, target in enumerate(model.actuator_trnid[number].ravel()[:2].tolist()):
                known = _TRANSMISSIONS.get(int(model.actuator_trntype[number]))
                if known is None:
                    shape = int(model.actuator_trntype[number])
                    raise failure(
                        CODE, f"an actuator with a transmission of type {shape} cannot be in a union", _ALONE
                    )
                if target >= 0 and (part == 0 or known == "site"):
                    yield known, target
        case "tendon":
            first = int(model.tendon_adr[number])
            for wrap in range(first, first + int(model.tendon_num[number])):
                shape, target = int(model.wrap_type[wrap]), int(model.wrap_objid[wrap])
                if shape != _PULLEY:
                    yield {_WRAP_JOINT: "joint", _WRAP_SITE: "site"}.get(shape, "geom"), target
        case "equality":
            shape = int(model.eq_type[number])
            known = _EQUALITIES.get(shape) or OF_OBJECT_TYPE.get(int(model.eq_objtype[number]))
            if known is None:
                raise failure(CODE, f"an equality of type {shape} cannot be in a union", _ALONE)
            yield from (
                (known, int(each)) for each in (model.eq_obj1id[number], model.eq_obj2id[number]) if each >= 0
            )
        case "pair":
            yield from (("geom", int(each)) for each in (model.pair_geom1[number], model.pair_geom2[number]))
        case "exclude":
            signature = int(model.exclude_signature[number])
            yield from (("body", each) for each in (signature >> 16, signature & 0xFFFF))
        case "sensor":
            for types, targets in (("sensor_objtype", "sensor_objid"), ("sensor_reftype", "sensor_refid")):
                known = OF_OBJECT_TYPE.get(int(getattr(model, types)[number]))
                if known is not None:
                    yield known, int(getattr(model, targets)[number])


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

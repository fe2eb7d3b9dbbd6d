"""The type of an element of a compiled model, and the names it refers to, in MJCF's words."""

from __future__ import annotations

from collections.abc import Iterator

from composer.compiled.attributes import ENUMERATED, array_of
from composer.compiled.enums import words
from composer.compiled.links import links
from composer.recipe.checks.words import naming
from composer.verify.kinds.scope import Scope

_SECOND = ("refsite", "slidersite", "refname")


def words_of(scope: Scope, tag: str, index: int, attr: str) -> Iterator[str]:
    """Yield the value of an attribute.

    There are several if MuJoCo does not store which of two it is, and none if the attribute is not set.
    """
    if attr in ENUMERATED.get(tag, ()):
        array = array_of(tag, attr)
        values = getattr(scope.model, array, None)
        if values is not None:
            yield words(scope.mujoco, array)[int(values[index])]
        return
    kind = naming(tag)[attr]
    for link in links(scope.model, tag, index):
        if link.index >= 0 and (kind is None or link.kind == kind) and _is_meant(link.field, tag, attr):
            yield scope.written(link.kind, link.index)


def _is_meant(field: str, tag: str, attr: str) -> bool:
    """Return whether the attribute writes the reference that the field of mjModel stores."""
    if attr == "target":
        return "target" in field
    if tag == "sensor":
        return field == ("sensor_refid" if attr in _SECOND or attr.endswith("2") else "sensor_objid")
    if tag == "equality":
        return field == ("eq_obj2id" if attr.endswith("2") else "eq_obj1id")
    if tag == "actuator":
        return field == f"actuator_trnid[{int(attr in _SECOND)}]"
    return True

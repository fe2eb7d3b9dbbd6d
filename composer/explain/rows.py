"""The numbers of a keyframe, told by the joints, actuators and bodies they belong to, and which key each is from."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from composer.explain.trace import Life, Trace
from composer.link.key_layouts import holders
from composer.link.layout import Unknown, lay_out
from composer.link.multiplied import element_of
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

VECTORS = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat")


class Row(NamedTuple):
    """The numbers of one joint, actuator or mocap body; `key` is None where they are of the reference configuration."""

    holder: Node
    numbers: str
    key: Life | None


def rows(model: Unit, key: Node, vector: str, trace: Trace) -> list[Row]:
    """One row for each holder of numbers; none where only MuJoCo can tell how they are laid out."""
    numbers = str(key.get(vector) or "").split()
    try:
        owners = holders(lay_out(model, {}), vector)
    except Unknown:
        return []
    if not numbers or sum(width for _, width in owners) != len(numbers):
        return []
    found, at = [], 0
    written = {each.root: each for each in _leaves(trace.life(key)) if each.attributes.get(vector)}
    for holder, width in owners:
        element = element_of(holder)
        life = trace.life(element)
        said = (
            written.get(life.root) if life.made_by is None else None
        )  # no file knows of what was added since
        found.append(Row(element, " ".join(numbers[at : at + width]), said))
        at += width
    return found


def _leaves(key: Life) -> Iterator[Life]:
    """The keys as files have them that one of the model is made of."""
    if not key.sources:
        yield key
    for source in key.sources:
        yield from _leaves(source)

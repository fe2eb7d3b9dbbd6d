"""Bring joints, actuators, sensors or keys of a finished tree into an order of names, as far as MJCF allows it.

MuJoCo numbers actuators, sensors and keys as they are written. It numbers the joints of a body first, then the joints
of each body in it, so the joints inside a body are together, and so are the copies that a `<replicate>` makes. MuJoCo
applies the joints of one body one after the other: a different order gives a different mechanism, unless the joints are
slides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import groupby

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.words import element_text
from mjcompose.link.expansion import element_of, in_order, name_of_holder
from mjcompose.link.key_layout import BLOCKS, JOINTS, joint_type, joints_in_order
from mjcompose.link.unit_keys import keys_of
from mjcompose.tree import journal
from mjcompose.tree.classes import Classes
from mjcompose.tree.unit import Unit

_BODIES = ("body", "worldbody")


def elements_in_order(unit: Unit, kind: str) -> list[tuple[Node, str]]:
    """Return the elements of a kind as MuJoCo numbers them, each copy with its name; blocks of joints have no names."""
    if kind == "key":
        return [(each, str(each.get("name") or "")) for each in keys_of(unit)]
    holders = joints_in_order(unit) if kind == "joint" else in_order(unit.root, kind)
    pairs = ((element_of(each), name_of_holder(each)) for each in holders)
    return [(node, "" if node.tag in BLOCKS else name) for node, name in pairs]


def put_in_order(unit: Unit, kind: str, names: Sequence[str]) -> None:
    """Move the elements with `names` to the front in this order, as far as possible. Others keep their order."""
    places = {name: float(number) for number, name in enumerate(names)}
    ranks: dict[Node, float] = {}
    for node, name in elements_in_order(unit, kind):
        ranks[node] = min(ranks.get(node, math.inf), places.get(name, math.inf))
    if kind != "joint":
        _permute(unit.root.findall("keyframe/key" if kind == "key" else f"{kind}/*"), ranks)
        return
    for attach in unit.root.iter("attach"):  # only MuJoCo knows its joints, all of which have its prefix
        prefix = attach.get("prefix")
        ranks[attach] = min((at for name, at in places.items() if prefix and name.startswith(prefix)), default=math.inf)
    for worldbody in unit.root.iterchildren("worldbody"):
        _sort(worldbody, ranks, unit.classes)


def _sort(holder: Node, ranks: Mapping[Node, float], classes: Classes) -> tuple[float | None, float | None]:
    """Sort the joints of a body, and the bodies in it. Return the lowest rank of both, or None without ranks."""
    own: dict[Node, float] = {}
    inner: dict[Node, float] = {}
    for child in holder.iterchildren("*"):
        joints = bodies = None
        if child.tag in (*JOINTS, *BLOCKS):
            rank = ranks.get(child, math.inf)
            joints, bodies = (rank, None) if child.tag in JOINTS else (None, rank)
        elif child.tag in ("frame", "body", "replicate"):
            joints, bodies = _sort(child, ranks, classes)
            if child.tag != "frame":
                bodies = _least(joints, bodies)
                joints = None
        if joints is not None:
            own[child] = joints
        if bodies is not None:
            inner[child] = bodies
    for slides, run in groupby(own, key=lambda each: each.tag == "joint" and joint_type(each, classes) == "slide"):
        if slides:
            _permute(list(run), own)
    _permute([each for each in inner if each not in own], inner)
    return _least(*own.values()), _least(*inner.values())


def _least(*ranks: float | None) -> float | None:
    return min((each for each in ranks if each is not None), default=None)


def _permute(nodes: Sequence[Node], ranks: Mapping[Node, float]) -> None:
    ordered = sorted(nodes, key=lambda node: ranks.get(node, math.inf))
    if ordered == list(nodes):
        return
    marks = [etree.Comment("") for _ in nodes]
    for old, new in (*zip(nodes, marks, strict=True), *zip(marks, ordered, strict=True)):
        journal.exchange(old, new)


def why_before(unit: Unit, kind: str, first: str, second: str) -> str:
    """Return the reason that MJCF must have `first` before `second`, given the names before them."""
    found = {name: node for node, name in reversed(elements_in_order(unit, kind)) if name}
    if kind == "joint" and not first:
        return "MuJoCo numbers the joints of a body before the joints inside it, and numbers these one after the other"
    if kind != "joint":
        return (
            f"MuJoCo puts the copies that a `<replicate>` makes of {kind}s after all others, one copy after the other"
        )
    one = found[first]
    other = found[second]
    around = list(other.iterancestors())
    body = next(each for each in one.iterancestors(*_BODIES))
    inner = next(each for each in other.iterancestors(*_BODIES))
    if body is not inner and body in around:
        return (
            f"`{first}` is a joint of {_called(body)}, and `{second}` is a joint of {_called(inner)} inside it: "
            "MuJoCo numbers the joints of a body before the joints inside it"
        )
    block = one
    for each in one.iterancestors():
        if each in around:
            break
        block = each
    within = [name for name, node in reversed(found.items()) if block is node or block in node.iterancestors()]
    if body is inner:
        return (
            f"`{first}` and `{second}` move {_called(body)}: "
            "MuJoCo applies them one after the other, and a different order changes the motion"
        )
    return (
        f"`{within[0]}` and `{first}` are inside {_called(block)}, and `{second}` is not: "
        "MuJoCo numbers all joints inside it one after the other"
    )


def _called(node: Node) -> str:
    if node.tag == "worldbody":
        return "the world"
    return element_text(str(node.tag), node.get("name"), definite=True)

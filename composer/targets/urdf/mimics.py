"""Coupled joints: equality constraints of joints as `<mimic>`."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.plain.numbers import text

_HINGE_OR_SLIDE = (2, 3)


def mimics(draft: Draft, joints: dict[str, Node]) -> None:
    """Write proportional constraints as `<mimic>`. Other equality constraints are recorded as losses."""
    model = draft.model
    for number, node in list(draft.of("equality")):
        leader, follower = str(node.get("joint2") or ""), str(node.get("joint1") or "")
        polynomial = model.eq_data[number][:5]
        if node.tag != "joint" or leader not in joints or follower not in joints:
            draft.lose("equality", node, "what they couple moves freely")
        elif polynomial[2:].any():
            draft.lose("equality", node, "a joint follows another in proportion only")
        elif not model.eq_active0[number]:
            draft.lose("equality", node, "they are not active at the start, and nothing can switch them on")
        elif joints[follower].find("mimic") is not None:
            draft.lose("equality", node, "a joint follows one other")
        else:
            zero = [
                float(model.qpos0[model.jnt_qposadr[each]])
                for each in (int(model.eq_obj1id[number]), int(model.eq_obj2id[number]))
            ]
            offset = zero[0] + polynomial[0] - polynomial[1] * zero[1]
            etree.SubElement(
                joints[follower], "mimic", joint=leader, multiplier=text(polynomial[1]), offset=text(offset)
            )

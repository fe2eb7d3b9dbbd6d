"""Limit of a target in which a body has at most one joint: each further joint gets a body of its own."""

from __future__ import annotations

from lxml import etree

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome


def _split(draft: Draft) -> None:
    for body in list(draft.root.iterfind(".//body")):
        joints = list(body.iterchildren("joint"))
        holder = body.getparent()
        if len(joints) < 2 or holder is None:
            continue
        draft.mujoco_reads = False  # nothing that moves may be without a mass there
        draft.lose("joints", body, "each of its joints but the last stands in a body of its own")
        at = holder.index(body)
        pose = {"pos": str(body.get("pos")), "quat": str(body.get("quat"))}
        for joint in joints[:-1]:
            between = etree.Element("body", {"name": f"{body.get('name')}__{joint.get('name')}", **pose})
            etree.SubElement(between, "inertial", mass="0", pos="0 0 0", quat="1 0 0 0", diaginertia="0 0 0")
            between.append(joint)
            holder.insert(at, between)
            holder, at, pose = between, len(between), {"pos": "0 0 0", "quat": "1 0 0 0"}
        body.set("pos", pose["pos"])
        body.set("quat", pose["quat"])
        holder.append(body)


SINGLE_JOINTS = Limit("joints", Outcome.WRITTEN, _split)

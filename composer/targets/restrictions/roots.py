"""Limit of a target that reads one body in the world, or places it by its centre of mass: one body holds the rest."""

from __future__ import annotations

from functools import partial

from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome

NAME = "world_root"


def one_root(*, with_free: bool) -> Limit:
    """Return a limit that puts the bodies of the world into one.

    Bodies with a free joint are moved only `with_free`, because MuJoCo does not read them there.
    """
    return Limit("roots", Outcome.WRITTEN, partial(_one_root, with_free))


def _one_root(with_free: bool, draft: Draft) -> None:
    for world in draft.root.iterfind("worldbody"):
        bodies = list(world.iterchildren("body"))
        free = [body for body in bodies if _is_free(body)]
        if with_free and len(bodies) == 1 and free:
            continue
        held = bodies if with_free else [body for body in bodies if body not in free]
        if not held:
            continue
        draft.mujoco_reads &= not (with_free and free)  # MJCF has free joints at the top alone
        root = etree.SubElement(world, "body", name=NAME, pos="0 0 0", quat="1 0 0 0")
        etree.SubElement(root, "inertial", mass="0", pos="0 0 0", quat="1 0 0 0", diaginertia="0 0 0")
        root.extend(held)
        draft.lose("roots", held[0], f"the bodies of the world stand in one that is called `{NAME}`")


def _is_free(body: Node) -> bool:
    joints = body.iterchildren("joint", "freejoint")
    return any(each.tag == "freejoint" or each.get("type") == "free" for each in joints)

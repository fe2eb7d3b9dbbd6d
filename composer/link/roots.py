"""Pass: what may only stand in the world — free joints, mocap bodies — and planes, which need something static."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking, Part
from composer.link.layout import joint_type
from composer.tree.classes import childclass_of, through_frames


def roots(linking: Linking) -> None:
    """Weld what is asked to be welded; refuse what MuJoCo cannot have below a body."""
    for part in linking.parts:
        for body in list(_at_the_root(part.unit.root, "body")):
            for joint in list(_own_joints(body)):
                if joint.tag != "freejoint" and joint_type(joint, part.unit.classes) != "free":
                    continue
                if part.weld:
                    holder = joint.getparent()
                    assert holder is not None
                    holder.remove(joint)
                elif part.place.kind != "world" or part.joints or part.mocap:
                    _free_joint(linking, part, body, joint)
            if body.get("mocap") == "true" and (part.place.kind != "world" or part.joints or part.mocap):
                _mocap(linking, part, body)
        if part.place.kind != "world" or part.joints or part.mocap:
            _planes(linking, part)


def _at_the_root(root: Node, tag: str) -> Iterator[Node]:
    for worldbody in root.iterchildren("worldbody"):
        yield from (child for child in through_frames(worldbody) if child.tag == tag)


def _own_joints(body: Node) -> Iterator[Node]:
    yield from (child for child in through_frames(body) if child.tag in ("freejoint", "joint"))


def _where(part: Part) -> str:
    if part.place.kind == "world":
        return "below the joint of its own attachment"
    return f"on the {part.place.kind} `{part.place.name}`"


def _free_joint(linking: Linking, part: Part, body: Node, joint: Node) -> None:
    linking.sink.error(
        "freejoint-on-body",
        f"`{part.prefix}` has a free joint at its root and cannot hang {_where(part)}: "
        "MuJoCo allows free joints only in the world",
        part.span or linking.span(part.unit, joint),
        notes=(Note(f"the free joint of the body `{body.get('name') or ''}`", linking.span(part.unit, joint)),),
        help="fix it there with `joint: weld`, or leave the place out to let it float in the world",
    )


def _mocap(linking: Linking, part: Part, body: Node) -> None:
    linking.sink.error(
        "mocap-on-body",
        f"`{part.prefix}` has a mocap body at its root and cannot hang {_where(part)}: "
        "MuJoCo allows mocap bodies only in the world",
        part.span or linking.span(part.unit, body),
        notes=(Note(f"the mocap body `{body.get('name') or ''}`", linking.span(part.unit, body)),),
        help="attach it to the world: leave `site`, `body` and `frame` out",
    )


def _planes(linking: Linking, part: Part) -> None:
    for geom in _at_the_root(part.unit.root, "geom"):
        if part.unit.classes.effective(geom, childclass_of(geom), "type") == "plane":
            linking.planes.append((part, geom))


def check_planes(linking: Linking) -> None:
    """A plane on something that moves is refused; the mounts are known only after the parts have been hung."""
    for part, geom in linking.planes:
        if _moves(geom):
            linking.sink.error(
                "plane-on-body",
                f"`{part.prefix}` brings a plane and hangs {_where(part)}, which moves: "
                "MuJoCo allows planes only on what is static",
                part.span or linking.span(part.unit, geom),
                notes=(Note("the plane", linking.span(linking.base, geom)),),
                help="leave the plane out of the source, or attach the part to the world",
            )


def _moves(geom: Node) -> bool:
    node = geom.getparent()
    while node is not None:
        if node.tag == "body" and (node.get("mocap") == "true" or next(_own_joints(node), None) is not None):
            return True
        node = node.getparent()
    return False

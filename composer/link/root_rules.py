"""Pass: free joints and mocap bodies, which are only allowed in the world, and planes, which need a static parent."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.layout import joint_type
from composer.link.linking import Linking
from composer.link.notes import Floating
from composer.link.part import Part
from composer.tree.classes import childclass_of, through_frames
from composer.tree.unit import Unit


def roots(linking: Linking) -> None:
    """Weld the parts as requested, and record elements that MuJoCo does not allow below a body.

    `weld` takes away the free joint of a part:

    >>> from composer.link.example import after
    >>> part = '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
    >>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
    >>> after(roots, part, base, on="tool", weld=True)
    part: <worldbody><body><geom size=".1"/></body></worldbody>
    """
    for part in linking.parts:
        if part.by_itself:
            continue
        bodies = list(_bodies_at_the_root(part.unit.root))
        for body in bodies:
            for joint in list(_own_joints(body)):
                if joint.tag != "freejoint" and joint_type(joint, part.unit.classes) != "free":
                    continue
                if part.weld:
                    holder = joint.getparent()
                    assert holder is not None
                    holder.remove(joint)
                else:
                    alone = len(bodies) == 1 and floats_by_itself(part.unit)
                    linking.notes.floating.append(Floating(part, body, joint, _called(body), alone))
            if body.get("mocap") == "true":
                alone = len(bodies) == 1 and floats_by_itself(part.unit, mocap=True)
                linking.notes.floating.append(Floating(part, body, None, _called(body), alone))
        if part.place.kind != "world" or part.has_body:
            _planes(linking, part)


def check_roots(linking: Linking) -> None:
    """Refuse free joints, mocap bodies and planes below a body. Frames of the world are not bodies.

    >>> from composer.link.example import after
    >>> part = '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
    >>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
    >>> after(check_roots, part, base, on="tool")  # doctest: +ELLIPSIS
    error: `p/` has a free joint at its root...
    """
    # MuJoCo 4.0: "free joint can only be used on top level". A frame of the world is no body:
    # `<frame><body><freejoint/>…` is right, and so is a mocap body there.
    for part, body, joint, called, alone in linking.notes.floating:
        if next(body.iterancestors("body"), None) is not None:
            if joint is not None:
                _free_joint(linking, part, joint, called, alone)
            else:
                _mocap(linking, part, body, called, alone)
    for part, geom in linking.notes.planes:
        if _moves(geom):
            linking.sink.error(
                "plane-on-body",
                f"`{part.called}` brings a plane and is attached {_where(part)}, which moves: "
                "MuJoCo allows planes only on what is static",
                part.place.span or part.span or linking.span(part.unit, geom),
                notes=(Note("the plane", linking.span(linking.base, geom)),),
                help="attach the part to the world or to what does not move, or take the plane out of its file",
                subjects=(part.called,),
            )


def floats_by_itself(unit: Unit, *, mocap: bool = False) -> bool:
    """Return whether a unit is a single body with a free joint, or with `mocap` a single mocap body.

    Such a part needs no other body around it to stand freely in the world.
    """
    top = [child for worldbody in unit.root.iterchildren("worldbody") for child in through_frames(worldbody)]
    if len(top) != 1 or top[0].tag != "body":
        return False
    if mocap:
        return top[0].get("mocap") == "true"
    return any(joint_type(joint, unit.classes) == "free" for joint in _own_joints(top[0]))


def _bodies_at_the_root(root: Node) -> Iterator[Node]:
    for worldbody in root.iterchildren("worldbody"):
        yield from (child for child in through_frames(worldbody) if child.tag == "body")


def _own_joints(body: Node) -> Iterator[Node]:
    yield from (child for child in through_frames(body) if child.tag in ("freejoint", "joint"))


def _where(part: Part) -> str:
    if part.place.kind == "world":
        return f"to the body that `{_added_by(part)}` gives it"
    return f"to the {part.place.kind} `{part.place.name}`"


def _added_by(part: Part) -> str:
    return "joint" if part.joints or part.mocap else "sense"


def _called(body: Node) -> str:
    return f"body `{body.get('name')}`" if body.get("name") else "body, which has no name"


def _free_joint(linking: Linking, part: Part, joint: Node, called: str, alone: bool) -> None:
    if part.place.kind == "world":
        help = f"leave `{_added_by(part)}` out: the part floats in the world by its own free joint"
    else:
        away = (
            "`joint: free` to let it float in the world from there"
            if alone
            else f"leave `{part.place.kind}` out to let it float in the world"
        )
        help = f"write `joint: weld` to fix it there, or {away}"
    if part.joints or part.mocap:
        drop = "drop: [freejoint]" if joint.tag == "freejoint" else "drop: [{joint: NAME}]"
        help = f"write `{drop}` so that it moves by the `joint` that is added alone, or {help.removeprefix('write ')}"
    linking.sink.error(
        "freejoint-on-body",
        f"`{part.called}` has a free joint at its root and cannot be attached {_where(part)}: "
        "MuJoCo allows free joints only in the world",
        part.place.span or part.span or linking.span(part.unit, joint),
        notes=(Note(f"the free joint of {called}", linking.span(part.unit, joint)),),
        help=help,
        subjects=(part.called,),
    )


def _mocap(linking: Linking, part: Part, body: Node, called: str, alone: bool) -> None:
    linking.sink.error(
        "mocap-on-body",
        f"`{part.called}` has a mocap body at its root and cannot be attached {_where(part)}: "
        "MuJoCo allows mocap bodies only in the world",
        part.place.span or part.span or linking.span(part.unit, body),
        notes=(Note(f"the mocap {called}", linking.span(part.unit, body)),),
        help=(
            f"leave `{_added_by(part)}` out: then it is attached to the world"
            if part.place.kind == "world"
            else "write `joint: mocap` to put it into the world at the pose of that place"
            if alone
            else f"leave `{part.place.kind}` out: then it is attached to the world"
        ),
        subjects=(part.called,),
    )


def _planes(linking: Linking, part: Part) -> None:
    """Record every plane of the part that does not move in the part alone."""
    # MuJoCo 4.0 refuses `<body><joint/><geom type="plane" size="1 1 1"/></body>`: planes are "only allowed in static
    # bodies".
    root, classes = part.unit.root, part.unit.classes
    by_class = any(
        geom.get("type") == "plane"
        for section in root.iterchildren("default")
        for geom in section.iter("geom")
    )
    for worldbody in root.iterchildren("worldbody"):
        for geom in worldbody.iter("geom"):
            kind = classes.effective(geom, childclass_of(geom), "type") if by_class else geom.get("type")
            if kind == "plane" and not _moves(geom):
                linking.notes.planes.append((part, geom))


def _moves(geom: Node) -> bool:
    node = geom.getparent()
    while node is not None:
        if node.tag == "body" and (node.get("mocap") == "true" or next(_own_joints(node), None) is not None):
            return True
        node = node.getparent()
    return False

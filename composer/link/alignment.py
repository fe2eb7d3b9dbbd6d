"""Pass: `alignfree`, which aligns free bodies' frames with their inertia, becomes explicit on each free joint.

Only `<freejoint>` has the attribute `align`. If a `<joint type="free">` has other attributes that a `<freejoint>`
cannot take, the model keeps `alignfree` and all other free joints opt out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking
from composer.tree.classes import through_frames, walk_bodies
from composer.tree.unit import Unit

_OF_FREEJOINTS = frozenset({"name", "type", "group", "class"})
_INSIDE_BODIES = ("body", "flexcomp", "composite", "attach")


def alignment(linking: Linking) -> None:
    """Settle what the model says, and make what differs from it explicit; a base alone keeps what it says.

    >>> from composer.link.example import after
    >>> part = (
    ...     '<compiler alignfree="true"/>'
    ...     '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
    ... )
    >>> after(alignment, part)
    part: <worldbody><body><freejoint align="true"/><geom size=".1"/></body></worldbody>
    """
    if not linking.composed:
        return
    stubborn = [
        (unit, joint)
        for unit in linking.units
        if unit.settings.alignfree == "true"
        for joint, plain in _free_joints(unit)
        if not plain
    ]
    linking.notes.aligned = bool(stubborn)
    for unit in linking.units:
        wanted = unit.settings.alignfree == "true"
        if wanted == linking.notes.aligned:
            continue
        for joint in unit.root.iter("freejoint"):
            if joint.get("align") in (None, "", "auto"):
                joint.set("align", str(wanted).lower())
        for joint, plain in list(_free_joints(unit)):
            # MuJoCo 4.0 knows `align` on `<freejoint>` only: `<joint type="free" align="true"/>` violates the schema.
            # But a `<freejoint/>` takes no joint defaults: its armature is 0 whatever they say.
            if plain:
                _make_freejoint(joint, wanted)
            else:
                _cannot_differ(linking, unit, joint, *stubborn[0])
    # The joints of attachments hang in no tree yet, so that the walk above has not met them.
    for part in linking.parts if linking.notes.aligned else ():
        part.joints = tuple(
            replace(joint, attributes={"align": "false", **joint.attributes})
            if joint.tag == "freejoint"
            else joint
            for joint in part.joints
        )


def _free_joints(unit: Unit) -> Iterator[tuple[Node, bool]]:
    """Yield each `<joint type="free">` that MuJoCo may align, and whether a `<freejoint>` can replace it."""
    classes = unit.classes
    for joint, childclass in walk_bodies(unit.root):
        if (
            joint.tag == "joint"
            and classes.effective(joint, childclass, "type") == "free"
            and is_leaf(next(joint.iterancestors("body")))
        ):
            given = classes.get(str(joint.get("class") or childclass or "") or None).sets("joint")
            yield joint, not given and _OF_FREEJOINTS.issuperset(joint.keys())


def is_leaf(body: Node) -> bool:
    """Return whether a body has no child bodies. MuJoCo aligns only such bodies."""
    # MuJoCo 4.0 puts `<body pos="1 0 0"><freejoint align="true"/><geom pos=".1 0 0" size=".1"/></body>` at 1.1 0 0, and
    # leaves it at 1 0 0 with another `<body>` inside.
    return not any(
        child.tag in _INSIDE_BODIES or (child.tag == "replicate" and not is_leaf(child))
        for child in through_frames(body)
    )


def _make_freejoint(joint: Node, aligned: bool) -> None:
    joint.tag = "freejoint"
    for name in list(joint.attrib):
        if name not in ("name", "group"):
            del joint.attrib[name]
    joint.set("align", str(aligned).lower())


def _cannot_differ(linking: Linking, unit: Unit, joint: Node, other: Unit, of_other: Node) -> None:
    linking.sink.error(
        "compiler-setting",
        f"`alignfree` of `{other.label}` cannot be kept in a composition with `{unit.label}`: "
        "each has a free joint with settings of its own",
        linking.span(other, of_other),
        notes=(Note("it does not hold for this one", linking.span(unit, joint)),),
        help='make one of them a `<freejoint align="…"/>`',
    )

"""Pass: one `<compiler>` for the model, after the units have been rewritten to read the same under it."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link.angles import model_angle
from composer.link.inertia import MEASURED
from composer.link.limits import model_autolimits
from composer.link.linking import Linking
from composer.tree.classes import through_frames, walk_bodies
from composer.tree.unit import Unit

_FOLDERS = ("meshdir", "texturedir", "assetdir", "strippath")
_MADE_EXPLICIT = ("inertiafromgeom", "inertiagrouprange", *MEASURED)
_WHOLE_MODEL = ("fusestatic", "discardvisual")
_NO_EFFECT = ("coordinate", "usethread", "conflict")
_OF_FREEJOINTS = frozenset({"name", "type", "group", "class"})
_INSIDE_BODIES = ("body", "replicate", "flexcomp", "composite", "attach")


def check_settings(linking: Linking) -> None:
    """Refuse what cannot be kept; a base alone keeps everything it says."""
    if not linking.parts:
        return
    for unit in linking.units:
        if unit.settings.alignfree == "true":
            _align_free_joints(linking, unit)


def compiler(linking: Linking) -> None:
    """Write the base's settings once, as they now hold for every part."""
    root = linking.base.root
    written: dict[str, str] = {}
    children = []
    for element in list(root.iterchildren("compiler")):
        written.update({str(name): str(value) for name, value in element.items()})
        children.extend(list(element))
        root.remove(element)
    for name in _FOLDERS:
        written.pop(name, None)
    if linking.parts:
        for name in (*_MADE_EXPLICIT, *_NO_EFFECT, *_WHOLE_MODEL, "alignfree", "fitaabb"):
            written.pop(name, None)
        written["angle"] = model_angle(linking)
        if model_autolimits(linking) == "true":
            written.pop("autolimits", None)
    if not written and not children:
        return
    element = root.makeelement("compiler", written)
    element.extend(children)
    root.insert(0, element)


def _align_free_joints(linking: Linking, unit: Unit) -> None:
    """`alignfree` becomes `align` of each joint, which only `<freejoint>` has."""
    classes = unit.classes
    for joint, childclass in walk_bodies(unit.root):
        if joint.tag == "freejoint":
            if joint.get("align") in (None, "", "auto"):
                joint.set("align", "true")
        elif (
            joint.tag == "joint"
            and classes.effective(joint, childclass, "type") == "free"
            and _is_leaf(joint)
        ):
            given = classes.get(str(joint.get("class") or childclass or "") or None).sets("joint")
            if given or not _OF_FREEJOINTS.issuperset(joint.keys()):
                linking.sink.error(
                    "compiler-setting",
                    f"`alignfree` of `{unit.label}` cannot be kept in a composition for a joint with other settings",
                    linking.span(unit, joint),
                    help='make it a `<freejoint align="true"/>`',
                )
            else:
                joint.tag = "freejoint"
                for name in list(joint.attrib):
                    if name not in ("name", "group"):
                        del joint.attrib[name]
                joint.set("align", "true")


def _is_leaf(joint: Node) -> bool:
    """Whether nothing hangs on the joint's body; MuJoCo aligns no other."""
    body = next(joint.iterancestors("body"))
    return not any(child.tag in _INSIDE_BODIES for child in through_frames(body))

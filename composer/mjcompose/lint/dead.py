"""Rules about elements that nothing uses."""

from __future__ import annotations

from lxml.etree import _Element as Node

from mjcompose.lint.rule import ElementEdit, Finding, Found, Subject, rule
from mjcompose.mujoco.addresses import rows_of
from mjcompose.tree.names import GENERATORS, own_name

_REMOVE = ElementEdit(removes=True)


@rule("unused-class", "A default class that no element uses")
def unused_class(subject: Subject) -> Found:
    used = set(subject.names.uses.get("default", ()))

    def is_used(section: Node) -> bool:
        return any(str(each.get("class")) in used for each in section.iter("default"))

    for element in subject.root.iterfind("default//default"):
        outer = element.getparent()
        is_inside = outer is not None and outer.getparent() is not subject.root and not is_used(outer)
        if element.get("class") and not is_used(element) and not is_inside and subject.is_own(element):
            message = f"no element uses the class `{element.get('class')}`"
            yield Finding(element, message, "class", help="use it, or remove it", edit=_REMOVE)


def _unused(tag: str, user: str, summary: str) -> None:
    """Make the rule about the assets with a tag that nothing refers to."""

    def run(subject: Subject) -> Found:
        if next(subject.root.iter(*(GENERATORS - {"replicate", "flexcomp", "composite"})), None) is not None:
            return  # the other model may use them
        used = subject.names.uses.get(tag, {})
        for element in subject.root.iterfind(f"asset/{tag}"):
            name = own_name(element, "name")
            is_sky = tag == "texture" and subject.value(element, "type") == "skybox"
            if name and name not in used and subject.is_own(element) and not is_sky:
                attribute = "name" if element.get("name") else "file"
                message = f"no {user} uses the {tag} `{name}`"
                yield Finding(element, message, attribute, help="use it, or remove it", edit=_REMOVE)

    rule(f"unused-{tag}", summary)(run)


_unused("mesh", "geom", "A mesh that no geom uses")
_unused("material", "element", "A material that no geom, site, tendon or skin uses")
_unused("texture", "material", "A texture that no material uses")
_unused("hfield", "geom", "A height field that no geom uses")


@rule("unused-tendon", "A tendon that exerts no force and that nothing uses", in_mujoco=True)
def unused_tendon(subject: Subject) -> Found:
    model = subject.model
    used = subject.names.uses.get("tendon", {})
    for row in range(model.ntendon):
        element = subject.node("tendon", row)
        exerts = (
            model.tendon_limited[row]
            or model.tendon_stiffness[row].any()
            or model.tendon_damping[row].any()
            or model.tendon_frictionloss[row]
            or model.tendon_armature[row]
        )
        if element is not None and not exerts and element.get("name") not in used:
            yield Finding(element, f"{subject.name('tendon', row)} exerts no force, and nothing refers to it", "name")


@rule("dead-actuator", "An actuator that cannot exert a force", in_mujoco=True)
def dead_actuator(subject: Subject) -> Found:
    model = subject.model
    kinds = subject.mujoco
    user = {int(kinds.mjtGain.mjGAIN_USER), int(kinds.mjtGain.mjGAIN_MUSCLE)}
    for row in range(len(model.actuator_gaintype)):
        element = subject.node("actuator", row)
        if element is None or int(model.actuator_gaintype[row]) in user or int(model.actuator_plugin[row]) >= 0:
            continue
        if not model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row)].any():
            yield Finding(element, f"{subject.name('actuator', row)} has the gear 0 and moves nothing", "gear")
        elif not model.actuator_gainprm[row].any() and not model.actuator_biasprm[row].any():
            message = f"{subject.name('actuator', row)} has no gain and no bias, so it exerts no force"
            yield Finding(element, message, help="write `gainprm`, or `kp` of a position actuator")

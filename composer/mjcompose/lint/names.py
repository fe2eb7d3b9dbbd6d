"""Rules about elements that programs cannot address."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lxml.etree import _Element as Node

from mjcompose.lint.rule import ElementEdit, Finding, Found, Subject, rule
from mjcompose.tree.names import own_references

_ASSET = {"robot-asset": "OpenUSD and URDF identify each joint, link and sensor by a unique name"}
_CHARACTERS = re.compile(r"[\w./:+\-]+")


def _unnamed(subject: Subject, elements: Iterator[Node], use: str) -> Found:
    for element in elements:
        if not element.get("name"):
            yield Finding(element, f"programs {use.format(subject.called(element))}", help='write `name="…"`')


@rule("unnamed-joint", "A joint without a name, in a model that moves it", profiles=_ASSET)
def unnamed_joint(subject: Subject) -> Found:
    joints = []
    for joint in subject.each("joint", "freejoint"):
        around = {each.tag for each in joint.iterancestors()}
        joints += [joint] if "body" in around and not around & {"composite", "flexcomp", "replicate"} else []
    unnamed = [each for each in joints if not each.get("name")]
    if len(unnamed) < max(5, len(joints)):
        yield from _unnamed(subject, iter(unnamed), "reach {} only by its number")


@rule("unnamed-actuator", "An actuator without a name", profiles=_ASSET)
def unnamed_actuator(subject: Subject) -> Found:
    taken = {str(each.get("name")) for each in subject.root.iterfind("actuator/*")}
    for element in subject.root.iterfind("actuator/*"):
        joint = element.get("joint")
        if isinstance(element.tag, str) and not element.get("name"):
            edit = ElementEdit((("name", str(joint)),)) if joint and joint not in taken else None
            taken.add(str(joint))
            of = f" for joint `{joint}`" if joint else ""
            message = f"the actuator{of} has no name, so programs reach its control only by its number"
            yield Finding(element, message, help=f'write `name="{joint or "…"}"`', edit=edit)


@rule("unnamed-sensor", "A sensor without a name", profiles=_ASSET)
def unnamed_sensor(subject: Subject) -> Found:
    elements = (each for each in subject.root.iterfind("sensor/*") if isinstance(each.tag, str))
    yield from _unnamed(subject, elements, "read {} only by its address")


@rule("unnamed-key", "A keyframe without a name, in a model that has several")
def unnamed_key(subject: Subject) -> Found:
    keys = list(subject.root.iterfind("keyframe/key"))
    if len(keys) > 1:
        yield from _unnamed(subject, iter(keys), "reset to {} only by its number")


@rule("unnamed-model", "A model without a name of its own", usual=False, profiles=_ASSET)
def unnamed_model(subject: Subject) -> Found:
    if subject.is_part and not subject.root.get("model") and subject.root.find("worldbody//body") is not None:
        yield Finding(subject.root, "the model has no name", help='write `<mujoco model="…">`')


@rule("awkward-name", "A name with spaces or with characters that other programs refuse", profiles=_ASSET)
def awkward_name(subject: Subject) -> Found:
    for element in subject.root.iter("*"):
        name = element.get("name")
        is_free = element.tag in ("material", "texture", "text", "numeric", "mesh")
        if name and not is_free and not _CHARACTERS.fullmatch(str(name)):
            message = f"the name `{name}` of this {element.tag} has characters that other programs refuse"
            yield Finding(element, message, "name", help="use letters, digits and `_ . / : -`")


@rule("names-differ-by-case", "Two elements of one kind whose names differ only in capital letters")
def names_differ_by_case(subject: Subject) -> Found:
    for kind, named in subject.names.declared.items():
        seen: dict[str, str] = {}
        for name, element in named.items():
            first = seen.setdefault(name.lower(), name)
            if first != name:
                message = f"the {kind} names `{name}` and `{first}` differ only in capital letters"
                yield Finding(element, message, "name" if element.get("name") else None)


_SIDE = re.compile(r"(?:^|[_\-./:])(left|right|l|r)(?=$|[_\-./:])|(left|right)", re.IGNORECASE)


def side_of(name: str) -> str | None:
    """Return the only side that a name is about.

    >>> side_of("left_hip"), side_of("arm_r"), side_of("left_right_bar"), side_of("lift")
    ('l', 'r', None, None)
    """
    found = {(each[1] or each[2]).lower()[0] for each in _SIDE.finditer(name)}
    return found.pop() if len(found) == 1 else None


_OTHER = {"left": "right", "right": "left", "l": "r", "r": "l"}


def other_side(name: str) -> str:
    """Return the name of the counterpart on the other side.

    >>> other_side("left_hip"), other_side("FR_calf/L"), other_side("LeftKnee")
    ('right_hip', 'FR_calf/R', 'RightKnee')
    """

    def swapped(found: re.Match[str]) -> str:
        word = found[1] or found[2]
        other = _OTHER[word.lower()]
        cased = other.upper() if word.isupper() else other.capitalize() if word[0].isupper() else other
        return found[0].replace(word, cased)

    return _SIDE.sub(swapped, name)


@rule("side-mismatch", "An element named left that refers to something named right, or the other way round")
def side_mismatch(subject: Subject) -> Found:
    for section in ("actuator", "sensor", "worldbody"):
        for top in subject.root.iterfind(section):
            for element in top.iterdescendants("*"):
                side = side_of(str(element.get("name") or ""))
                if side:
                    for attribute, namespace, target, _ in own_references(element, section):
                        if namespace in ("joint", "body", "site", "geom", "mesh") and side_of(target) not in (
                            None,
                            side,
                        ):
                            message = f"{subject.called(element)} refers to the {namespace} `{target}`"
                            yield Finding(element, message, attribute)

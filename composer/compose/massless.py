"""Find joints of the recipe that move nothing with mass. MuJoCo rejects them, but names a body that is in no file."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.compose.elements import ElementBuilder
from composer.diagnostics.diagnostic import Note
from composer.document.node import locate
from composer.link import numbers
from composer.link.inertia import MEASURED, has_mass
from composer.link.linking import Linking
from composer.link.part import Part
from composer.plan.plan import AttachPart
from composer.tree.classes import own
from composer.tree.settings import Settings

# What MuJoCo expands may bring mass.
_OPAQUE = ("attach", "composite", "flexcomp")
_TOO_LITTLE = 1e-15  # mjMINVAL
_SHOWN = 3
_RULES = (*MEASURED, "inertiafromgeom", "inertiagrouprange")


def check_mass(step: AttachPart, part: Part, linking: Linking, making: ElementBuilder) -> None:
    """Report the bodies without mass. Nothing is reported if only MuJoCo knows the mass.

    MuJoCo asks for mass of what moves with the joint: the body itself, or a body that is fixed to it.
    """
    settings, default = linking.base.settings, Settings()
    if not part.joints or any(getattr(settings, name) != getattr(default, name) for name in _RULES):
        return
    if part.content is None or (body := part.content.getparent()) is None or body.tag != "body":
        return
    fixed = list(_fixed(body))
    if any(_may_have_mass(each, linking) for each in fixed):
        return
    notes = list(_reasons(fixed, linking))[:_SHOWN]
    give = f"`add: [{{to: {part.prefix}, geom: {{type: sphere, size: [0.01], mass: 1}}}}]`"
    making.sink.error(
        "mujoco-rejects",
        f"`joint` moves `{part.called}`, but nothing that is fixed to the joint has mass",
        locate(making.document, (*step.at, "joint"), key=True),
        notes=notes,
        help=f"give it mass, for example {give}, or leave `joint` out"
        if part.prefix
        else "give a body in it mass",
        subjects=(part.called,),
    )


def _reasons(fixed: list[Node], linking: Linking) -> Iterator[Note]:
    """Yield notes on the bodies that lack mass, and on those with their own joint, whose mass does not count."""
    for body in fixed[1:]:
        inertial = next(iter(own(body, "inertial")), None)
        why = "has no mass" if inertial is None else "has no mass, or no inertia"
        yield Note(
            f"{_called(body)} {why}", linking.span(linking.base, body if inertial is None else inertial)
        )
    for body in fixed:
        for child in own(body, "body"):
            for joint in own(child, "joint", "freejoint")[:1]:
                message = f"{_called(child)} moves by a joint of its own, so that its mass does not count"
                yield Note(message, linking.span(linking.base, joint))


def _called(body: Node) -> str:
    return f"the body `{body.get('name')}`" if body.get("name") else "this body"


def _fixed(body: Node) -> Iterator[Node]:
    """Yield the body, and the bodies below it that no joint moves relative to it."""
    yield body
    for child in own(body, "body"):
        # In MuJoCo 4.0 the mass of a child counts for the joint above it, unless a joint of its own stands between:
        # then "mass and inertia of moving bodies must be larger than mjMINVAL".
        if not own(child, "joint", "freejoint"):
            yield from _fixed(child)


def _may_have_mass(body: Node, linking: Linking) -> bool:
    if own(body, *_OPAQUE):
        return True
    inertials = own(body, "inertial")
    if not inertials:
        return any(has_mass(geom, linking.base.classes) for geom in own(body, "geom"))
    values = [
        number
        for name in ("mass", "diaginertia")
        for number in numbers.read(str(inertials[0].get(name) or ""))
    ]
    return inertials[0].get("fullinertia") is not None or all(number >= _TOO_LITTLE for number in values)

"""Hover for a name in a model: what the element is, its pose, and where its values come from."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.explain.text import render
from composer.link import numbers
from composer.lsp.analysis import Analysis
from composer.lsp.answers import Hover
from composer.lsp.names import Known
from composer.lsp.question import Question
from composer.lsp.subject import in_model, named_at
from composer.numerics.pose import Pose
from composer.outline.of_unit import world_of
from composer.outline.outline import Joint

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.explain.traced import Traced


def show(question: Question) -> Hover | None:
    """Return information about the element whose name is at the cursor, or None."""
    analysis = question.analysis
    for known in named_at(question):
        return Hover(describe(in_model(known, analysis), analysis), question.word)
    return None


def describe(known: Known, analysis: Analysis) -> str:
    """Return an element in Markdown: its kind, facts with their units, and what `explain` says."""
    lines = [f"**{known.tag} `{known.name}`**", ""]
    traced, node = analysis.traced, known.node
    composed = traced is not None and node is not None and node in traced.watch.lives
    lines += [f"- {fact}" for fact in _facts(known, traced if composed else None)]
    if traced is not None and composed and node is not None:
        told = render(traced.element(node)).partition("\n")[2]
        lines += ["", "```text", told, "```"]
    return "\n".join(lines)


def _facts(known: Known, traced: Traced | None) -> Iterator[str]:
    if known.part:
        yield f"part `{known.part}`"
    if known.holder:
        yield f"in body `{known.holder}`"
    if traced is None or known.node is None:
        return
    if known.namespace in ("site", "body", "frame"):
        yield from _pose(known, traced)
    if known.tag == "body":
        mass = traced.attribute(known.node, "mass").value
        yield f"mass: {mass} kg" if mass is not None else "mass: computed by MuJoCo from its geoms"
    if known.namespace == "joint":
        yield from _joint(known.node, traced)
    for name in ("ctrlrange", "forcerange"):
        if known.namespace == "actuator" and name in known.node.attrib:
            yield f"{name}: {known.node.get(name)}"


def _pose(known: Known, traced: Traced) -> Iterator[str]:
    """Yield the pose of an element in metres: in its body, and in the world at the reference configuration."""
    for body in world_of(traced.model, lambda node: None).walk():
        for place in body.places:
            if (place.kind, place.name) == (known.tag, known.name):
                if place.kind != "body":
                    yield f"in its body: {_words(place.pose)}"
                yield f"in the world: {_words(place.world)}"


def _words(pose: Pose) -> str:
    """Return a pose as text.

    >>> _words(Pose((0.1, 0.0, 0.25)))
    '[0.1, 0, 0.25] m'
    """
    pos = ", ".join(numbers.text([round(float(each), 6) + 0.0]) for each in pose.pos)
    turned = any(abs(float(each)) > 1e-9 for each in pose.quat[1:])
    quat = ", ".join(numbers.text([round(float(each), 4) + 0.0]) for each in pose.quat)
    return f"[{pos}] m" + (f", quat [{quat}]" if turned else "")


def _joint(node: Node, traced: Traced) -> Iterator[str]:
    name = node.get("name")
    for joint in (each for body in world_of(traced.model, lambda node: None).walk() for each in body.joints):
        if joint.name == name:
            yield f"{joint.type} joint{_range(joint)}"


def _range(joint: Joint) -> str:
    if joint.range is None:
        return ", no limits" if joint.type != "free" else ""
    low, high = joint.range
    if joint.type == "slide":
        return f", range [{low:.6g}, {high:.6g}] m"
    degrees = [f"{each * 180 / 3.141592653589793:.4g}" for each in joint.range]
    return f", range [{low:.6g}, {high:.6g}] rad = [{', '.join(degrees)}]°"

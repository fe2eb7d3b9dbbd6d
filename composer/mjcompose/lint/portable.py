"""Rules about elements that other programs, or older versions of MuJoCo, read differently."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from mjcompose.base.words import counted
from mjcompose.lint.rule import Finding, Found, Subject, rule

if TYPE_CHECKING:
    from mjcompose.targets.target import UnsupportedElement

_PROGRAMS = {
    "mjx": "MJX, MuJoCo in JAX",
    "warp": "MuJoCo Warp",
    "drake": "Drake",
    "newton": "Newton",
    "pinocchio": "Pinocchio",
    "pybullet": "PyBullet",
    "genesis": "Genesis",
    "isaac": "Isaac Sim",
    "urdf": "URDF",
    "ros2": "ROS 2",
}
"""By the target of mjcompose, the name in summaries."""


def _rule(name: str, title: str) -> Callable[[Subject], Found]:
    def run(subject: Subject) -> Found:
        from mjcompose.targets.table import TARGETS

        refusing = [limit.refuses for limit in TARGETS[name].limits if limit.refuses is not None]
        for refuses in refusing:
            by_reason: dict[str, list[UnsupportedElement]] = {}
            for each in refuses(subject.mujoco, subject.model):
                by_reason.setdefault(each.why, []).append(each)
            for why, (first, *others) in by_reason.items():
                node = subject.node(first.kind, first.number)
                if first.kind == "option":
                    node = next(subject.root.iterfind("option"), None)
                yield Finding(node, f"{why}, and {counted(len(others), 'more such element')}" if others else why)
        if not refusing:
            yield from _losses(subject, name)

    summary = f"Something in the model that {title} does not have"
    return rule(f"unread-by-{name}", summary, in_mujoco=True, usual=False)(run)


def _losses(subject: Subject, name: str) -> Found:
    """Yield the elements that a program ignores or refuses, one kind at a time."""
    from mjcompose.targets.plain import without_classes, without_frames
    from mjcompose.targets.table import TARGETS
    from mjcompose.targets.target import Draft, FeatureOutcome, grouped, in_words

    root = copy.deepcopy(subject.root)
    original = dict(zip(root.iter("*"), subject.root.iter("*"), strict=True))
    back = {original[node]: node for node in original}
    without_classes(root)
    without_frames(root)
    for element in root.iter("joint", "geom"):  # as MuJoCo saves them
        element.set("type", element.get("type") or ("hinge" if element.tag == "joint" else "sphere"))
    rows: dict[str, dict[int, Node]] = {}
    for (kind, row), node in subject.nodes.items():
        rows.setdefault(kind, {})[row] = back[node]
    elements: dict[str, list[Node]] = {"geom": [], "joint": []}
    elements |= {
        kind: [by_row[row] for row in range(subject.roster.count(kind))]
        if len(by_row) == subject.roster.count(kind)
        else []
        for kind, by_row in rows.items()
    }
    draft = Draft(subject.mujoco, subject.model, root, files={}, elements=elements)
    for limit in TARGETS[name].limits:
        if limit.outcome not in (FeatureOutcome.WRITTEN, FeatureOutcome.KEPT):
            limit.apply(draft)
    places = {row: node for node, row in draft.rows.items()}
    for group in grouped(draft.losses):
        place = places.get((group[0].kind, group[0].number))
        yield Finding(None if place is None else original[place], in_words(TARGETS[name].title, group))


for _name, _title in _PROGRAMS.items():
    _rule(_name, _title)


@rule("newer-mujoco", "An element or attribute that older versions of MuJoCo do not read", usual=False)
def newer_mujoco(subject: Subject) -> Found:
    from mjcompose.tree.history import unread

    for each in unread(subject.root, "3.0.0"):
        yield Finding(each.node, f"{each.called}: {each.when()}", each.attribute)

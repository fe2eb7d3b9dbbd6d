"""Outline a model that was read or composed, without compiling it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from composer.compiled.joints import BY_WORD
from composer.link import numbers
from composer.link.bodies import effective_pose
from composer.link.layout import joint_type
from composer.link.placing import read_pose
from composer.numerics.pose import Pose
from composer.outline.outline import Body, Joint, Place
from composer.tree.effective import text_in_effect
from composer.tree.kinds import kind_of
from composer.tree.names import WORLD
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

PartOf = Callable[["Node"], str | None]
_TRANSPARENT = ("frame", "replicate")
_JOINTS = ("joint", "freejoint")


def world_of(unit: Unit, part_of: PartOf) -> Body:
    """Return the world with all bodies below it; `part_of` returns the part of an element by its name in the recipe."""
    return _Outliner(unit, part_of).world()


class _Outliner:
    def __init__(self, unit: Unit, part_of: PartOf) -> None:
        self.unit, self.part_of = unit, part_of
        self.degrees, self.sequence = unit.settings.angle == "degree", unit.settings.eulerseq

    def world(self) -> Body:
        worlds = list(self.unit.root.iterchildren("worldbody"))
        joints, places, children = self.contents(worlds, Pose(), 1)
        return Body(WORLD, None, joints, places=places, children=children)

    def body(self, node: Node, outside: Pose, copies: int) -> Body:
        """Return a body; `outside` is the pose of its parent in the world."""
        name = node.get("name")
        pose = outside @ self.pose(node)
        joints, places, children = self.contents([node], pose, copies)
        own = (Place("body", str(name), Pose(), world=pose),) if name else ()
        return Body(
            None if not name else str(name),
            self.part_of(node),
            joints,
            places=(*own, *places),
            children=children,
            copies=copies,
        )

    def contents(
        self, holders: list[Node], world: Pose, copies: int
    ) -> tuple[tuple[Joint, ...], tuple[Place, ...], tuple[Body, ...]]:
        joints: list[Joint] = []
        places: list[Place] = []
        children: list[Body] = []
        for node, inside, times in self.members(holders, Pose(), copies):
            if node.tag in _JOINTS:
                joints.append(self.joint(node))
            elif node.tag == "body":
                children.append(self.body(node, world @ inside, times))
            elif node.tag in ("site", "frame") and node.get("name"):
                pose = inside @ self.pose(node)
                places.append(Place(str(node.tag), str(node.get("name")), pose, world=world @ pose))
        return tuple(joints), tuple(places), tuple(children)

    def members(self, holders: list[Node], pose: Pose, copies: int) -> Iterator[tuple[Node, Pose, int]]:
        """Yield the contents of bodies, including frames, with the pose of their parent and the number of copies."""
        for holder in holders:
            for node in holder.iterchildren("*"):
                yield node, pose, copies
                if node.tag in _TRANSPARENT:
                    inner = pose @ self.pose(node) if node.tag == "frame" else pose
                    count = int(node.get("count") or 1) if node.tag == "replicate" else 1
                    yield from self.members([node], inner, copies * count)

    def joint(self, node: Node) -> Joint:
        name = str(node.get("name")) if node.get("name") else None
        type = "free" if node.tag == "freejoint" else joint_type(node, self.unit.classes)
        return Joint(name, type, None if type == "free" else self.range(node, type))

    def range(self, node: Node, type: str) -> tuple[float, float] | None:
        """Return the limits in effect: `limited` decides, and if it is not set, whether a range is written."""
        kind, classes = kind_of(node), self.unit.classes
        text = text_in_effect(node, kind, "range", classes=classes)
        limited = text_in_effect(node, kind, "limited", classes=classes) or "auto"
        if limited == "false" or (limited == "auto" and self.unit.settings.autolimits == "false"):
            return None
        numbers_of = numbers.read(str(text or ""))
        if len(numbers_of) != 2 or numbers_of[0] >= numbers_of[1]:
            return None
        low, high = numbers_of
        if self.degrees and BY_WORD[type].range_unit == "rad":
            low, high = numbers.joint_radians(low), numbers.joint_radians(high)
        return low, high

    def pose(self, node: Node) -> Pose:
        """Return the pose in the parent; for a site, including values from its classes."""
        attributes = effective_pose(node, self.unit.classes) if node.tag == "site" else node
        return read_pose(attributes, self.degrees, self.sequence)

"""The reference configuration of the finished model, which fills the values that a key does not give."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cached_property

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.angles import model_angle
from composer.link.layout import BLOCK, Holder, Layout, Slot
from composer.link.linking import Linking
from composer.link.multiplied import Copy, Within, element_of
from composer.link.placing import pose_in_world, read_pose
from composer.numerics.pose import Pose
from composer.tree.classes import childclass_of, written
from composer.tree.key_number import KeySource, Number, texts

_IDENTITY = "1 0 0 0".split()


class Reference:
    """Makes rows of keys and fills the missing values from the reference configuration."""

    def __init__(self, linking: Linking) -> None:
        self.linking = linking
        self.disagreeing: list[tuple[str, Node]] = []
        self.lost: list[tuple[str, Node]] = []
        self.sequence = linking.base.settings.eulerseq

    @cached_property
    def degrees(self) -> bool:
        return model_angle(self.linking) == "degree"

    @cached_property
    def class_refs(self) -> bool:
        return self.linking.base.classes.give("joint", "ref")

    def row(
        self, vector: str, layout: Layout, values: Mapping[Holder, list[Number]], void: Collection[Node]
    ) -> list[Number]:
        """Return all numbers of a vector. `values` are those that a key sets; those of `void` mean nothing now."""
        row: list[Number] = []
        found = self._found(vector, values)
        if vector in ("mpos", "mquat"):
            for body in layout.mocaps:
                poses = self.linking.keys.mocap_references.get(body) or [self._pose(element_of(body))]
                text = [number for pose in poses for number in (pose.pos if vector == "mpos" else pose.quat)]
                said = found(body) or []
                row += [*said, *_by_nobody(vector, numbers.text(text).split())[len(said) :]]
            return row
        # Numbers still mean something if neither their holder's meaning nor its width has been edited.
        second = vector in ("qvel", "act")
        for holder, slot in (layout.joints if vector in ("qpos", "qvel") else layout.actuators).items():
            width, given = slot.widths[second], found(holder)
            element = element_of(holder)
            if given is None or len(given) != width or element in void:
                # Of actuators `convert` says what is lost.
                if vector in ("qpos", "qvel") and given and any(numbers.read(" ".join(texts(given)))):
                    self.lost.append((vector, element))
                default = self._qpos(holder, slot) if vector == "qpos" else ["0"] * width
                given = _by_nobody(vector, default, given)
            row += given
        return row

    def _found(
        self, vector: str, values: Mapping[Holder, list[Number]]
    ) -> Callable[[Holder], list[Number] | None]:
        """Return a function for the numbers that a key has for a holder, also if it has another number of copies now.

        Every copy that a replicate makes of a part has the numbers of the part. Copies that are one element now must
        agree: those that do not are noted in `disagreeing`.
        """
        others: dict[tuple[Node, bool], list[tuple[Within, list[Number]]]] = {}

        def found(holder: Holder) -> list[Number] | None:
            if holder in values:
                return values[holder]
            if not others:
                for each, row in values.items():
                    own = each if isinstance(each, Copy) else Copy(each)
                    others.setdefault((own.element, own.twists), []).append((own.within, row))
            now = holder if isinstance(holder, Copy) else Copy(holder)
            inside = dict(now.within)
            rows = [
                row
                for within, row in others.get((now.element, now.twists), ())
                if all(inside.get(replicate, number) == number for replicate, number in within)
            ]
            if any(texts(row) != texts(rows[0]) for row in rows[1:]):
                self.disagreeing.append((vector, now.element))
            return rows[0] if rows else None

        return found

    def _qpos(self, holder: Holder, slot: Slot) -> list[str]:
        measured = self.linking.keys.references.get(holder)
        if measured is not None:
            return measured
        joint = element_of(holder)
        # A free joint starts where its body stands in the world: in `<frame pos="1 0 0">` at 1 0 0 1 0 0 0.
        if slot.kind == "free":
            body = joint.getparent()
            while body is not None and body.tag != "body":
                body = body.getparent()
            if body is not None:
                pose = self._pose(body)
                return numbers.text([*pose.pos, *pose.quat]).split()
        if slot.kind == BLOCK:
            return ["0"] * slot.widths[0]
        if slot.kind == "ball":
            return _IDENTITY
        ref = written(joint, "ref")
        if ref is None and self.class_refs:
            ref = self.linking.base.classes.effective(joint, childclass_of(joint), "ref")
        if ref is None:
            return ["0"]
        value = numbers.read(ref)[0]
        if slot.kind == "hinge" and self.degrees:
            value = numbers.joint_radians(value)
        return numbers.text([value]).split()

    def _pose(self, body: Node) -> Pose:
        outer = body.getparent()
        inner = read_pose(body, self.degrees, self.sequence)
        return inner if outer is None else pose_in_world(outer, self.degrees, self.sequence) @ inner


def emptied(values: Mapping[str, dict[Holder, list[Number]]], void: Collection[Node]) -> None:
    """Empty the numbers of a key that an edit has made meaningless, and note what they were."""
    for vector, columns in values.items():
        for holder, row in columns.items():
            if element_of(holder) in void:
                columns[holder] = _by_nobody(vector, ["0"] * len(row), row)


def _by_nobody(vector: str, default: list[str], lost: list[Number] | None = None) -> list[Number]:
    """Return the numbers that no key sets, or that have `lost` their meaning by an edit."""
    first = lost[0] if lost else None
    source = KeySource(
        "reference" if vector in ("qpos", "mpos", "mquat") else "zero",
        vector,
        lost=first and (first.source.lost or first),
    )
    return [Number(text, source, at) for at, text in enumerate(default)]

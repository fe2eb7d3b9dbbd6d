"""The frame between a model and the model it is attached to."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import cast

from lxml.etree import _Element as Node

from mjcompose.mjcf import edit
from mjcompose.mjcf.attributed import targets, view
from mjcompose.mjcf.element import Element, RootElement
from mjcompose.mjcf.errors import failure
from mjcompose.mjcf.model import AttachedModel, ReferencedNode
from mjcompose.mjcf.node_view import checked
from mjcompose.mjcf.value import is_here
from mjcompose.tree.classes import ORIENTATIONS, Classes, childclass_of, through_frames

_OF_FRAMES = frozenset({"pos", *ORIENTATIONS, "mocap"})
_JOINTS = ("joint", "freejoint")


class AttachmentFrame(Element):
    """The body called `PREFIX/` between a model and the model it is attached to.

    It belongs to the parent. Its `pos` and orientation are the offset from the place of attachment (meters,
    and the parent's unit of angle). `add('joint', …)` lets the child move. A joint called `name` is
    `PREFIX/name` in the output, one without a name is `PREFIX/`. With a free joint, or as a `mocap` body,
    the child is in the world at the pose that the place has in the reference configuration. Without any
    of these no body is written.
    """

    __slots__ = ()

    @property
    def parent(self) -> Element | None:
        """The body, frame or worldbody that contains the child in the output."""
        return cast(Element, view(self._model, self._alive()._attachment.container))

    def __repr__(self) -> str:
        return self._named(super().__repr__())

    def __str__(self) -> str:
        return self._named(super().__str__())

    def _own_name(self) -> str | None:
        return None if self._removed else self._attachment.child.prefix

    def _named(self, text: str) -> str:
        name = self._own_name()
        return text if name is None else text.replace("<body", f'<body name="{escape(name)}"', 1)

    @property
    def _attachment(self) -> AttachedModel:
        return self._model.attachment_of(self._node)

    def _add(self, tag: str, position: int | None, attributes: Mapping[str, object]) -> Element:
        self._alive()
        if tag not in _JOINTS:
            help = "add it to the attached model, or to the body that the model is attached to"
            raise failure("unknown-element", f"an attachment frame takes joints, got `{tag}`", help=help)
        free = [joint for joint in self._node if _is_free(joint)]
        if free or (len(self._node) and (tag == "freejoint" or attributes.get("type") == "free")):
            notes = (is_here(ReferencedNode(self._model, free[0] if free else self._node[0])),)
            raise failure("name-clash", "a free joint must be the only joint of a frame", notes=notes)
        kind = self._child_kind(tag)
        self._check_body_name()
        checked = edit.check(self._model, kind, targets(attributes), frame=self._attachment)
        made = edit.create(self._model, self._node, tag, edit=checked, position=position)
        return cast(Element, view(self._model, made))

    def _write(self, attributes: Mapping[str, object]) -> None:
        for name in attributes:
            if name not in _OF_FRAMES and name in self._kind.attributes:
                help = "it has `pos`, one orientation, and `mocap`; its name is the child's `model`"
                raise failure("unknown-attribute", f"an attachment frame has no `{name}` of its own", help=help)
        if attributes.get("mocap") not in (None, False, "false"):
            self._check_body_name()
        super()._write(attributes)

    def _check_body_name(self) -> None:
        """Raise `MjcfError` if another body already has the prefix as its name, which the frame needs as a body."""
        attachment = self._attachment
        model = self._model
        name = attachment.child.prefix
        taken = None if attachment.is_body else model.top.lookup("body", model.full_prefix + name)
        if taken is not None:
            help = "rename it, or rename the attached model: `other.model = '…'`"
            message = f"another body is already called `{name}`, as the frame would be"
            raise failure("name-clash", message, notes=(is_here(taken),), help=help)

    def remove(self, cascade: bool = False) -> None:
        """Raise `MjcfError`: an attachment frame cannot be removed. Call `detach()` on the child instead."""
        raise failure("not-supported", "an attachment frame is removed with its model: `detach()` the model")

    def attach(self, other: RootElement) -> Element:
        """Raise `MjcfError`: attach models to an element of the parent or of the child instead."""
        raise failure("attach-place", "an attachment frame takes joints, not models")


def get_attachment_frame(element: Element) -> AttachmentFrame | None:
    """Return the frame that attaches an element's model to its parent, or None if the model is not attached.

    `element` is a `RootElement` or any element of its model.

    >>> from mjcompose import mjcf
    >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
    >>> frame = arm.attach(gripper)
    >>> mjcf.get_attachment_frame(gripper) is mjcf.get_attachment_frame(gripper.worldbody) is frame
    True
    """
    model = checked(element)._model
    if model.hung is None:
        return None
    return cast(AttachmentFrame, view(model.hung.parent, model.hung.frame))


def get_frame_joints(frame: Element) -> list[Element]:
    """Return the joints of an attachment frame, given the frame or any element of the attached model.

    The list is empty if the model is not attached.

    >>> from mjcompose import mjcf
    >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
    >>> turn = arm.attach(gripper).add('joint', name='turn')
    >>> mjcf.get_frame_joints(gripper) == [turn]
    True
    """
    found = frame if isinstance(frame, AttachmentFrame) else get_attachment_frame(frame)
    return [] if found is None else found.all_children()


def get_frame_freejoint(frame: Element) -> Element | None:
    """Return the free joint of an attachment frame, or None if it has none.

    `frame` is the frame or any element of the attached model.

    >>> from mjcompose import mjcf
    >>> scene, mug = mjcf.RootElement('scene'), mjcf.RootElement('mug')
    >>> free = scene.attach(mug).add('freejoint')
    >>> mjcf.get_frame_freejoint(mug) is free
    True
    """
    return next((joint for joint in get_frame_joints(frame) if _is_free(joint._node)), None)


def get_freejoint(body: Element) -> Element | None:
    """Return the free joint of a body, or None if it has none.

    It finds a `<freejoint>` as well as a `<joint>` with the type `free`, which may come from a default class. It also
    looks inside the `<frame>`s of the body.

    >>> from mjcompose import mjcf
    >>> mug = mjcf.RootElement().worldbody.add('body', name='mug')
    >>> mjcf.get_freejoint(mug) is None
    True
    >>> free = mug.add('joint', type='free')
    >>> mjcf.get_freejoint(mug) is free
    True
    """
    model = checked(body)._model
    classes = Classes(body._model.unit.root)
    for joint in through_frames(body._node):
        is_free = joint.tag == "joint" and classes.effective(joint, childclass_of(joint), "type") == "free"
        if joint.tag == "freejoint" or is_free:
            return cast(Element, view(model, joint))
    return None


def _is_free(joint: Node) -> bool:
    return joint.tag == "freejoint" or joint.get("type") == "free"

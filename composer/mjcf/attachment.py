"""Models on models: attaching, detaching, and the frame between the two."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, cast

from lxml import etree
from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.mjcf import edit
from composer.mjcf.attributed import targets
from composer.mjcf.bones import for_prefix, take
from composer.mjcf.call_site import call_site
from composer.mjcf.element import HOSTS, Element, checked
from composer.mjcf.errors import failure
from composer.mjcf.model import Attachment, Model, Target
from composer.mjcf.reference import describe
from composer.mjcf.removal import release
from composer.mjcf.views import view
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, through_frames
from composer.tree.kinds import kind_of
from composer.tree.name_index import SEPARATOR
from composer.tree.renaming import Renaming

if TYPE_CHECKING:
    from composer.mjcf.root import RootElement

_OF_FRAMES = frozenset({"pos", *ORIENTATIONS, "mocap"})
_JOINTS = ("joint", "freejoint")


class AttachmentFrame(Element):
    """The body called `PREFIX/` between a model and the one it hangs on.

    It belongs to the parent. Its `pos` and orientation are the offset from the place of attachment (metres,
    and the parent's unit of angle); `add('joint', …)` lets the child move: a joint called `name` is
    `PREFIX/name` in the output, one without a name is `PREFIX/`. With a free joint, or as a `mocap` body,
    the child stands in the world at the pose that the place has in the reference configuration. Without any
    of these no body is written.
    """

    __slots__ = ()

    @property
    def parent(self) -> Element | None:
        """The body, frame or worldbody below which the child stands."""
        attachment = self._alive()._attachment
        return view(self._model, attachment.container)

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
    def _attachment(self) -> Attachment:
        return self._model.attachment_of(self._node)

    def _add(self, tag: str, position: int | None, attributes: Mapping[str, object]) -> Element:
        self._alive()
        if tag not in _JOINTS:
            raise failure(
                "unknown-element",
                f"an attachment frame takes joints, got `{tag}`",
                call_site(),
                help="add it to the attached model, or to the body that the model is attached to",
            )
        free = [joint for joint in self._node if _is_free(joint)]
        if free or (len(self._node) and (tag == "freejoint" or attributes.get("type") == "free")):
            there = free[0] if free else self._node[0]
            raise failure(
                "name-clash",
                "a free joint must be the only joint of a frame",
                call_site(),
                notes=(Note(f"{describe(self._model, there)} is here", self._model.span(there)),),
            )
        kind = self._child_kind(tag)
        self._check_body_name()
        checked = edit.check(self._model, kind, targets(attributes), frame=self._attachment)
        return view(self._model, edit.create(self._model, self._node, tag, checked, position))

    def _write(self, attributes: Mapping[str, object]) -> None:
        for name in attributes:
            if name not in _OF_FRAMES and name in self._kind.attributes:
                raise failure(
                    "unknown-attribute",
                    f"an attachment frame has no `{name}` of its own",
                    call_site(),
                    help="it has `pos`, one orientation, and `mocap`; its name is the child's `model`",
                )
        if attributes.get("mocap") not in (None, False, "false"):
            self._check_body_name()
        super()._write(attributes)

    def _check_body_name(self) -> None:
        """A frame that becomes a body takes the bare prefix as its name, which must be free."""
        attachment, model = self._attachment, self._model
        name = attachment.child.prefix
        taken = None if attachment.is_body else model.top.lookup("body", model.full_prefix + name)
        if taken is not None:
            raise failure(
                "name-clash",
                f"another body is called `{name}` already, as the frame would be",
                call_site(),
                notes=(Note(f"{describe(taken.model, taken.node)} is here", taken.model.span(taken.node)),),
                help="give it another name, or the attached model: `other.model = '…'`",
            )

    def remove(self, cascade: bool = False) -> None:
        """Not possible: `detach()` the child instead."""
        raise failure(
            "not-supported", "an attachment frame goes with its model: `detach()` that", call_site()
        )

    def attach(self, other: RootElement) -> Element:
        """Not possible: attach to something of the parent or of the child."""
        raise failure("attach-place", "an attachment frame takes joints, not models", call_site())


def attach(model: Model, host: Node, other: RootElement) -> Element:
    """See `Element.attach`."""
    from composer.mjcf.root import RootElement

    if not isinstance(other, RootElement):
        raise failure(
            "wrong-type", f"what is attached is a `RootElement`, got `{type(other).__name__}`", call_site()
        )
    place = describe(model, host)
    if kind_of(host).path not in HOSTS or model.frame_above(host) is not None:
        raise failure(
            "attach-place",
            f"nothing can be attached to {place}",
            call_site(),
            help="attach to a site, a body, a frame or the worldbody",
        )
    if any(above.tag == "replicate" for above in host.iterancestors()):
        raise failure(
            "not-supported", f"{place} is inside a `<replicate>`, where nothing can be attached", call_site()
        )
    child = other._model
    if child is model or child in model.ancestors():
        message = f"`{child.name}` cannot be attached to itself" if child is model else (
            f"`{child.name}` cannot be attached to {place}, which is part of it"
        )  # fmt: skip
        raise failure("attach-cycle", message, call_site())
    if child.hung is not None:
        there = child.hung
        raise failure(
            "attach-place",
            f"`{child.name}` is attached already, to {describe(there.parent, there.host)} of "
            f"`{there.parent.name}`",
            call_site(),
            notes=(Note("it was attached here", there.parent.span(there.frame)),),
            help="`detach()` it first, or attach a copy: `copy.deepcopy(model)`",
        )
    _check_prefix(model, child, child.name)
    frame = etree.Element("body")
    attachment = Attachment(model, child, host, frame)
    model.attachments[child.prefix] = attachment
    child.hung = attachment
    model.unit.origins.own(frame, call_site())
    element = AttachmentFrame(model, frame)
    model.views[frame] = element
    return element


def detach(child: Model) -> None:
    """See `RootElement.detach`."""
    if child.hung is None:
        raise failure("attach-place", f"`{child.name}` is not attached to anything", call_site())
    release(child.hung.parent, child.prefix)


def set_model_name(model: Model, name: str | None) -> None:
    """Give a model another name; where it is attached, every reference from above follows the new prefix."""
    written = edit.check(model, kind_of(model.unit.root), {"model": name})
    attachment = model.hung
    old = model.prefix
    if attachment is not None:
        _check_prefix(attachment.parent, model, name or model.unit.label, itself=model)
    text = written.texts["model"]
    if attachment is not None:
        new = (text or model.unit.label) + SEPARATOR
        renaming = Renaming.of_prefix(attachment.parent, old, new)
        edit.check_lists(renaming)
        skins = for_prefix(attachment.parent, old, new) if new != old else []
    if text is None:
        edit.drop(model.unit.root, "model")
    else:
        model.unit.root.set("model", text)
    if attachment is None or model.prefix == old:
        return
    take(skins)
    parent = attachment.parent
    parent.attachments = {each.child.prefix: each for each in parent.attachments.values()}
    renaming.carry_out()


def _check_prefix(model: Model, child: Model, name: str, itself: Model | None = None) -> None:
    """Two models on one cannot have one prefix, and no name of the one may be taken by names of the other."""
    prefix = f"{name}/"
    taken = model.attachments.get(prefix)
    if taken is not None and taken.child is not itself:
        raise failure(
            "name-clash",
            f"a model called `{name}` is attached to `{model.name}` already",
            call_site(),
            notes=(Note("it was attached here", model.span(taken.frame)),),
            help="give one of the two another name first: `other.model = '…'`",
        )
    full = prefix
    for here in (model, *model.ancestors()):
        for namespace, names in here.names.declared.items():
            for known, node in names.items():
                if not known.startswith(full):
                    continue
                rest = known[len(full) :]
                found = child.lookup_attached(namespace, rest)
                if found is None and child.hung is not None:
                    between = child.hung.find(namespace, rest)
                    found = None if between is None else Target(child.hung.parent, between)
                if found is not None:
                    raise failure(
                        "name-clash",
                        f"there is a {namespace} `{known}` in `{here.name}`, which would have two",
                        call_site(),
                        notes=(
                            Note("one is here", here.span(node)),
                            Note("the other is here", found.model.span(found.node)),
                        ),
                        help="give one of the two another name, or the model: `other.model = '…'`",
                    )
        full = here.prefix + full


def get_attachment_frame(element: Element) -> AttachmentFrame | None:
    """The frame through which an element's model hangs on its parent; None where it is not attached.

    Takes an attached `RootElement` or any element in it.

    >>> from composer import mjcf
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
    """The joints of an attachment frame; takes the frame or anything in the attached model.

    >>> from composer import mjcf
    >>> arm, gripper = mjcf.RootElement('arm'), mjcf.RootElement('gripper')
    >>> turn = arm.attach(gripper).add('joint', name='turn')
    >>> mjcf.get_frame_joints(gripper) == [turn]
    True
    """
    found = frame if isinstance(frame, AttachmentFrame) else get_attachment_frame(frame)
    return [] if found is None else found.all_children()


def get_frame_freejoint(frame: Element) -> Element | None:
    """The free joint of an attachment frame, or None; takes the frame or anything in the attached model.

    >>> from composer import mjcf
    >>> scene, mug = mjcf.RootElement('scene'), mjcf.RootElement('mug')
    >>> free = scene.attach(mug).add('freejoint')
    >>> mjcf.get_frame_freejoint(mug) is free
    True
    """
    return next((joint for joint in get_frame_joints(frame) if _is_free(joint._node)), None)


def get_freejoint(body: Element) -> Element | None:
    """The free joint of a body, however it is written, or None; frames in the body are looked through.

    >>> from composer import mjcf
    >>> mug = mjcf.RootElement().worldbody.add('body', name='mug')
    >>> mjcf.get_freejoint(mug) is None
    True
    >>> free = mug.add('joint', type='free')
    >>> mjcf.get_freejoint(mug) is free
    True
    """
    model, node = checked(body)._model, body._node
    joints = [child for child in through_frames(node) if child.tag in _JOINTS]
    classes = Classes(model.unit.root) if any(joint.tag == "joint" for joint in joints) else None
    for joint in joints:
        if joint.tag == "freejoint" or (
            classes is not None and classes.effective(joint, childclass_of(joint), "type") == "free"
        ):
            return view(model, joint)
    return None


def attachments_below(model: Model) -> Iterator[Attachment]:
    """Every attachment of a composition, each before those of its child."""
    for attachment in model.attachments.values():
        yield attachment
        yield from attachments_below(attachment.child)


def _is_free(joint: Node) -> bool:
    return joint.tag == "freejoint" or joint.get("type") == "free"

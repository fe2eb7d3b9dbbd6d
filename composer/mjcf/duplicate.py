"""Copies of models, attachments included."""

from __future__ import annotations

import copy

from composer.mjcf.attachment import AttachmentFrame
from composer.mjcf.model import Attachment, Model
from composer.mjcf.root import RootElement
from composer.tree.counterpart import counterpart


def duplicate(model: Model) -> Model:
    """A model of its own with copies of everything attached; it hangs on nothing."""
    twin = Model(model.unit.copied())
    RootElement._of(twin)
    for attachment in model.attachments.values():
        child = duplicate(attachment.child)
        frame = copy.deepcopy(attachment.frame)
        host = counterpart(attachment.host, model.unit.root, twin.unit.root)
        child.hung = twin.attachments[child.prefix] = Attachment(twin, child, host, frame)
        twin.views[frame] = AttachmentFrame(twin, frame)
        twin.unit.origins.owners.update(model.unit.origins.carried(attachment.frame, frame).owners)
        for joint in frame:
            twin.note(joint)
    return twin

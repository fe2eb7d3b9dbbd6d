"""Copy models, including their attachments."""

from __future__ import annotations

import copy
from typing import Any

from composer.mjcf.attributed import Attributed
from composer.mjcf.model import Attachment, Model
from composer.mjcf.views import view
from composer.tree.counterpart import counterpart


def duplicate(model: Model, memo: dict[int, Any] | None = None) -> Model:
    """A model of its own with copies of everything attached; it hangs on nothing.

    `memo` takes up what became of each root.
    """
    twin = Model(model.unit.copied())
    if memo is not None:
        memo[id(view(model, model.unit.root))] = view(twin, twin.unit.root)
    for attachment in model.attachments.values():
        child = duplicate(attachment.child, memo)
        frame = copy.deepcopy(attachment.frame)
        host = counterpart(attachment.host, model.unit.root, twin.unit.root)
        child.hung = twin.attachments[child.prefix] = Attachment(twin, child, host, frame)
        twin.unit.origins.owners.update(model.unit.origins.carried(attachment.frame, frame).owners)
        for joint in frame:
            twin.note(joint)
    return twin


def copied(element: Attributed, memo: dict[int, Any]) -> Any:
    """The element that stands for one in the copy of its model, which is made unless `memo` has it."""
    model = element._alive()._model
    twin = copy.deepcopy(view(model, model.unit.root), memo)._model
    frame = model.frame_above(element._node)
    if frame is None:
        return view(twin, counterpart(element._node, model.unit.root, twin.unit.root))
    there = twin.attachments[model.attachment_of(frame).child.prefix].frame
    return view(twin, counterpart(element._node, frame, there))

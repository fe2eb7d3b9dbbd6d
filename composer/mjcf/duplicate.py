"""Copy models, including their attachments."""

from __future__ import annotations

import copy
from typing import Any

from composer.mjcf.attributed import Attributed
from composer.mjcf.model import Attachment, Model
from composer.mjcf.views import view
from composer.tree.counterpart import counterpart


def duplicate(model: Model, memo: dict[int, Any] | None = None) -> Model:
    """Return a copy of a model with copies of everything attached. The copy is not attached to anything.

    `memo` receives the copy of each root, as in `copy.deepcopy`.
    """
    twin = Model(model.unit.copied())
    if memo is not None:
        memo[id(view(model, model.unit.root))] = view(twin, twin.unit.root)
    for (node, attribute), awaited in model.awaited.items():
        if model.has(node) and model.frame_above(node) is None:
            twin.awaited[counterpart(node, model.unit.root, twin.unit.root), attribute] = awaited
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
    """Return the element's counterpart in the copy of its model. The model is copied unless `memo` has the copy."""
    model = element._alive()._model
    twin = copy.deepcopy(view(model, model.unit.root), memo)._model
    frame = model.frame_above(element._node)
    if frame is None:
        return view(twin, counterpart(element._node, model.unit.root, twin.unit.root))
    there = twin.attachments[model.attachment_of(frame).child.prefix].frame
    return view(twin, counterpart(element._node, frame, there))

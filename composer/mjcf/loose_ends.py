"""References to nothing, looked up in the whole composition."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import closest, exists_note
from composer.link.names import may_be_generated
from composer.mjcf.model import Model
from composer.mjcf.reference import describe
from composer.tree.kinds import section_of, spoken

_SHOWN = 20


def check_references(model: Model, sink: Sink) -> None:
    """One error for each name that is referred to and that nothing has, with everyone who refers to it.

    References in default classes do not count as long as nothing takes them. A name that MuJoCo may make
    itself, as the copies of a `replicate`, is let through.
    """
    for namespace, uses in model.names.uses.items():
        declared = model.names.declared.get(namespace, {})
        for name, users in uses.items():
            if name in declared or model.lookup(namespace, name) is not None:
                continue
            heeded = [use for use in users if section_of(use[0]) != "default"]
            if not heeded or namespace == "key" or _may_be_generated(model, name):
                continue
            notes = [
                Note(f"{describe(model, node)} refers to it by `{spoken(attribute)}`", model.span(node))
                for node, attribute in heeded[:_SHOWN]
            ]
            if len(heeded) > _SHOWN:
                notes.append(Note(f"and {len(heeded) - _SHOWN} more"))
            known = list(_known(model, namespace))
            frame = namespace == "body" and any(not rest for _, rest in model.split(name))
            near = closest(name, known)
            what = "default class" if namespace == "default" else namespace
            sink.error(
                "unknown-name",
                f"{describe(model, heeded[0][0])} refers to the {what} `{name}`, which does not exist",
                model.span(heeded[0][0]),
                notes=[*(notes if len(heeded) > 1 else []), exists_note(what, known, name)],
                help="the attachment frame is a body only once it has a joint"
                if frame
                else f"did you mean `{near[0]}`?"
                if near
                else None,
            )
    for attachment in model.attachments.values():
        check_references(attachment.child, sink)


def _may_be_generated(model: Model, name: str) -> bool:
    if may_be_generated(name, model.unit.root):
        return True
    return any(_may_be_generated(attachment.child, rest) for attachment, rest in model.split(name))


def _known(model: Model, namespace: str) -> Iterator[str]:
    """Every name of a namespace that the model can refer to."""
    yield from model.names.declared.get(namespace, ())
    for prefix, attachment in model.attachments.items():
        if namespace == "body" and attachment.is_body:
            yield prefix
        if namespace == "joint":
            yield from (prefix + str(joint.get("name") or "") for joint in attachment.frame)
        yield from (prefix + name for name in _known(attachment.child, namespace))

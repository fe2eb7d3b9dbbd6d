"""Find references to names that do not exist in the whole composition."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.mjcf.model import Model
from composer.mjcf.reference import describe, described
from composer.tree.kinds import section_of, spoken
from composer.tree.name_index import UP, Use
from composer.tree.names import word
from composer.tree.references import resolves, unresolved

_SHOWN = 20
_FRAME = "the attachment frame is a body only once it has a joint"
_OUTSIDE = "`../` stands for the model that this one is attached to"


def check_references(model: Model, sink: Sink) -> None:
    """Report each name that is referred to but does not exist, with all elements that refer to it.

    References in default classes are not checked. A name that MuJoCo may generate itself, such as those of the copies
    of a `replicate`, is accepted.
    """
    for each in model.composition():
        for (node, attribute), (target, text) in each.awaited.items():
            if node.get(attribute) == text and each.has(node):
                sink.error(
                    "unknown-name",
                    f"{describe(each, node)} refers by `{spoken(attribute)}` to {described(target)} of the model"
                    f" `{target.model.name}`, which is not attached to `{model.name}`",
                    each.span(node),
                    help="attach it",
                )
        depth = 0 if each is model else 1 + [*each.ancestors()].index(model)
        for namespace, uses in each.names.uses.items():
            declared = each.names.declared.get(namespace, {})  # has most of them, and is asked first
            for name, users in uses.items():
                if name in declared or namespace == "key":
                    continue
                if each.awaited and all(use in each.awaited for use in users):
                    continue  # reported above
                # What is written without the models above it has nothing of theirs.
                if not name.startswith(UP * (depth + 1)) and resolves(each, namespace, name):
                    continue
                heeded = [use for use in users if section_of(use[0]) != "default"]
                if heeded:
                    _report(each, namespace, name, heeded, sink)


def _report(model: Model, namespace: str, name: str, users: list[Use], sink: Sink) -> None:
    notes = [
        Note(f"{describe(model, node)} refers to it by `{spoken(attribute)}`", model.span(node))
        for node, attribute in users[:_SHOWN]
    ]
    if len(users) > _SHOWN:
        notes.append(Note(f"and {len(users) - _SHOWN} more"))
    first = users[0][0]
    outside, inner = model, name
    while inner.startswith(UP) and outside.hung is not None:
        outside, inner = outside.hung.parent, inner[len(UP) :]
    frame = namespace == "body" and any(not rest for _, rest in outside.split(inner))
    sink.add(
        unresolved(
            model,
            namespace,
            name,
            model.span(first),
            message=f"{describe(model, first)} refers to the {word(namespace)} `{name}`, which does not exist",
            help="the attachment frame is a body only once it has a joint"
            if frame
            else _OUTSIDE
            if name.startswith(UP)
            else None,
            notes=notes if len(users) > 1 else (),
        )
    )

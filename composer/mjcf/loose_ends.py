"""Find references to names that do not exist in the whole composition."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.mjcf.model import Model
from composer.mjcf.reference import describe
from composer.tree.kinds import section_of, spoken
from composer.tree.name_index import Use
from composer.tree.names import word
from composer.tree.references import resolves, unresolved

_SHOWN = 20


def check_references(model: Model, sink: Sink) -> None:
    """Report each name that is referred to but does not exist, with all elements that refer to it.

    References in default classes are not checked. A name that MuJoCo may generate itself, such as those of the copies
    of a `replicate`, is accepted.
    """
    for each in model.composition():
        for namespace, uses in each.names.uses.items():
            declared = each.names.declared.get(namespace, {})  # has most of them, and is asked first
            for name, users in uses.items():
                if name in declared or namespace == "key" or resolves(each, namespace, name):
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
    frame = namespace == "body" and any(not rest for _, rest in model.split(name))
    sink.add(
        unresolved(
            model,
            namespace,
            name,
            model.span(first),
            message=f"{describe(model, first)} refers to the {word(namespace)} `{name}`, which does not exist",
            help="the attachment frame is a body only once it has a joint" if frame else None,
            notes=notes if len(users) > 1 else (),
        )
    )

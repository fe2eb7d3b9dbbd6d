"""Replace the separators in names, on request."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.mjcf.bones import renamed, take
from composer.mjcf.errors import raise_errors
from composer.mjcf.model import Model
from composer.mjcf.reference import describe
from composer.tree.attributes import assign
from composer.tree.kinds import kind_of, naming_attribute
from composer.tree.name_index import SEPARATOR

ESCAPED = "\\"


def escape_separators(model: Model) -> None:
    r"""Replace every `/` by `\` in the names of the model and its elements, and in all references.

    Raises `MjcfError` if two names would become equal.
    """
    sink = Sink()
    declared = {
        namespace: {name: node for name, node in names.items() if SEPARATOR in name}
        for namespace, names in model.names.declared.items()
    }
    for namespace, names in declared.items():
        for name, node in names.items():
            taken = model.names.find(namespace, _escaped(name))
            if taken is not None:
                sink.error(
                    "name-clash",
                    f"{describe(model, node)} would be called `{_escaped(name)}`, as another {namespace} is",
                    model.span(node),
                    notes=(Note("the other is here", model.span(taken)),),
                    help="rename one of the two, or read the model without `escape_separators`",
                )
    raise_errors(sink)
    take([(model, renamed(model, _escaped))])
    for names in declared.values():
        for name, node in names.items():
            attribute = naming_attribute(kind_of(node))
            assert attribute is not None
            assign(model, node, {attribute.name: _escaped(name)})
    for namespace, uses in model.names.uses.items():
        model.names.follow(namespace, {name: _escaped(name) for name in uses if SEPARATOR in name})
    if SEPARATOR in model.unit.model:
        model.unit.root.set("model", _escaped(model.unit.model))


def _escaped(name: str) -> str:
    return name.replace(SEPARATOR, ESCAPED)

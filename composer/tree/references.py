"""Check that referenced names exist, and describe the error if one does not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import renaming
from composer.diagnostics.unknown import unknown_name
from composer.grammar import GRAMMAR
from composer.tree.editable import Lookup
from composer.tree.name_index import ALWAYS
from composer.tree.names import word


def resolves(model: Lookup, namespace: str, name: str) -> bool:
    """Return whether a name exists in the model; names that MuJoCo may create itself count."""
    if (namespace, name) in ALWAYS or model.find_node(namespace, name) is not None:
        return True
    return model.may_generate(name)


def unresolved(
    model: Lookup,
    namespace: str,
    name: str,
    span: Span | None,
    *,
    written: str = "{}",
    typed_by: str = "",
    purpose: str = "",
    message: str | None = None,
    help: str | None = None,
    notes: Iterable[Note] = (),
) -> Diagnostic:
    """Return the error for a missing name: existing names, the likely one, and other kinds with the name.

    `written` is the format of a name in the file, `typed_by` the attribute beside it that sets the kind. `purpose`,
    `message` and `help` are as in `unknown_name`; `notes` come first.
    """
    others = [kind for kind in model.kinds_of(name) if kind != namespace]
    # A name that exists with another kind is hardly misspelled.
    fix = None if help is not None or others else renaming(name, model.known_names(namespace))
    types = [kind for kind in others if GRAMMAR.objtypes.get(kind) == kind]
    if help is None and typed_by and types:
        help = f"`{name}` is {word(types[0], article=True)}: write `{typed_by}: {types[0]}`"
    found = unknown_name(
        word(namespace),
        name,
        model.known_names(namespace),
        span=span,
        purpose=purpose,
        message=message,
        written=written,
        help=help,
    )
    if found.help is None:
        notes = (*notes, *(Note(f"`{name}` is {word(kind, article=True)}") for kind in others[:1]))
    return replace(found, notes=(*notes, *found.notes), fix=fix)

"""Report a fault of one selected element, and end the entry."""

from __future__ import annotations

from typing import NoReturn

from lxml.etree import _Element as Node

from composer.compose.edit_values import Unusable
from composer.compose.editing import Editing
from composer.diagnostics.diagnostic import Note
from composer.recipe.fault import Fault


def refuse(editing: Editing, node: Node, fault: Fault, it: str | None = None) -> NoReturn:
    """Report the fault, with the place where the element is written, and raise `Unusable`.

    The entry ends there, since the other elements would have the same fault. `it` is what the note calls the element,
    in place of its tag and name.
    """
    notes = fault.all_notes()
    # A number without a unit is a fault of the recipe, wherever the element is.
    if fault.code != "bare-angle":
        notes.append(Note(f"{it or editing.called(node)} is written here", editing.span_of(node)))
    editing.sink.error(
        fault.code,
        fault.message,
        editing.span(fault.at, key=fault.key),
        notes=notes,
        help=fault.help,
        subjects=(*fault.names, *editing.subjects(node)),
        fix=fault.fix,
    )
    raise Unusable

"""Report a translated message of MuJoCo at the place where its author can fix it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from composer.context import Context
from composer.diagnostics.diagnostic import Cause
from composer.diagnostics.span import Span
from composer.mujoco_errors.location import locate_fault
from composer.mujoco_errors.translation import Translation
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


def report(
    said: Translation,
    element: Node | None,
    model: Unit,
    context: Context,
    cause: Cause | None = None,
    at: Span | None = None,
) -> None:
    """Report an error at the element, or at its faulty attribute; without an element, at the place `at`."""
    if element is None:
        context.sink.add(replace(said.diagnostic, span=at))
        return
    found = locate_fault(said, element, model)
    notes = (*found.notes, *said.diagnostic.notes)
    context.sink.add(replace(said.diagnostic, span=found.span, notes=notes), cause)

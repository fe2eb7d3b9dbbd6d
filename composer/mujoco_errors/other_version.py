"""Report elements and attributes that the MuJoCo of another version reads, and this one does not."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePath
from typing import TYPE_CHECKING

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.grammar.history import Span, place, spans
from composer.grammar.version import version_key
from composer.sources.source import FORMATS

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


Unread = tuple["Node", str | None]
"""An element, or an attribute of it, that this MuJoCo does not read."""


def version_of(found: Iterable[Unread]) -> str | None:
    """Return a version that reads all of these, as far as one is known: the last one before the first of them ended."""
    known = [span for element, name in found if (span := _span(element, name)) is not None]
    ended = [until for _, until in known if until is not None]
    begun = [since for since, _ in known if since is not None]
    return min(ended, key=version_key) if ended else max(begun, key=version_key, default=None)


def of_other_version(
    element: Node, name: str | None, file: str | None, version: str | None = None
) -> Diagnostic | None:
    """Return the error for an attribute, or for the element, that another MuJoCo has in this place, else None.

    `file` is the model in which it is written, and `version` a MuJoCo that reads all of that. `mjcompose migrate`
    writes it for this MuJoCo.

    >>> from lxml import etree
    >>> option = etree.fromstring('<mujoco><option mpr_iterations="20"/></mujoco>')[0]
    >>> found = of_other_version(option, "mpr_iterations", "old.xml")
    >>> found.message, found.notes[0].message
    ('this MuJoCo has no attribute `mpr_iterations` of `<option>`', 'it existed up to MuJoCo 3.2.2')
    """
    known = _span(element, name)
    if known is None:
        return None
    since, until = known
    what = f"`<{element.tag}>`" if name is None else f"attribute `{name}` of `<{element.tag}>`"
    return Diagnostic(
        "unknown-element" if name is None else "unknown-attribute",
        f"this MuJoCo has no {what}",
        notes=(Note(f"it existed up to MuJoCo {until}" if until else f"it exists since MuJoCo {since}"),),
        help=None if file is None or _is_recipe(file) else
        f"`mjcompose migrate {file} --from {version or until or since} -o NEW` writes the model for this MuJoCo",
    )  # fmt: skip


def _span(element: Node, name: str | None) -> Span | None:
    return spans().get(place(element) + ("" if name is None else f"@{name}"))


def _is_recipe(file: str) -> bool:
    return FORMATS.get(PurePath(file).suffix.lower()) == "recipe"

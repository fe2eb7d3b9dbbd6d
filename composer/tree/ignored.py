"""Find what MuJoCo's reader ignores without a warning below a `<frame>` or a `<replicate>`.

These are attributes that MJCF or this version of MuJoCo does not have, and elements in a place where their tag is
not allowed. MuJoCo (3.2 to 4.0) refuses them everywhere else, but has no schema for the contents of a frame.
Because parts are joined by frames, a typo that MuJoCo reports for the source alone would be lost in a composition.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING

from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.element import ElementType
from composer.tree.line import line_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.tree.unit import Unit

BLIND = ("frame", "replicate")
_HOLDERS = ("body", *BLIND)
"""MuJoCo reads these tag by tag, also below a frame."""


def unread(root: Node, version: str | None = None) -> Iterator[tuple[Node, str | None]]:
    """Yield each element with each of its attributes that MuJoCo ignores; None if it ignores the element itself.

    Without a `version` of MuJoCo, yield what any version ignores.

    >>> from lxml import etree
    >>> root = etree.fromstring("<mujoco><worldbody><frame><geom x='1'><y/></geom></frame></worldbody></mujoco>")
    >>> [(node.tag, name) for node, name in unread(root)]
    [('geom', 'x'), ('y', None)]
    """
    if next(root.iter(*BLIND), None) is None:
        return
    for worldbody in root.iterchildren("worldbody"):
        yield from _below(worldbody, GRAMMAR.section("worldbody"), False, version=version)


def _exists(what: ElementType | Attribute, version: str | None) -> bool:
    return what.since is None and what.until is None if version is None else what.exists_in(version)


@cache
def _readable(kind: ElementType, version: str | None) -> frozenset[str]:
    """Return the attributes that MuJoCo reads."""
    return frozenset(name for name, each in kind.attributes.items() if _exists(each, version))


def _below(
    parent: Node, kind: ElementType, blind: bool, version: str | None
) -> Iterator[tuple[Node, str | None]]:
    stack = [(parent, kind, blind)]
    while stack:
        parent, kind, blind = stack.pop()
        for child in parent.iterchildren("*"):
            child_kind = kind.children.get(str(child.tag))
            is_read = child_kind is not None and _exists(child_kind, version)
            if not is_read and blind and parent.tag not in _HOLDERS:
                yield child, None
            if child_kind is None:
                continue
            unseen = blind or child.tag in BLIND
            if unseen:
                known = _readable(child_kind, version)
                yield from ((child, name) for name in map(str, child.keys()) if name not in known)
            if len(child):
                stack.append((child, child_kind, unseen))


def ignored(element: Node, name: str | None, unit: Unit) -> Diagnostic:
    """Return the warning that an attribute of an element, or (None) the element itself, has no effect."""
    span = unit.origins.span(element, unit.file, name, key=name is not None)
    if name is None:
        parent = element.getparent()
        place = "" if parent is None else f" in `<{parent.tag}>`"
        message = f"MuJoCo ignores `<{element.tag}>`{place}, which means nothing"
        return Diagnostic("unknown-element", message, span, severity=Severity.WARNING, help="remove it")
    kind = GRAMMAR.within("worldbody").get(str(element.tag))
    known = [] if kind is None else list(kind.attributes)
    message = f"MuJoCo ignores `{name}` of `<{element.tag}>`, which means nothing"
    near = None if kind is not None and name in kind.ignored else did_you_mean(name, known)
    notes = (exists_note("attribute", known, name),) if near else ()
    return Diagnostic(
        "unknown-attribute",
        message,
        span,
        severity=Severity.WARNING,
        notes=notes,
        help=near or f"remove `{name}`",
    )


def note_unread(unit: Unit) -> None:
    """Remember what MuJoCo ignores in a source by itself, if it is only known later that this has no effect."""
    unit.origins.unread |= {_place(node, name, unit) for node, name in unread(unit.root)}


def is_unread_alone(element: Node, name: str | None, unit: Unit) -> bool:
    """Return whether MuJoCo also ignores it in the source of the unit."""
    return _place(element, name, unit) in unit.origins.unread


def _place(element: Node, name: str | None, unit: Unit) -> tuple[str, int | None, str | None]:
    owner = unit.origins.owner(element, unit.file)
    return owner if isinstance(owner, str) else "", line_of(element), name

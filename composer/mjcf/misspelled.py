"""Errors for tags and attributes that MJCF does not have, with those that it has."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from composer.diagnostics.call_site import call_site
from composer.diagnostics.suggest import closest, exists_note
from composer.diagnostics.unknown import unknown_attribute
from composer.grammar import ElementType
from composer.mjcf import dm_control_hints as elsewhere
from composer.mjcf.errors import MjcfAttributeError, MjcfError, failed, failure
from composer.tree.kinds import spoken


def unknown_tag(tag: object, message: str, known: Iterable[str]) -> MjcfError:
    """Return the error for an element that does not exist here, with the elements that do."""
    names = sorted(known)
    written = tag if isinstance(tag, str) else None
    near = closest(written, names) if written else []
    return failure(
        "unknown-element",
        message,
        call_site(),
        notes=(exists_note("element", names, written),),
        help=elsewhere.TAGS.get(str(tag)) or (f"did you mean `{near[0]}`?" if near else None),
    )


def no_attribute(kind: ElementType, name: str, members: Iterable[str] = ()) -> MjcfError:
    """Return the error for an attribute that elements of a kind do not have, with the attributes that exist.

    When an attribute is read, `members` has the other members of the element; then children are suggested too.
    """
    meant = list(members)
    known = sorted(map(spoken, kind.attributes))
    tags = sorted(map(spoken, kind.children)) if meant else []
    other = elsewhere.ATTRIBUTES.get(name) if meant else None
    found = unknown_attribute(name, f"`<{kind.tag}>`", known, call_site(), help=other, near=[*tags, *meant])
    notes = (*found.notes, exists_note("element", tags, name)) if tags else found.notes
    return failed(replace(found, notes=notes), MjcfAttributeError)

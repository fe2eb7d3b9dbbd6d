"""Tags and attributes that MJCF does not have, told with what it has."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.suggest import closest, did_you_mean, exists_note
from composer.grammar import ElementType
from composer.mjcf import dm_control_hints as elsewhere
from composer.mjcf.call_site import call_site
from composer.mjcf.errors import MjcfAttributeError, MjcfError, failure
from composer.tree.kinds import spoken


def unknown_tag(tag: object, message: str, known: Iterable[str]) -> MjcfError:
    """That there is no such element here, with those that there are."""
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


def unknown_attribute(kind: ElementType, name: str, members: Iterable[str] = ()) -> MjcfError:
    """That elements of a kind have no such attribute, with what they do have.

    `members` are the names that something may be read by, where it is read: then children count too.
    """
    meant = list(members)
    known = sorted(map(spoken, kind.attributes))
    tags = sorted(map(spoken, kind.children)) if meant else []
    other = elsewhere.ATTRIBUTES.get(name) if meant else None
    return failure(
        "unknown-attribute",
        f"`<{kind.tag}>` has no attribute `{name}`",
        call_site(),
        notes=(
            exists_note("attribute", known, name),
            *([exists_note("element", tags, name)] if tags else ()),
        ),
        help=other or did_you_mean(name, [*known, *tags, *meant]),
        kind=MjcfAttributeError,
    )

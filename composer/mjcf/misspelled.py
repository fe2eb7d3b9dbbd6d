"""Tags and attributes that MJCF does not have, told with what it has."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.suggest import closest, did_you_mean, exists_note
from composer.grammar import ElementType
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
        help=f"did you mean `{near[0]}`?" if near else None,
    )


def unknown_attribute(kind: ElementType, name: str, *, children: bool = False) -> MjcfError:
    """That elements of a kind have no such attribute, with what they do have; children too where they count."""
    known = sorted(map(spoken, kind.attributes))
    tags = sorted(kind.children) if children else []
    return failure(
        "unknown-attribute",
        f"`<{kind.tag}>` has no attribute `{name}`",
        call_site(),
        notes=(
            exists_note("attribute", known, name),
            *([exists_note("element", tags, name)] if tags else ()),
        ),
        help=did_you_mean(name, [*known, *tags]),
        kind=MjcfAttributeError,
    )

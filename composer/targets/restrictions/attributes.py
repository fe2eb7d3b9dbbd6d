"""Limits for attributes that a target does not read."""

from __future__ import annotations

from functools import partial

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome

_ZERO = frozenset("0.")


def without_attribute(feature: str, path: str, name: str, why: str) -> Limit:
    """Return a limit that removes an attribute from the elements at a path. A value other than zero is a loss."""
    return Limit(feature, Outcome.LEFT_OUT, partial(_take, feature, path, name, why))


def _take(feature: str, path: str, name: str, why: str, draft: Draft) -> None:
    for element in draft.root.iterfind(path):
        value = element.attrib.pop(name, "")
        if value and not _ZERO.issuperset(str(value).replace(" ", "")):
            draft.lose(feature, element, why)

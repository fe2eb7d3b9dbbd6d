"""Limits for whole kinds of elements that a target does not read, or reads wrongly."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome


def left_out(feature: str, *paths: str, why: str) -> Limit:
    """Return a limit that removes the elements at these paths. `why` says in words what is lost."""
    return Limit(feature, Outcome.LEFT_OUT, partial(_leave_out, feature, paths, why))


def only(feature: str, path: str, tags: Collection[str], why: str) -> Limit:
    """Return a limit that removes the elements at a path whose tag is none of these."""
    return Limit(feature, Outcome.PARTLY, partial(_only, feature, path, frozenset(tags), why))


def refused(feature: str, path: str, why: str, help: str) -> Limit:
    """Return a limit that refuses a model with an element at this path."""
    return Limit(feature, Outcome.REFUSED, partial(_refuse, feature, path, why, help))


def _leave_out(feature: str, paths: Collection[str], why: str, draft: Draft) -> None:
    for path in paths:
        for element in list(draft.root.iterfind(path)):
            draft.lose(feature, element, why)
            draft.remove(element)


def _only(feature: str, path: str, tags: frozenset[str], why: str, draft: Draft) -> None:
    for element in list(draft.root.iterfind(path)):
        if element.tag not in tags:
            draft.lose(feature, element, why)
            draft.remove(element)


def _refuse(feature: str, path: str, why: str, help: str, draft: Draft) -> None:
    for element in draft.root.iterfind(path):
        draft.lose(feature, element, why, refused=True, help=help)

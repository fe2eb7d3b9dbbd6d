"""Limits that depend on the compiled model, which is also what the simulators look at."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome

Missing = tuple[str, str, Collection[str], str]
"""An array of the compiled model, its enumeration, those members that the simulator lacks, and what that means."""
Flagged = Callable[[Any, Any], Iterator[tuple[int, str]]]
"""Of MuJoCo and a model: the numbers of the elements that the simulator refuses, each with the reason."""


def refused_members(feature: str, kind: str, missing: Sequence[Missing], help: str) -> Limit:
    """Return a limit that refuses a model if an array has one of these enum members.

    A member that the running MuJoCo does not have is ignored.
    """
    return Limit(feature, Outcome.SOME_REFUSED, partial(_members, feature, kind, tuple(missing), help))


def refused_elements(feature: str, kind: str, flagged: Flagged, help: str) -> Limit:
    """Return a limit that refuses a model with an element that `flagged` finds."""
    return Limit(feature, Outcome.SOME_REFUSED, partial(_elements, feature, kind, flagged, help))


def refused_options(
    feature: str,
    name: str,
    enums: Sequence[tuple[str, str, Collection[str]]],
    flags: Collection[str],
    help: str,
) -> Limit:
    """Return a limit that refuses a model with one of these values of an option, or one of these flags enabled."""
    return Limit(
        feature, Outcome.SOME_REFUSED, partial(_options, feature, name, tuple(enums), tuple(flags), help)
    )


def _members(feature: str, kind: str, missing: Sequence[Missing], help: str, draft: Draft) -> None:
    for array, enum, names, why in missing:
        values = getattr(draft.model, array)
        numbers = _numbers(draft.mujoco, enum, names)
        for number, node in draft.of(kind):
            if int(values[number]) in numbers:
                draft.lose(feature, node, why, refused=True, help=help)


def _elements(feature: str, kind: str, flagged: Flagged, help: str, draft: Draft) -> None:
    nodes = dict(draft.of(kind))
    for number, why in flagged(draft.mujoco, draft.model):
        if number in nodes:
            draft.lose(feature, nodes[number], why, refused=True, help=help)


def _options(
    feature: str,
    name: str,
    enums: Sequence[tuple[str, str, Collection[str]]],
    flags: Sequence[str],
    help: str,
    draft: Draft,
) -> None:
    option = draft.model.opt
    node = next(draft.root.iterchildren("option"), draft.root)
    for field, enum, names in enums:
        word = _word(draft.mujoco, enum, int(getattr(option, field)))
        if word in names:
            draft.lose(
                feature,
                node,
                f"{name} has no {field} `{word.partition('_')[2].lower()}`",
                refused=True,
                help=help,
            )
    for flag in flags:
        bit = getattr(draft.mujoco.mjtEnableBit, f"mjENBL_{flag.upper()}", None)
        if bit is not None and int(option.enableflags) & int(bit):
            draft.lose(feature, node, f"{name} does not have the flag `{flag}`", refused=True, help=help)


def _numbers(mujoco: Any, enum: str, names: Collection[str]) -> set[int]:
    members = getattr(mujoco, enum).__members__
    return {int(members[name]) for name in names if name in members}


def _word(mujoco: Any, enum: str, value: int) -> str:
    members = getattr(mujoco, enum).__members__
    return next((name for name, each in members.items() if int(each) == value), str(value))


def with_plugins(kind: str) -> Flagged:
    """Return the elements of a kind that plugins compute."""

    def flagged(_mujoco: object, model: Any) -> Iterator[tuple[int, str]]:
        for number in np.flatnonzero(getattr(model, f"{kind}_plugin") >= 0).tolist():
            yield number, f"a plugin computes this {kind}"

    return flagged

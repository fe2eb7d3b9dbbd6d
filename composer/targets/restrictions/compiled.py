"""Limits that depend on the compiled model, which is also what the simulators look at."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome, Refusal, Refuses

OPTION = "option"
Missing = tuple[str, str, Collection[str], str]
"""An array of the compiled model, its enumeration, those members that the simulator lacks, and what that means."""
Flagged = Callable[[Any, Any], Iterator[tuple[int, str]]]
"""Of MuJoCo and a model: the numbers of the elements that the simulator refuses, each with the reason."""


def refused_members(feature: str, kind: str, missing: Sequence[Missing], help: str) -> Limit:
    """Return a limit that refuses a model if an array has one of these enum members.

    A member that the running MuJoCo does not have is ignored.
    """
    return refused_elements(feature, kind, partial(_members, tuple(missing)), help=help)


def refused_elements(
    feature: str, kind: str, flagged: Flagged, help: str, outcome: Outcome = Outcome.SOME_REFUSED
) -> Limit:
    """Return a limit that refuses a model with an element that `flagged` finds."""
    refuses = partial(_elements, kind, flagged, help)
    return Limit(feature, outcome, partial(_refuse, feature, refuses), refuses=refuses)


def refused_options(
    feature: str,
    name: str,
    enums: Sequence[tuple[str, str, Collection[str]]],
    flags: Collection[str],
    help: str,
    together: Flagged | None = None,
) -> Limit:
    """Return a limit that refuses a model with one of these values of an option, or one of these flags enabled.

    `together` finds what is refused only in combination with something else; its numbers mean nothing.
    """
    flagged = partial(_options, name, tuple(enums), tuple(flags), together)
    return refused_elements(feature, OPTION, flagged, help=help)


def _refuse(feature: str, refuses: Refuses, draft: Draft) -> None:
    nodes = {OPTION: {0: next(draft.root.iterchildren(OPTION), draft.root)}}
    for each in refuses(draft.mujoco, draft.model):
        if each.kind not in nodes:
            nodes[each.kind] = dict(draft.of(each.kind))
        if each.number in nodes[each.kind]:
            node = nodes[each.kind][each.number]
            draft.lose(feature, node, each.why, outcome=Outcome.REFUSED, help=each.help)


def _elements(kind: str, flagged: Flagged, help: str, mujoco: Any, model: Any) -> Iterator[Refusal]:
    for number, why in flagged(mujoco, model):
        yield Refusal(kind, number, why, help=help)


def _members(missing: Sequence[Missing], mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    for array, enum, names, why in missing:
        for number in np.flatnonzero(np.isin(getattr(model, array), _numbers(mujoco, enum, names))).tolist():
            yield number, why


def _options(
    name: str,
    enums: Sequence[tuple[str, str, Collection[str]]],
    flags: Sequence[str],
    together: Flagged | None,
    mujoco: Any,
    model: Any,
) -> Iterator[tuple[int, str]]:
    for field, enum, names in enums:
        word = _word(mujoco, enum, int(getattr(model.opt, field)))
        if word in names:
            yield 0, f"{name} has no {field} `{word.partition('_')[2].lower()}`"
    for flag in flags:
        if is_enabled(mujoco, model, flag):
            yield 0, f"{name} does not have the flag `{flag}`"
    if together is not None:
        yield from together(mujoco, model)


def is_enabled(mujoco: Any, model: Any, flag: str) -> bool:
    """Whether a flag is on that is off by default; a MuJoCo may not have it."""
    bit = getattr(mujoco.mjtEnableBit, f"mjENBL_{flag.upper()}", None)
    return bit is not None and bool(int(model.opt.enableflags) & int(bit))


def _numbers(mujoco: Any, enum: str, names: Collection[str]) -> list[int]:
    members = getattr(mujoco, enum).__members__
    return [int(members[name]) for name in names if name in members]


def _word(mujoco: Any, enum: str, value: int) -> str:
    members = getattr(mujoco, enum).__members__
    return next((name for name, each in members.items() if int(each) == value), str(value))


def with_plugins(kind: str) -> Flagged:
    """Return the elements of a kind that plugins compute."""

    def flagged(_mujoco: object, model: Any) -> Iterator[tuple[int, str]]:
        for number in np.flatnonzero(getattr(model, f"{kind}_plugin") >= 0).tolist():
            yield number, f"a plugin computes this {kind}"

    return flagged

"""Limits about MuJoCo's solver: options, the softness of contacts and limits, gravity compensation.

They report only values that differ from MuJoCo's defaults, because nobody has chosen the others.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Any

import numpy as np

from mjcompose.targets.target import Draft, Limit, Outcome, Refusal

OPTION = "option"
Missing = tuple[str, str, Collection[str], str]
"""An array of the compiled model, its enumeration, those members that the simulator lacks, and the effect."""
Flagged = Callable[[Any, Any], Iterator[tuple[int, str]]]
"""Of MuJoCo and a model: the numbers of the elements that the simulator refuses, each with the reason."""


def refused_members(feature: str, kind: str, missing: Sequence[Missing], help: str) -> Limit:
    """Return a limit that refuses a model if an array has one of these enum members.

    A member that the running MuJoCo does not have is ignored.
    """

    def flagged(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
        for array, enum, names, why in missing:
            members = getattr(mujoco, enum).__members__
            lacking = [int(members[name]) for name in names if name in members]
            yield from ((number, why) for number in np.flatnonzero(np.isin(getattr(model, array), lacking)).tolist())

    return refused_elements(feature, kind, flagged, help=help)


def refused_elements(
    feature: str, kind: str, flagged: Flagged, help: str, outcome: Outcome = Outcome.SOME_REFUSED
) -> Limit:
    """Return a limit that refuses a model with an element that `flagged` finds."""

    def refuses(mujoco: Any, model: Any) -> Iterator[Refusal]:
        for number, why in flagged(mujoco, model):
            yield Refusal(kind, number, why, help=help)

    def apply(draft: Draft) -> None:
        option = next(draft.root.iterchildren(OPTION), draft.root)
        nodes = {0: option} if kind == OPTION else dict(draft.of(kind))
        for number, why in flagged(draft.mujoco, draft.model):
            if number in nodes:
                draft.lose(feature, nodes[number], why, outcome=Outcome.REFUSED, help=help)

    return Limit(feature, outcome, apply, refuses=refuses)


def refused_options(
    name: str, enums: Sequence[tuple[str, str, Collection[str]]], flags: Collection[str], together: Flagged
) -> Limit:
    """Return a limit that refuses a model with one of these values of an option, or one of these flags enabled.

    `together` finds values that are refused only in combination with something else; its numbers mean nothing.
    """

    def flagged(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
        for field, enum, names in enums:
            members, value = getattr(mujoco, enum).__members__, int(getattr(model.opt, field))
            for word in names:
                if word in members and int(members[word]) == value:
                    yield 0, f"{name} has no {field} `{word.partition('_')[2].lower()}`"
        for flag in flags:
            if is_enabled(mujoco, model, flag):
                yield 0, f"{name} does not have the flag `{flag}`"
        yield from together(mujoco, model)

    return refused_elements("options", OPTION, flagged, help="write another one in the section `option` of the recipe")


def is_enabled(mujoco: Any, model: Any, flag: str) -> bool:
    """Whether a flag is on that is off by default; a MuJoCo may not have it."""
    bit = getattr(mujoco.mjtEnableBit, f"mjENBL_{flag.upper()}", None)
    return bit is not None and bool(int(model.opt.enableflags) & int(bit))


def with_plugins(kind: str) -> Flagged:
    """Return the elements of a kind that plugins compute."""

    def flagged(_mujoco: object, model: Any) -> Iterator[tuple[int, str]]:
        for number in np.flatnonzero(getattr(model, f"{kind}_plugin") >= 0).tolist():
            yield number, f"a plugin computes this {kind}"

    return flagged


_PLAIN = "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"
_OPTIONS = (
    "timestep", "integrator", "cone", "impratio", "density", "viscosity", "wind", "magnetic", "noslip_iterations",
    "disableflags", "enableflags",
)  # fmt: skip
_WORDS = {"disableflags": "flag", "enableflags": "flag"}
_SOFTNESS = ("solref", "solimp", "margin", "gap", "priority", "solmix", "condim")
_FRICTION = {"sliding": 0, "torsional": 1, "rolling": 2}


def unread_contacts(*friction: str, but: Collection[str] = ()) -> Limit:
    """Return a limit that reports the softness and margins of contacts as lost.

    Attributes in `but` and these kinds of `friction` are read by the target.
    """
    names = [each for each in _SOFTNESS if each not in but]

    def apply(draft: Draft) -> None:
        model, plain = draft.model, _plain(draft)
        for number, node in draft.of("geom"):
            if model.geom_contype[number] or model.geom_conaffinity[number]:
                changed = _changed(model, plain, number, names=names, kind="geom")
                for word in friction:
                    at = _FRICTION[word]
                    if model.geom_friction[number][at] != plain.geom_friction[0][at]:
                        changed.append(f"{word} friction")
                if changed:
                    draft.lose("contacts", node, what=f"{_listed(changed)} of the contacts")

    return Limit("contacts", Outcome.LEFT_OUT, apply)


def _plain(draft: Draft) -> Any:
    return draft.mujoco.MjModel.from_xml_string(_PLAIN)


def _options(draft: Draft) -> None:
    mine, plain = draft.model.opt, _plain(draft).opt
    names = [name for name in _OPTIONS if not np.array_equal(getattr(mine, name), getattr(plain, name))]
    changed = [_WORDS.get(name, name) for name in names]
    for option in draft.root.iterchildren("option"):
        if changed:
            draft.lose("computing", option, "it has settings of its own", what=_listed(changed))


def _gravity(draft: Draft) -> None:
    if np.array_equal(draft.model.opt.gravity, _plain(draft).opt.gravity):
        return
    for option in draft.root.iterchildren("option"):
        shown = " ".join(f"{each:g}" for each in draft.model.opt.gravity)
        draft.lose("gravity", option, f"set it to {shown} in the program", what="gravity")


def _changed(model: Any, plain: Any, number: int, names: Collection[str], kind: str) -> list[str]:
    """Return the attributes of an element that are not the defaults of MuJoCo."""
    arrays = {name: f"{kind}_{name}" for name in names}
    return [
        name
        for name, array in arrays.items()
        if not np.array_equal(getattr(model, array)[number], getattr(plain, array)[0])
    ]


def _bits(draft: Draft) -> None:
    model = draft.model
    for number, node in draft.of("geom"):
        bits = int(model.geom_contype[number]), int(model.geom_conaffinity[number])
        if bits not in ((0, 0), (1, 1)):
            draft.lose("bits", node, "they collide with everything", what="`contype` and `conaffinity`")


def _joints(draft: Draft) -> None:
    model, plain = draft.model, _plain(draft)
    for number, node in draft.of("joint"):
        changed = _changed(model, plain, number, names=("solref", "solimp", "margin"), kind="jnt")
        if changed and model.jnt_limited[number]:
            draft.lose("softness", node, what=f"{_listed(changed)} of the limits")


def _gravcomp(draft: Draft) -> None:
    for number, node in draft.of("body"):
        if draft.model.body_gravcomp[number]:
            draft.lose("gravcomp", node, "all of their weight pulls", what="`gravcomp`")


def _listed(names: Collection[str]) -> str:
    return ", ".join(f"`{each}`" if " " not in each else each for each in dict.fromkeys(names))


COMPUTING = Limit("computing", Outcome.LEFT_OUT, _options)
GRAVITY = Limit("gravity", Outcome.LEFT_OUT, _gravity)
BITS = Limit("bits", Outcome.LEFT_OUT, _bits)
SOFTNESS = Limit("softness", Outcome.LEFT_OUT, _joints)
GRAVCOMP = Limit("gravcomp", Outcome.LEFT_OUT, _gravcomp)

"""Limits for MuJoCo's own solver: options, the softness of contacts and limits, gravity compensation.

Only values that differ from MuJoCo's defaults are reported, since nobody has chosen the others.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial
from typing import Any

import numpy as np

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome

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
    return Limit("contacts", Outcome.LEFT_OUT, partial(_contacts, friction, but))


def _plain(draft: Draft) -> Any:
    return draft.mujoco.MjModel.from_xml_string(_PLAIN)


def _options(draft: Draft) -> None:
    mine, plain = draft.model.opt, _plain(draft).opt
    changed = [
        _WORDS.get(name, name)
        for name in _OPTIONS
        if not np.array_equal(getattr(mine, name), getattr(plain, name))
    ]
    for option in draft.root.iterchildren("option"):
        if changed:
            draft.lose("computing", option, "it has settings of its own", what=_listed(changed))


def _gravity(draft: Draft) -> None:
    if np.array_equal(draft.model.opt.gravity, _plain(draft).opt.gravity):
        return
    for option in draft.root.iterchildren("option"):
        shown = " ".join(f"{each:g}" for each in draft.model.opt.gravity)
        draft.lose("gravity", option, f"set it to {shown} in the program", what="gravity")


def _contacts(friction: Collection[str], but: Collection[str], draft: Draft) -> None:
    model, plain = draft.model, _plain(draft)
    for number, node in draft.of("geom"):
        if not model.geom_contype[number] and not model.geom_conaffinity[number]:
            continue
        changed = [
            each for each in _changed(model, plain, number, names=_SOFTNESS, kind="geom") if each not in but
        ]
        for word in friction:
            at = _FRICTION[word]
            if model.geom_friction[number][at] != plain.geom_friction[0][at]:
                changed.append(f"{word} friction")
        if changed:
            draft.lose("contacts", node, what=f"{_listed(changed)} of the contacts")


def _changed(model: Any, plain: Any, number: int, names: Collection[str], kind: str) -> Iterator[str]:
    for name in names:
        array = f"{kind}_{name}"
        if not np.array_equal(getattr(model, array)[number], getattr(plain, array)[0]):
            yield name


def _bits(draft: Draft) -> None:
    model = draft.model
    for number, node in draft.of("geom"):
        bits = int(model.geom_contype[number]), int(model.geom_conaffinity[number])
        if bits not in ((0, 0), (1, 1)):
            draft.lose("bits", node, "they collide with everything", what="`contype` and `conaffinity`")


def _joints(draft: Draft) -> None:
    model, plain = draft.model, _plain(draft)
    for number, node in draft.of("joint"):
        if model.jnt_limited[number]:
            changed = list(_changed(model, plain, number, names=("solref", "solimp", "margin"), kind="jnt"))
            if changed:
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

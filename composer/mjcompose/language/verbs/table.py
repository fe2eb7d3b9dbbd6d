"""All verbs, in the order in which an entry of `edit` carries them out and `fmt` writes them."""

from __future__ import annotations

from mjcompose.base.extensions import Table
from mjcompose.language.verbs import (
    collision,
    convert,
    inertia,
    motor,
    move,
    offset,
    remove,
    rename,
    scale,
    set,
    simplify,
    unset,
)
from mjcompose.language.verbs.values import Verb

VERBS = Table(
    "verbs",
    {
        each.VERB.name: each.VERB
        for each in (
            unset,
            set,
            scale,
            offset,
            simplify,
            collision,
            inertia,
            convert,
            motor,
            move,
            rename,
            remove,
        )
    },
    "VERB",
    kind=Verb,
)

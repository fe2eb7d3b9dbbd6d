"""All verbs: what carries out each of those that `composer/mjcompose/language/verbs` reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mjcompose.base.diagnostic import Path
from mjcompose.base.extensions import Table
from mjcompose.build.verbs import (
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
from mjcompose.build.verbs.values import Entry
from mjcompose.language.form import check_rows
from mjcompose.language.verbs.table import VERBS

CARRY_OUT: Table[Callable[[Entry, Any, Path], None]] = Table(
    "verbs",
    {
        "unset": unset.carry_out,
        "set": set.carry_out,
        "scale": scale.carry_out,
        "offset": offset.carry_out,
        "simplify": simplify.carry_out,
        "collision": collision.carry_out,
        "inertia": inertia.carry_out,
        "convert": convert.carry_out,
        "motor": motor.carry_out,
        "move": move.carry_out,
        "rename": rename.carry_out,
        "remove": remove.carry_out,
    },
    "carry_out",
)
check_rows(
    "the verbs of `edit` that composer/mjcompose/build/verbs/table.py carries out", CARRY_OUT.own, VERBS.own
)

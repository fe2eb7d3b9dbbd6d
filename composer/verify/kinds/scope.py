"""The elements of a compiled model that belong to a recipe: all of them, or those with a nested recipe's prefix."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import field
from functools import cached_property
from typing import Any

from composer.compiled.kinds import ON_BODIES, Model, NameTable, holder
from composer.compiled.links import links
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fault import Fault
from composer.tree.pattern import fitter
from composer.verify.kinds.failure import unknown

SOLVED = 4
"""Digits kept of simulated or solved values."""


@dataclass
class Scope:
    """The names of a recipe in a compiled model, where each of them starts with `prefix`.

    `others` are longer prefixes that do not belong to the recipe. `keys` is the prefix of its keyframes, or
    None if they were left out. `whole` says that the whole model belongs to the recipe. `values` are the
    values that a check found, whether it holds or not.
    """

    mujoco: Any
    model: Model
    prefix: str = ""
    others: Sequence[str] = ()
    separator: str = "/"
    keys: str | None = ""
    whole: bool = True
    roster: NameTable = field(init=False)
    values: dict[str, Any] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.roster = NameTable(self.model)

    def before(self, kind: str) -> str:
        """Return the prefix of the recipe's names of a kind."""
        return (self.keys or "") if kind == "key" else self.prefix

    def own(self, kind: str) -> Iterator[int]:
        """Yield the ids of the recipe's elements."""
        return (index for index in range(self.roster.count(kind)) if self.owns(kind, index))

    def owns(self, kind: str, index: int) -> bool:
        """Return whether an element belongs to the recipe, judged by its name or else by its body or target."""
        if self.whole:
            return True
        name = self.roster.names[kind][index]
        if kind == "key":  # keys of several recipes merge into one
            return self.keys is not None and name.startswith(self.keys)
        if name and not (kind == "body" and index == 0):
            return self._is_own(name)
        if kind == "body":
            return index > 0 and self.owns("body", holder(self.model, kind, index))
        if kind in ON_BODIES:
            return self.owns("body", holder(self.model, kind, index))
        return any(
            self.owns(each.kind, each.index) for each in links(self.model, kind, index) if each.index >= 0
        )

    def _is_own(self, name: str) -> bool:
        # The body and joint that carry a part are named by its prefix alone. They do not belong to the part.
        return (
            name.startswith(self.prefix) and name != self.prefix and not name.startswith(tuple(self.others))
        )

    def called(self, kind: str, index: int) -> str:
        """Return an element's name for messages: geom `pad`, or geom #2 of body `hand`."""
        name = self.written(kind, index)
        return f"{kind} `{name}`" if self.roster.names[kind][index] else f"{kind} {name}"

    def written(self, kind: str, index: int) -> str:
        """Return the name of an element in the recipe, or the place of an unnamed one."""
        return self.roster.describe(kind, index).removeprefix(self.before(kind))

    def names(self, kind: str) -> list[str]:
        """Return the names of a kind as the recipe writes them."""
        found = [self.roster.names[kind][index] for index in self.own(kind)]
        return [name.removeprefix(self.before(kind)) for name in found if name]

    def find(self, kind: str, name: str, *at: str | int) -> int | Fault:
        """Return the id of the element of that name, or a finding that there is none.

        Every recipe may name the world.
        """
        if kind == "body" and name == "world":
            return 0
        index = self.roster.ids[kind].get(self.prefix + name)
        return unknown(kind, name, self.names(kind), *at) if index is None else index

    def matching(self, kind: str, glob: str) -> list[int]:
        """Return the ids of the recipe's elements that a glob or regular expression matches.

        `**` alone also matches unnamed elements. Raises BadPattern.
        """
        if glob == "**":
            return list(self.own(kind))
        before = self.before(kind)
        named = [(index, self.roster.names[kind][index].removeprefix(before)) for index in self.own(kind)]
        fitting = self.fitting(glob, {name for _, name in named if name})
        return [index for index, name in named if name in fitting]

    def fitting(self, glob: str, names: Collection[str]) -> frozenset[str]:
        """Return those of `names`, as the recipe writes them, that a glob or regular expression matches.

        Raises BadPattern.
        """
        return frozenset(filter(fitter(glob, lambda: names, self.separator), names))

    def at_key(self, key: str | None) -> Any | Fault:
        """Return an mjData at a keyframe or the reference configuration. The caller still calls `mj_forward`."""
        data = self.mujoco.MjData(self.model)
        if key is None:
            return data
        if self.keys is None:
            return Fault(
                "unknown-name",
                f"the keyframe `{key}` does not exist: those of this recipe were left out",
                ("key",),
                notes=(Note("the recipe around it says `keyframes: none`"),),
            )
        index = self.roster.ids["key"].get(self.keys + key)
        if index is None:
            return unknown("keyframe", key, self.names("key"), "key")
        self.mujoco.mj_resetDataKeyframe(self.model, data, index)
        return data

    def found(self, name: str, value: float, digits: int = 9) -> None:
        """Note a value that a check found.

        Simulated or solved values have few `digits`, because further digits differ between machines.
        """
        exact = isinstance(value, int) or not math.isfinite(value)
        self.values[name] = value if exact else float(f"{round(value, digits):.{digits}g}")

    @cached_property
    def joints(self) -> frozenset[int]:
        """The ids of the recipe's joints."""
        return frozenset(self.own("joint"))

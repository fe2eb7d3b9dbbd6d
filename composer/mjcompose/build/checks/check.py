"""The common code of checks: scope, keyframes, words, failures."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict, field
from functools import cached_property
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_name
from mjcompose.mujoco.attributes import ON_BODIES, Model, NameTable, holder
from mjcompose.tree.pattern import fitter


def failed(
    message: str, expected: str, actual: str, *at: str | int, more: Iterable[str] = (), help: str | None = None
) -> Fault:
    """Return a finding with the expected and the actual value.

    `at` is the path of the value that does not hold, below the check's kind.
    """
    notes = (f"expected: {expected}", f"actual: {actual}", *more)
    return Fault("check-failed", message, at, notes=tuple(map(Note, notes)), help=help)


def beside(value: float, *bounds: float, digits: int = 4) -> str:
    """Return a number in as many digits as it takes to see that it is none of the bounds, and no fewer than `digits`.

    >>> beside(0.05, 0.001), beside(0.00100002, 0.001), beside(0.001, 0.001)
    ('0.05', '0.00100002', '0.001')
    """
    for count in range(digits, 17):
        text = f"{value:.{count}g}"
        if all(float(text) != bound for bound in bounds if bound != value):
            return text
    return repr(value)


def unknown(kind: str, name: str, known: Iterable[str], *at: str | int) -> Fault:
    """Return a finding for an unknown name. `known` are the existing names as the recipe would write them."""
    found = unknown_name(kind, name, [each for each in known if each])
    return Fault(found.code, found.message, at, notes=found.notes, help=found.help)


def to_json(fault: Fault) -> dict[str, Any]:
    """Return the fields that a check may set; the recipe's side fills in the others."""
    return {name: value for name, value in asdict(fault).items() if name in _FIELDS}


def from_json(data: dict[str, Any]) -> Fault:
    """Return the fault that `to_json` turned into data."""
    notes = tuple(Note(each["message"]) for each in data["notes"])
    return Fault(**{**data, "at": tuple(data["at"]), "notes": notes})


_FIELDS = ("code", "message", "at", "notes", "help")


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
        """Return whether an element belongs to the recipe, by its name or else by its body or target."""
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
        from mjcompose.mujoco.references import links

        return any(self.owns(each.kind, each.index) for each in links(self.model, kind, index) if each.index >= 0)

    def _is_own(self, name: str) -> bool:
        # The body and joint that carry a part are named by its prefix alone. They do not belong to the part.
        return name.startswith(self.prefix) and name != self.prefix and not name.startswith(tuple(self.others))

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
                f"the keyframe `{key}` does not exist: this recipe drops its keyframes",
                ("key",),
                notes=(Note("the recipe around it leaves them out: `drop: [key]`"),),
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


def keys_named(scope: Scope, globs: Sequence[str]) -> list[str] | Fault:
    """Return the names of the keyframes that the globs match, as in the recipe; all of them without globs."""
    known = [] if scope.keys is None else scope.names("key")
    if not globs:
        return known
    if scope.keys is None and isinstance(fault := scope.at_key(globs[0]), Fault):
        return fault
    found: list[str] = []
    for at, glob in enumerate(globs):
        fitting = scope.fitting(glob, known)
        if not fitting:
            notes = (exists_note("keyframe", known, glob),)
            place = ("key", at) if len(globs) > 1 else ("key",)
            help = did_you_mean(glob, known)
            return Fault("unknown-name", f"`{glob}` names no keyframe", place, notes=notes, help=help)
        found += [name for name in known if name in fitting and name not in found]
    return found


def poses(scope: Scope, globs: Sequence[str]) -> list[tuple[str, Any]] | Fault:
    """Return where a message is about, and an mjData, of each keyframe that the globs match.

    Without globs it is the reference configuration. The caller still calls `mj_forward`.
    """
    if not globs:
        return [("", scope.at_key(None))]
    names = keys_named(scope, globs)
    return names if isinstance(names, Fault) else [(f" in `{name}`", data) for name, data in at_keys(scope, names)]


def at_keys(scope: Scope, names: Sequence[str]) -> Iterator[tuple[str, Any]]:
    """Yield an mjData at each keyframe. The caller still calls `mj_forward`."""
    for name in names:
        data = scope.at_key(name)
        if not isinstance(data, Fault):
            yield name, data


def unmet(scope: Scope, kinds: Sequence[str], globs: Sequence[str], *at: str | int) -> Fault | None:
    """Return a finding for the first glob that matches nothing of these kinds."""
    known = [name for kind in kinds for name in scope.names(kind)]
    for index, glob in enumerate(globs):
        if not any(scope.matching(kind, glob) for kind in kinds):
            notes = (exists_note("name", sorted(known), glob),)
            place = (*at, index) if len(globs) > 1 else at
            message, help = f"`{glob}` names no {' and no '.join(kinds)}", did_you_mean(glob, known)
            return Fault("unknown-name", message, place, notes=notes, help=help)
    return None

"""Comparison in another process: the question as plain data, and the differences back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, field
from typing import Any

from composer.compiled.difference import MISSING, Difference, Value
from composer.compiled.joints import FREE
from composer.compiled.keyframes import Keys, Roots
from composer.compiled.kinds import Model, NameTable
from composer.compiled.mount import Mount
from composer.compiled.unchanged import compare
from composer.dataclass import dataclass
from composer.numerics.pose import IDENTITY_QUAT, ORIGIN, Quat, Vec3


@dataclass(frozen=True, slots=True)
class Question:
    """The question whether a part is unchanged.

    The fields are those of `compare`; the place is given as in a recipe. ``site`` and ``body`` are names in the
    composition; if both are None, the place is the world. ``pos`` is in metres, in the frame of the place.
    ``posed=False`` says that the pose is unknown; there is no site then. ``key_prefix`` starts the names of the
    part's keys if it is not the one that ``keys`` implies. ``welded`` says that free joints at the part's root were
    removed.
    """

    prefix: str = ""
    site: str | None = None
    body: str | None = None
    pos: Vec3 = ORIGIN
    quat: Quat = IDENTITY_QUAT
    posed: bool = True
    renamed: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    keys: Keys = Keys.MERGE
    roots_in_keys: Roots = Roots.MOVED
    ignore: tuple[str, ...] = ()
    replaced_keys: tuple[str, ...] = ()
    tolerance: float = 0.0
    key_prefix: str | None = None
    welded: bool = False
    cut: bool = False

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    def mount(self, composed: Model) -> Mount:
        """Return the place of the part. Raises KeyError if the composition lacks the site or body."""
        if not self.posed:
            return Mount(self.body, None)
        return Mount.of(composed, site=self.site, body=self.body, pos=self.pos, quat=self.quat)


def ask(
    _mujoco: object, alone: Model, composed: Model, question: Mapping[str, Any]
) -> list[dict[str, Any]] | None:
    """Return the differences of a part as JSON data; runs under `composer.engine.call`.

    ``question`` has the fields of a `Question`. Return None if the composition lacks the body of the part's
    place.
    """
    given = Question(**question)
    if given.body is not None and given.body not in NameTable(composed).ids["body"]:
        return None
    found = compare(
        alone,
        composed,
        prefix=given.prefix,
        hung_on=given.mount(composed),
        renamed=_renamed(alone, given),
        keys=Keys(given.keys),
        roots_in_keys=Roots(given.roots_in_keys),
        ignore=given.ignore,
        replaced_keys=given.replaced_keys,
        tolerance=given.tolerance,
        cut=given.cut,
    )
    free = _free(alone, given.prefix) if given.welded else frozenset()
    return [asdict(each) for each in found if not _of_welding(each, free)]


def _renamed(alone: Model, given: Question) -> Mapping[str, Mapping[str, str]]:
    if given.key_prefix is None:
        return given.renamed
    names = NameTable(alone).ids["key"]
    return {**given.renamed, "key": {name: given.key_prefix + name for name in names}}


def _free(alone: Model, prefix: str) -> frozenset[str]:
    """Return the names of free joints and their bodies in the composition; `#` stands for unnamed ones."""
    roster = NameTable(alone)
    free = [index for index, kind in enumerate(alone.jnt_type) if kind == FREE]
    names = [roster.names["joint"][index] for index in free]
    names += [roster.names["body"][int(alone.jnt_bodyid[index])] for index in free]
    return frozenset(prefix + name if name else "#" for name in names)


def _of_welding(difference: Difference, free: frozenset[str]) -> bool:
    """Return whether the difference only says that a free joint was removed."""
    if (difference.kind, difference.field) != ("joint", MISSING) and (
        difference.field not in ("body_dofnum", "body_jntnum")
    ):
        return False
    return difference.name in free or ("#" in free and difference.name.startswith("#"))


def differences_of(value: list[dict[str, Any]]) -> list[Difference]:
    """Return the differences that ``ask`` returned as JSON data."""
    return [
        Difference(
            each["kind"],
            each["name"],
            each["field"],
            expected=_frozen(each["expected"]),
            actual=_frozen(each["actual"]),
            why=each.get("why", ""),
        )
        for each in value
    ]


def _frozen(value: Any) -> Value:
    if isinstance(value, list):
        return tuple(_frozen(item) for item in value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a difference cannot hold {type(value).__name__}")

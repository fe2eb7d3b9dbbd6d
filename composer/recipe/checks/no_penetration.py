"""The check `no_penetration`: that nothing is inside of something else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.pattern import GLOB
from composer.recipe.reference import reference
from composer.recipe.shown import kind_of

MAX = 1e-3


@dataclass(frozen=True, slots=True)
class NoPenetration:
    """At `key` (None: the reference configuration) no contact is deeper than `max` metres.

    `exclude` has pairs of globs over names of geoms and bodies whose contacts do not count.
    """

    word: ClassVar[str] = "no_penetration"
    name: str
    key: str | None
    max: float
    exclude: tuple[tuple[str, str], ...]
    at: Path


def read(keys: Keys, at: Path) -> NoPenetration | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known(("key", "max", "exclude"))
    key = keys.text("key", "the name of a keyframe")
    depth = keys.number("max", MAX, least=0)
    pairs = keys.value.get("exclude", [])
    if not isinstance(pairs, list):
        message = f"`exclude` of {keys.owner} expects a list of pairs of globs, got {kind_of(pairs)}"
        keys.add("wrong-type", message, "exclude", help='write for instance `exclude: [["arm/**", table]]`')
        return None
    found: list[tuple[str, str]] = []
    for index, pair in enumerate(pairs):
        if isinstance(pair, list) and len(pair) == 2:
            globs = [
                keys.glob_of(each, "globs over names of geoms or bodies", "exclude", index, side)
                for side, each in enumerate(pair)
            ]
            found.append((globs[0] or "", globs[1] or ""))
            continue
        got = f"{len(pair)} of them" if isinstance(pair, list) else kind_of(pair)
        help = "a pair is a list of its own: `exclude: [[a, b]]`"
        message = f"`exclude` of {keys.owner} expects pairs of globs, got {got}"
        keys.add(
            "wrong-length" if isinstance(pair, list) else "wrong-type", message, "exclude", index, help=help
        )
    if len(keys.faults) > before or depth is None:
        return None
    return NoPenetration(keys.name, key, depth, tuple(found), at)


KIND = Kind(
    "no_penetration",
    read,
    mapping_schema(
        "Nothing is inside of something else at a keyframe, as far as geoms can touch.",
        {
            "key": {**NAME, "description": "the pose; without it, the reference configuration"},
            "max": {
                **reference("number"),
                "description": f"the greatest depth, in metres (default: {MAX:g})",
            },
            "exclude": {
                "type": "array",
                "description": "pairs of globs over names of geoms and bodies whose contacts do not count",
                "items": {"type": "array", "items": dict(GLOB), "minItems": 2, "maxItems": 2},
            },
        },
    ),
    "{key: home}",
)

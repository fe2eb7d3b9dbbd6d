"""The check `unchanged`: that a part is what its source is alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from composer.diagnostics.suggest import closest
from composer.grammar import GRAMMAR
from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.shown import kind_of

PART, EXCEPT = "part", "except"
OF_THE_WHOLE = frozenset("compiler option size statistic visual extension".split())
"""Sections that are not a part's."""
OWN = frozenset({"class", "childclass", "name", "file"})
"""Attributes that a compiled model does not have as such: they cannot be excepted."""


@dataclass(frozen=True, slots=True)
class Unchanged:
    """A part is what its source is alone. `part` is None for all parts, `excepted` are attributes of MJCF.

    The place of an attribute is `locate(node, (*at, "unchanged", "except", INDEX))`.
    """

    word: ClassVar[str] = "unchanged"
    name: str
    part: str | None
    excepted: tuple[str, ...]
    at: Path


def attributes() -> list[str]:
    """Every attribute of MJCF that an element of a model may have, sorted."""
    sections = [tag for tag in GRAMMAR.root.children if tag not in OF_THE_WHOLE]
    kinds = [kind for tag in sections for kind in GRAMMAR.within(tag).values()]
    return sorted({name for kind in kinds for name in kind.attributes} - OWN)


def read(keys: Keys, at: Path) -> Unchanged | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known((PART, EXCEPT))
    part = keys.text(PART, "the prefix of a part")
    excepted = keys.value.get(EXCEPT, [])
    if not isinstance(excepted, list):
        message = f"`{EXCEPT}` of {keys.owner} expects a list of attributes, got {kind_of(excepted)}"
        listed = f"write `{EXCEPT}: [{excepted}]`" if isinstance(excepted, str) else None
        keys.add("wrong-type", message, EXCEPT, help=listed)
        return None
    known = attributes() if excepted else []
    for index, each in enumerate(excepted):
        if each not in known:
            _unknown(keys, each, index, known)
    return Unchanged(keys.name, part, tuple(excepted), at) if len(keys.faults) == before else None


def _unknown(keys: Keys, name: Any, index: int, known: list[str]) -> None:
    if not isinstance(name, str):
        message = f"`{EXCEPT}` expects attributes of MJCF, got {kind_of(name)}"
        keys.add("wrong-type", message, EXCEPT, index)
        return
    near = closest(name, known)
    message = f"MJCF has no attribute `{name}` that could be excepted"
    help = f"write `{near[0]}`" if near else None
    keys.add("unknown-attribute", message, EXCEPT, index, help=help)


KIND = Kind(
    "unchanged",
    read,
    mapping_schema(
        "A part is what its source is when MuJoCo compiles that alone.",
        {
            PART: {
                **NAME,
                "description": "the part, by its prefix; `base` is the base; without it, all of them",
            },
            EXCEPT: {
                "type": "array",
                "items": dict(NAME),
                "description": "attributes of MJCF that are changed on purpose",
            },
        },
    ),
    "{}",
)

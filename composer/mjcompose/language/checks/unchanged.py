"""The check `unchanged`: a part is the same as its source alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.base.suggest import advised
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name
from mjcompose.language.form import Schema, kind_of
from mjcompose.model.grammar import GRAMMAR

PART, EXCEPT = "part", "except"
OF_THE_WHOLE = frozenset("compiler option size statistic visual extension".split())
"""Sections that are not a part's."""
OWN = frozenset({"class", "childclass", "name", "file"})
"""Attributes that a compiled model does not have as such: they cannot be excepted."""


@dataclass(frozen=True, slots=True)
class Unchanged:
    """A part is the same as its source alone. Without `part`, all parts are. Attributes `excepted` may differ.

    The place of an attribute is `locate(node, (*at, "unchanged", "except", INDEX))`.
    """

    word: ClassVar[str] = "unchanged"
    name: str
    part: str | None
    excepted: tuple[str, ...]
    at: Path


def attributes() -> list[str]:
    """Return every attribute of MJCF that an element of a model can have, sorted."""
    sections = [tag for tag in GRAMMAR.root.children if tag not in OF_THE_WHOLE]
    kinds = [kind for tag in sections for kind in GRAMMAR.within(tag).values()]
    return sorted({name for kind in kinds for name in kind.attributes} - OWN)


class Attributes:
    """Form of a list of MJCF's attributes, read as a tuple."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[Any, ...]:
        if not isinstance(value, list):
            message = f"`{at[-1]}` of {keys.owner} expects a list of attributes, got {kind_of(value)}"
            listed = f"write `{at[-1]}: [{value}]`" if isinstance(value, str) else None
            keys.add("wrong-type", message, *at, help=listed)
            return ()
        known = attributes() if value else []
        for index, each in enumerate(value):
            if each not in known:
                self._unknown(keys, each, known, *at, index)
        return tuple(value)

    def _unknown(self, keys: Keys, name: Any, known: list[str], *at: str | int) -> None:
        if not isinstance(name, str):
            message = f"`{at[0]}` expects attributes of MJCF, got {kind_of(name)}"
            keys.add("wrong-type", message, *at)
            return
        help, fix = advised(name, known)
        message = f"MJCF has no attribute `{name}` that could be excepted"
        keys.add("unknown-attribute", message, *at, help=help, fix=fix)

    def schema(self) -> Schema:
        return {"type": "array", "items": {"type": "string", "minLength": 1}}


FORM = Keyed(
    "A part is what its source is when MuJoCo compiles that alone.",
    Key(
        PART,
        Name("the prefix of a part"),
        "the part, by its prefix; `base` is the base; without it, all of them",
    ),
    Key(EXCEPT, Attributes(), "attributes of MJCF that are changed on purpose", default=()),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Unchanged:
    return Unchanged(keys.name, found[PART], found[EXCEPT], at=at)


KIND = Kind("unchanged", FORM, make, example="{}")

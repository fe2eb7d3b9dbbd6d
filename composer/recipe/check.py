"""What must hold of every model that is built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from composer.diagnostics.suggest import closest, exists_note
from composer.recipe.checks import equal, exists, mass, no_penetration, reachable, size, stable, unchanged
from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import Check, Kind
from composer.recipe.fault import Fault, Path, Remark, refusal
from composer.recipe.raw import path_of
from composer.recipe.shown import kind_of

KINDS: dict[str, Kind] = {
    room.KIND.word: room.KIND
    for room in (size, mass, exists, stable, no_penetration, reachable, equal, unchanged)
}


@dataclass(frozen=True, slots=True)
class Checks:
    """Marks the field `check`: a mapping from a name to `{KIND: {…}}`. Gives a tuple of checks."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        kinds: dict[str, Any] = {"type": "object", "additionalProperties": False, "minProperties": 1}
        kinds["properties"] = {word: kind.schema for word, kind in KINDS.items()}
        return {"type": "object", "additionalProperties": kinds}

    def _validate(self, value: Any) -> tuple[Check, ...]:
        faults: list[Fault] = []
        found: list[Check] = []
        if isinstance(value, dict):
            found = [check for name, item in value.items() for check in _read(name, item, faults)]
        else:
            message = f"`check` expects a mapping from names to checks, got {kind_of(value)}"
            help = "give each a name: `check: {whole: {unchanged: {}}}`"
            faults.append(Fault("wrong-type", message, help=help))
        if faults:
            raise refusal(faults, value)
        return tuple(found)


def _read(name: str, value: Any, faults: list[Fault]) -> Iterator[Check]:
    owner = f"check `{name}`"
    if not isinstance(value, dict):
        help = f"write `{name}: {{unchanged: {{}}}}`" if name not in KINDS else _named(name)
        faults.append(Fault("wrong-type", f"{owner} is a mapping, got {kind_of(value)}", (name,), help=help))
        return
    if not value:
        help = "write for instance `unchanged: {}`" if name not in KINDS else _named(name)
        faults.append(Fault("missing-key", f"{owner} checks nothing", (name,), help=help))
    if name in KINDS and not any(word in (*KINDS, "when") for word in value):
        first = next(iter(value), None)
        if first is not None:
            message = f"`{first}` in {owner} is not a kind of check: `{name}` is the name of this check"
            faults.append(Fault("unknown-key", message, (name, first), key=True, help=_named(name)))
        return
    for word, given in value.items():
        kind = KINDS.get(word)
        if kind is None:
            faults.append(_unknown_kind(word, owner, (name, word)))
        elif not isinstance(given, list if kind.listed else dict):
            wanted = "list" if kind.listed else "mapping"
            message = f"`{word}` of {owner} is a {wanted}, got {kind_of(given)}"
            help = f"write for instance `{word}: {kind.example}`"
            faults.append(Fault("wrong-type", message, (name, word), help=help))
        else:
            check = kind.read(Keys(name, word, given, faults), path_of(value))
            if check is not None:
                yield check


def _named(word: str) -> str:
    """What to write where a kind of check stands in the place of a name."""
    return f"the key is a name that you choose: write `NAME: {{{word}: {KINDS[word].example}}}`"


def _unknown_kind(key: str, owner: str, at: Path) -> Fault:
    near = closest(key, (*KINDS, "when"))
    return Fault(
        "unknown-key",
        f"`{key}` in {owner} is not a kind of check",
        at,
        key=True,
        remarks=(Remark(exists_note("check kind", KINDS, key).message),),
        help=f"write `{near[0]}`" if near else None,
    )

"""What must hold of every model that is built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from composer.diagnostics.suggest import closest, exists_note
from composer.grammar import GRAMMAR
from composer.recipe.fault import Fault, Path, Remark, refusal
from composer.recipe.raw import Placed, path_of
from composer.recipe.shown import kind_of

UNCHANGED = "unchanged"
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

    name: str
    part: str | None
    excepted: tuple[str, ...]
    at: Path


@dataclass(frozen=True, slots=True)
class Checks:
    """Marks the field `check`: a mapping from a name to `{KIND: {…}}`. Gives a tuple of checks."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        names = {"type": "array", "items": {"type": "string", "minLength": 1}}
        unchanged = {
            "type": "object",
            "additionalProperties": False,
            "description": "a part is what its source is alone, in every array that does not depend on its place",
            "properties": {
                PART: {"type": "string", "minLength": 1, "description": "the part; without it, every part"},
                EXCEPT: {**names, "description": "attributes of MJCF that may differ"},
            },
        }
        kinds = {"type": "object", "additionalProperties": False, "required": [UNCHANGED]}
        kinds["properties"] = {UNCHANGED: unchanged}
        return {"type": "object", "additionalProperties": kinds}

    def _validate(self, value: Any) -> tuple[Unchanged, ...]:
        faults: list[Fault] = []
        found: list[Unchanged] = []
        if isinstance(value, dict):
            found = [check for name, item in value.items() for check in _check(name, item, faults)]
        else:
            message = f"`check` expects a mapping from names to checks, got {kind_of(value)}"
            help = f"give each a name: `check: {{whole: {{{UNCHANGED}: {{}}}}}}`"
            faults.append(Fault("wrong-type", message, help=help))
        if faults:
            raise refusal(faults, value)
        return tuple(found)


def attributes() -> list[str]:
    """Every attribute of MJCF that an element of a model may have, sorted."""
    sections = [tag for tag in GRAMMAR.root.children if tag not in OF_THE_WHOLE]
    kinds = [kind for tag in sections for kind in GRAMMAR.within(tag).values()]
    return sorted({name for kind in kinds for name in kind.attributes} - OWN)


def _check(name: str, value: Any, faults: list[Fault]) -> Iterator[Unchanged]:
    owner = f"check `{name}`"
    if not isinstance(value, dict):
        help = f"write `{name}: {{{UNCHANGED}: {{}}}}`"
        faults.append(Fault("wrong-type", f"{owner} is a mapping, got {kind_of(value)}", (name,), help=help))
        return
    for key in value:
        if key != UNCHANGED:
            faults.append(_unknown_kind(key, owner, (name, key)))
    if UNCHANGED in value:
        yield from _unchanged(name, value[UNCHANGED], path_of(value), owner, faults)
    elif not value and not (isinstance(value, Placed) and value.cut):
        faults.append(
            Fault("missing-key", f"{owner} checks nothing", (name,), help=f"write `{UNCHANGED}: {{}}`")
        )


def _unknown_kind(key: str, owner: str, at: Path) -> Fault:
    kinds = [UNCHANGED]
    near = closest(key, kinds)
    return Fault(
        "unknown-key",
        f"`{key}` in {owner} is no kind of check",
        at,
        key=True,
        remarks=(Remark(exists_note("check kind", kinds, key).message),),
        help=f"write `{near[0]}`" if near else None,
    )


def _unchanged(name: str, value: Any, at: Path, owner: str, faults: list[Fault]) -> Iterator[Unchanged]:
    start = (name, UNCHANGED)
    if not isinstance(value, dict):
        help = f"write `{UNCHANGED}: {{{PART}: PREFIX}}`, or `{UNCHANGED}: {{}}` for all parts"
        message = f"`{UNCHANGED}` of {owner} is a mapping, got {kind_of(value)}"
        faults.append(Fault("wrong-type", message, start, help=help))
        return
    for key in value:
        if key not in (PART, EXCEPT):
            near = closest(key, (PART, EXCEPT))
            help = f"write `{near[0]}`" if near else f"it has `{PART}` and `{EXCEPT}`"
            message = f"`{UNCHANGED}` has no `{key}`"
            faults.append(Fault("unknown-key", message, (*start, key), key=True, help=help))
    part = value.get(PART)
    if part is not None and (not isinstance(part, str) or not part):
        message = f"`{PART}` of {owner} expects the prefix of a part, got {kind_of(part)}"
        faults.append(Fault("wrong-type", message, (*start, PART)))
        return
    excepted = value.get(EXCEPT, [])
    if not isinstance(excepted, list):
        message = f"`{EXCEPT}` of {owner} expects a list of attributes, got {kind_of(excepted)}"
        listed = f"write `{EXCEPT}: [{excepted}]`" if isinstance(excepted, str) else None
        faults.append(Fault("wrong-type", message, (*start, EXCEPT), help=listed))
        return
    before = len(faults)
    known = attributes() if excepted else []
    for index, each in enumerate(excepted):
        if each not in known:
            faults.append(_unknown_attribute(each, (*start, EXCEPT, index), known))
    if len(faults) == before:
        yield Unchanged(name, part, tuple(excepted), at)


def _unknown_attribute(name: Any, at: Path, known: list[str]) -> Fault:
    if not isinstance(name, str):
        message = f"`{EXCEPT}` expects attributes of MJCF, got {kind_of(name)}"
        return Fault("wrong-type", message, at)
    near = closest(name, known)
    message = f"MJCF has no attribute `{name}` that could be excepted"
    return Fault("unknown-attribute", message, at, help=f"write `{near[0]}`" if near else None)

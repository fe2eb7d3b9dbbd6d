"""Changes to what is there: the entries of `edit`, each a selector and what is done to what it selects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from composer.diagnostics.suggest import closest, exists_note
from composer.recipe.count import read_count
from composer.recipe.edit_values import VERBS, Checker
from composer.recipe.fault import EXCLUSIVE, Fault, Path, Remark, refusal
from composer.recipe.raw import path_of
from composer.recipe.select import inside, read_selector
from composer.recipe.settings import settings
from composer.recipe.shown import kind_of, shown
from composer.tree.selector import Selector

REMOVE = "remove"
_KEYS = ("select", *VERBS, REMOVE, "expect", "optional", "id", "when")


@dataclass(frozen=True, slots=True)
class Edit:
    """One entry. Values are as they are written: `${…}` in them is evaluated for each element.

    `unset` has attributes, or for classes a mapping from tag to attributes; `at` is the path to the entry.
    """

    select: Selector
    unset: tuple[str, ...] | Mapping[str, tuple[str, ...]] = ()
    set: Mapping[str, Any] = field(default_factory=dict)
    scale: Mapping[str, Any] = field(default_factory=dict)
    offset: Mapping[str, Any] = field(default_factory=dict)
    convert: Mapping[str, Any] | None = None
    move: Mapping[str, Any] | None = None
    rename: str | None = None
    remove: Literal[True, "cascade"] | None = None
    expect: int | None = None
    optional: bool = False
    at: Path = ()

    @property
    def verbs(self) -> tuple[str, ...]:
        """What it does, in the order in which it is done."""
        if self.remove is not None:
            return (REMOVE,)
        return tuple(verb for verb in VERBS if getattr(self, verb))

    @property
    def words(self) -> str:
        """What `plan` prints for the entry, on one line."""
        return f"edit {self.select}: {'; '.join(_verbs(self))}"


@dataclass(frozen=True, slots=True)
class Edits:
    """Marks a field `edit`: a list of entries. Gives a tuple of `Edit`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        from composer.recipe.edit_schema import edits

        return edits()

    def _validate(self, value: Any, info: ValidationInfo) -> tuple[Edit, ...]:
        faults: list[Fault] = []
        found: list[Edit] = []
        if isinstance(value, list):
            checker = Checker(settings(info.context).bare_angles, faults)
            found = [
                edit
                for index, item in enumerate(value)
                if (edit := _edit(item, (index,), checker, faults)) is not None
            ]
        else:
            help = "put `- ` in front of `select`" if isinstance(value, dict) and "select" in value else None
            faults.append(
                Fault("wrong-type", f"`edit` expects a list of entries, got {kind_of(value)}", help=help)
            )
        if faults:
            raise refusal(faults, value)
        return tuple(found)


def _edit(value: Any, at: Path, checker: Checker, faults: list[Fault]) -> Edit | None:
    if not isinstance(value, dict):
        message = f"an entry of `edit` is a mapping, got {kind_of(value)}"
        help = "write `{select: {TAG: NAME}, set: {ATTRIBUTE: VALUE}}`"
        faults.append(Fault("wrong-type", message, at, help=help))
        return None
    before = len(faults)
    faults += _unknown(value, at)
    if "select" not in value:
        help = "write `select: {TAG: NAME}`: which elements are meant"
        faults.append(
            Fault("missing-key", "an entry of `edit` lacks `select`", at, help=help, lacks="select")
        )
        return None
    selector = read_selector(value["select"], (*at, "select"), "`select`", faults)
    verbs = [name for name in (*VERBS, REMOVE) if name in value]
    if not verbs and len(faults) == before:
        known = ", ".join(f"`{name}`" for name in (*VERBS, REMOVE))
        message = "an entry of `edit` says nothing to be done"
        faults.append(Fault("missing-key", message, at, help=f"write one of {known}"))
    if REMOVE in verbs and len(verbs) > 1:
        other = next(name for name in verbs if name != REMOVE)
        faults.append(
            Fault(
                EXCLUSIVE,
                f"`{REMOVE}` stands alone, and there is `{other}` as well",
                (*at, REMOVE),
                key=True,
                remarks=(Remark(f"`{other}` is written here", (*at, other)),),
                help=f"leave `{REMOVE}` or `{other}` out",
            )
        )
    read = {name: checker.verb(name, value[name], selector, (*at, name)) for name in verbs if name != REMOVE}
    remove = _remove(value[REMOVE], (*at, REMOVE), faults) if REMOVE in value else None
    expect, optional = read_count(value, at, faults)
    if selector is None or len(faults) > before:
        return None
    return Edit(
        selector, **read, remove=remove, expect=expect, optional=optional, at=path_of(value)
    )  # fmt: skip


def _unknown(value: dict[str, Any], at: Path) -> Iterator[Fault]:
    for name in value:
        if name in _KEYS:
            continue
        near = closest(name, _KEYS)
        help = inside(name) or (f"write `{near[0]}`" if near else None)
        remark = Remark(exists_note("key", _KEYS, name).message)
        yield Fault(
            "unknown-key",
            f"`{name}` is not a key of an entry of `edit`",
            (*at, name),
            key=True,
            remarks=(remark,),
            help=help,
        )


def _remove(value: Any, at: Path, faults: list[Fault]) -> Literal[True, "cascade"] | None:
    if value is True:
        return True
    if value == "cascade":
        return "cascade"
    help = "write `remove: true`, or `remove: cascade` to take along all that refers to it"
    faults.append(Fault("wrong-keyword", f"`{REMOVE}` is `true` or `cascade`, got {kind_of(value)}", at,
                        help=help))  # fmt: skip
    return None


def _verbs(edit: Edit) -> Iterator[str]:
    if edit.remove is not None:
        yield "remove" if edit.remove is True else "remove, with all that refers to it"
    if isinstance(edit.unset, Mapping):
        yield f"unset {', '.join(f'{tag}.{name}' for tag, names in edit.unset.items() for name in names)}"
    elif edit.unset:
        yield f"unset {', '.join(edit.unset)}"
    for verb in ("set", "scale", "offset"):
        written: Mapping[str, Any] = getattr(edit, verb)
        if written:
            sign = {"set": "=", "scale": "×", "offset": "+"}[verb]
            yield f"{verb} {', '.join(f'{name} {sign} {value}' for name, value in _flat(written))}"
    if edit.convert:
        given = [f"{name} = {shown(value)}" for name, value in edit.convert.items() if name != "to"]
        yield f"convert to {edit.convert['to']}{' with ' if given else ''}{', '.join(given)}"
    if edit.move:
        to = edit.move["to"]
        given = [f"{name} = {shown(value)}" for name, value in edit.move.items() if name != "to"]
        place = f"the frame {to['frame']}" if isinstance(to, dict) else to
        yield f"move to {place}{' with ' if given else ''}{', '.join(given)}"
    if edit.rename:
        yield f"rename to {edit.rename}"


def _flat(written: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    for name, value in written.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield above + name, shown(value)

"""Entries of `edit`: each has a selector, and verbs for the elements that it selects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import Any

from composer.dataclass import dataclass
from composer.recipe.allow import ALLOW, read_codes
from composer.recipe.count import COUNT, read_count
from composer.recipe.edit_schema import OWN, edits
from composer.recipe.fault import EXCLUSIVE, Fault, Path, unknown_key
from composer.recipe.form import Form
from composer.recipe.raw import path_of
from composer.recipe.reference import Schema
from composer.recipe.rows import check_rows
from composer.recipe.select import advice_on_narrowing, read_selector
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.verbs.table import VERBS
from composer.recipe.verbs.values import Checker
from composer.recipe.verbs.verb import Selected
from composer.tree.selector import Selector

KEYS = ("id", "select", *COUNT, *VERBS, "allow", "when")
"""The keys of an entry, in the order in which `fmt` writes them."""
check_rows("the keys of `edit` in composer/recipe/edit_schema.py", [*OWN, *VERBS], KEYS)
_KNOWN = ("select", *VERBS, *COUNT, "id", "allow", "when")
"""The same for messages, which list the first few: what does something comes first."""


@dataclass(frozen=True, slots=True)
class Edit:
    """One entry. `verbs` has the values of the verbs in the order in which they run; `at` is the path to the entry.

    Values are as written: `${…}` in them is evaluated for each element.
    """

    select: Selector
    verbs: Mapping[str, Any] = field(default_factory=dict)
    expect: int | None = None
    optional: bool = False
    at: Path = ()

    @property
    def words(self) -> str:
        """Return the entry on one line, as `plan` prints it."""
        return (
            f"edit {self.select}: {'; '.join(VERBS[name].words(each) for name, each in self.verbs.items())}"
        )


@dataclass(frozen=True, slots=True)
class Edits(Form):
    """Form of a field `edit`: a list of entries, read as a tuple of `Edit`."""

    def schema(self) -> Schema:
        return edits()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Edit, ...]:
        found: list[Edit] = []
        if isinstance(value, list):
            checker = Checker(settings.bare_angles, faults)
            found = [
                edit
                for index, item in enumerate(value)
                if (edit := _edit(item, (index,), checker, faults=faults)) is not None
            ]
        else:
            help = "put `- ` in front of `select`" if isinstance(value, dict) and "select" in value else None
            faults.append(
                Fault("wrong-type", f"`edit` expects a list of entries, got {kind_of(value)}", help=help)
            )
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
    selector = read_selector(value["select"], (*at, "select"), "`select`", faults=faults)
    verbs = [name for name in VERBS if name in value]
    if not verbs and len(faults) == before:
        known = ", ".join(f"`{name}`" for name in VERBS)
        message = "an entry of `edit` says nothing to be done"
        faults.append(Fault("missing-key", message, at, help=f"write one of {known}"))
    alone = next((name for name in verbs if VERBS[name].alone), None)
    if alone is not None and len(verbs) > 1:
        other = next(name for name in verbs if name != alone)
        faults.append(
            Fault(
                EXCLUSIVE,
                f"`{alone}` stands alone, and there is `{other}` as well",
                (*at, alone),
                key=True,
                related=((f"`{other}` is written here", (*at, other)),),
                help=f"leave `{alone}` or `{other}` out",
            )
        )
    read = {name: VERBS[name].read(value[name], Selected(selector, (*at, name), checker)) for name in verbs}
    expect, optional = read_count(value, at, faults)
    if ALLOW in value:
        read_codes(value[ALLOW], (*at, ALLOW), faults)
    if selector is None or len(faults) > before:
        return None
    return Edit(selector, read, expect, optional=optional, at=path_of(value))


def _unknown(value: dict[str, Any], at: Path) -> Iterator[Fault]:
    for name in value:
        if name in KEYS:
            continue
        message = f"`{name}` is not a key of an entry of `edit`"
        fault = unknown_key(message, name, _KNOWN, at=(*at, name))
        elsewhere = advice_on_narrowing(name)
        yield replace(fault, help=elsewhere, fix=None) if elsewhere else fault

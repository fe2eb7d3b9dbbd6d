"""The check `targets`: other programs have everything that the model has, and read it as it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Flag, Key, Keyed, Keys, Kind, Words
from mjcompose.language.form import Schema
from mjcompose.targets.names import LACKING, READ_IN

if TYPE_CHECKING:
    from mjcompose.build.verify.checks import Checks, NestedRecipe
    from mjcompose.sources.context import Context

IN, READ, LOSSES = "in", "read", "losses"
_ERROR, _WARNING = "error", "warning"


@dataclass(frozen=True, slots=True)
class Targets:
    """Nothing of the model is lost when it is written for `targets`, and each reads the model that MuJoCo has.

    With `losses` a warning, a loss is one. Without `read`, no program reads anything. The place of a target is
    `(*at, "targets", *place, INDEX)`.
    """

    word: ClassVar[str] = "targets"
    name: str
    targets: tuple[str, ...]
    read: bool
    losses: str
    place: tuple[str, ...]
    at: Path


class Form:
    """Form of the value: a list of targets, or a mapping."""

    shapes = (list, dict)
    words = Words(LACKING, "target")
    keyed = Keyed(
        "Other programs have everything that the model has, and read back its numbers, poses and motion.",
        Key(IN, words, "the targets", needed="[mjx, drake]"),
        Key(
            READ,
            Flag(),
            "false: only what is lost is checked, and the programs need not be installed",
            default=True,
        ),
        Key(
            LOSSES,
            Words((_ERROR, _WARNING), "keyword"),
            "`warning`: what a target lacks is only a warning",
            default=(_ERROR,),
        ),
    )

    def read(self, keys: Keys) -> dict[str, Any]:
        if isinstance(keys.value, dict):
            return self.keyed.read(keys)
        return {IN: self.words.read(keys, keys.value), READ: True, LOSSES: (_ERROR,)}

    def schema(self) -> Schema:
        schema = self.keyed.schema()
        return {
            "description": schema.pop("description"),
            "anyOf": [self.words.schema()["anyOf"][1], schema],
        }


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Targets | None:
    targets, place = found[IN] or (), (IN,) if isinstance(keys.value, dict) else ()
    for index, name in enumerate(targets):
        if found[READ] and name not in READ_IN:
            message = f"{keys.owner} cannot use `{name}`: no check reads models in it"
            help = f"write `targets: {{in: [{name}], read: false}}`, which checks that nothing is lost"
            keys.add("wrong-keyword", message, *place, index, help=help)
    return Targets(keys.name, targets, found[READ], losses=(*found[LOSSES], _ERROR)[0], place=place, at=at)


KIND = Kind("targets", Form(), make, example="[mjx, drake]", is_in_mujoco=False)


def run(checks: Checks, check: Targets, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Write the model for each target and have it read there; report what is lost or differs to the context."""
    from mjcompose.build.verify.checks import report
    from mjcompose.build.verify.compile import WHOLE
    from mjcompose.targets.read_back import Work, carry_out

    work = Work(checks.bundle, WHOLE, checks.session, environment=context.environment)
    findings, values = carry_out(work, asdict(check))
    for finding in findings:
        report(finding, check, recipe, context=context)
    return values

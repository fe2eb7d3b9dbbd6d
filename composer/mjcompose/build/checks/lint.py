"""The check `lint`: rules that most models should keep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.extensions import Table
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules import inertia_implausible, joint_unactuated, key_out_of_range, shape_off_mesh
from mjcompose.build.checks.rules.rule import Rule
from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import IT
from mjcompose.language.forms.rows import Rows
from mjcompose.language.forms.scalars import Expects, Items, Keywords, Name

_MODULES: Mapping[str, Any] = {
    each.RULE.word: each for each in (inertia_implausible, joint_unactuated, key_out_of_range, shape_off_mesh)
}
RULES: Table[type[Rule]] = Table("rules", {word: each.RULE for word, each in _MODULES.items()}, "RULE")
_EXCEPTED: Table[Any] = Table(
    "rules",
    {
        word: Annotated[
            tuple[Annotated[str, Name(*rule.kinds, glob=True)], ...],
            Items(1, single=True),
            Field(description=f"elements that it ignores: {', '.join(rule.kinds)}"),
        ]
        for word, rule in RULES.items()
    },
    "RULE",
)
_Word = Literal["inertia-implausible", "joint-unactuated", "key-out-of-range", "shape-off-mesh"]
_WithoutSettings = Literal["inertia-implausible", "joint-unactuated", "key-out-of-range"]
"""The rules that run if the recipe selects none: the others need limits."""
_Shape = Discriminator(lambda value: "<mapping>" if isinstance(value, dict | CheckPart) else "<list>")


class SelectedRules(CheckPart):
    """Rules with their settings."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: RULES)] = Field({}, alias="<rules>")


class ExceptedElements(CheckPart):
    """Rules with the elements that they ignore."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: _EXCEPTED)] = Field({}, alias="<rules>")


class Lint(Check):
    """The model keeps rules that most models should keep."""

    word: ClassVar = "lint"
    example: ClassVar = "{except: [joint-unactuated]}"

    select: (
        Annotated[
            Annotated[
                tuple[
                    Annotated[
                        _WithoutSettings,
                        Keywords({"shape-off-mesh": "write `select: {shape-off-mesh: {hausdorff: 0.002}}`"}),
                    ],
                    ...,
                ],
                Items(1),
                Expects("a list of rules", "[joint-unactuated]"),
                Tag("<list>"),
            ]
            | Annotated[SelectedRules, Tag("<mapping>")],
            _Shape,
        ]
        | None
    ) = None
    """the rules, in a list or with their settings; without it, all that need no settings"""
    excepted: (
        Annotated[
            Annotated[tuple[_Word, ...], Items(1), Expects("a list of rules", "[joint-unactuated]"), Tag("<list>")]
            | Annotated[ExceptedElements, Tag("<mapping>")],
            _Shape,
        ]
        | None
    ) = Field(None, alias="except")
    """rules that do not count, in a list, or elements that they ignore"""

    @property
    def selected(self) -> dict[str, Rule]:
        """The rules that `select` means, with their settings."""
        if isinstance(self.select, SelectedRules):
            return dict(self.select.words)
        words = self.select or [word for word, rule in RULES.items() if not rule.limits]
        return {word: RULES[word]() for word in words}

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        selected, excepted = self.selected, self.excepted
        words: Mapping[str, Any] | tuple[str, ...] = (
            excepted.words if isinstance(excepted, ExceptedElements) else excepted or ()
        )
        for index, word in enumerate(words):
            if word not in selected:
                at = ("except", index if isinstance(words, tuple) else word)
                message = f"`except` names the rule `{word}`, which {IT} does not run"
                yield Fault("unknown-key", message, at, help=f"remove `{word}`")
        if isinstance(words, tuple) and {*selected} <= {*words}:
            yield Fault("missing-key", f"{IT} has no rule left", ("except",), help="remove a rule from `except`")

    def asked(self) -> dict[str, Any]:
        ignored: Mapping[str, Any] = (
            self.excepted.words if isinstance(self.excepted, ExceptedElements) else dict.fromkeys(self.excepted or ())
        )
        return {
            "rules": {
                word: {**rule.model_dump(warnings=False), "except": ignored.get(word, ())}
                for word, rule in self.selected.items()
                if ignored.get(word, ()) is not None
            }
        }


KIND = Lint


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return the findings of the rules."""
    findings: list[Fault] = []
    for word, settings in asked["rules"].items():
        values = dict(scope.values)
        told = {**settings, "shapes": asked["shapes"]}
        for finding in _MODULES[word].check(scope, told):
            each = replace(finding, at=_place(word, finding.at))
            if each.code == "check-failed":
                help = each.help or f"fix it, or write `except: {{{word}: [NAME]}}` to accept it"
                each = replace(each, message=f"{each.message} ({word})", help=help)
            findings.append(each)
        new = {key: value for key, value in scope.values.items() if key not in values}
        scope.values.clear()
        scope.values.update({**values, **{f"{word} {key}": value for key, value in new.items()}})
    return findings


def _place(rule: str, at: Path) -> Path:
    """Return the place of a setting of a rule, or of its exceptions."""
    return ("except", rule, *at[1:]) if at[:1] == ("except",) else ("select", rule, *at)

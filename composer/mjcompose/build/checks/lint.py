"""The check `lint`: rules that most models should keep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.extensions import Table
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules import inertia_implausible, joint_unactuated, key_out_of_range, shape_off_mesh
from mjcompose.build.checks.rules.rule import Rule, listed
from mjcompose.build.lint.rule import FAMILIES, Subject, rules, subject_of
from mjcompose.build.lint.rule import Rule as LinterRule
from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.context import Rows, Settings
from mjcompose.language.forms.model import IT
from mjcompose.language.forms.scalars import Expects, Items, Keywords, Name

_MODULES: Mapping[str, Any] = {
    each.RULE.word: each for each in (inertia_implausible, joint_unactuated, key_out_of_range, shape_off_mesh)
}


_PLAIN: Mapping[str, LinterRule] = {
    code: each for code, each in rules().items() if code not in _MODULES and not each.in_files
}
"""The rules of `mjcompose lint` that read no files. They have no settings."""
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
if TYPE_CHECKING:
    _Word: TypeAlias = str
    _WithoutSettings: TypeAlias = str
else:
    _Word = Literal[(*RULES, *_PLAIN)]
    _WithoutSettings = Literal[(*(word for word, rule in RULES.items() if not rule.limits), *FAMILIES, *_PLAIN)]
    """The rules that run if they are selected in a list, and the families: other rules need limits."""
_Shape = Discriminator(lambda value: "<mapping>" if isinstance(value, dict | CheckPart) else "<list>")


def _codes(word: str) -> list[str]:
    return [code for code, each in _PLAIN.items() if each.family == word] if word in FAMILIES else [word]


class SelectedRules(CheckPart):
    """Rules with their settings."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: RULES)] = Field({}, alias="<rules>")


class ExceptedElements(CheckPart):
    """Rules with the elements that they ignore."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: _EXCEPTED)] = Field({}, alias="<rules>")


class Lint(Check):
    """The model follows rules that most models should follow."""

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
    """rules or families as a list, or rules with settings; by default all rules that need no settings"""
    excepted: (
        Annotated[
            Annotated[tuple[_Word, ...], Items(1), Expects("a list of rules", "[joint-unactuated]"), Tag("<list>")]
            | Annotated[ExceptedElements, Tag("<mapping>")],
            _Shape,
        ]
        | None
    ) = Field(None, alias="except")
    """rules to skip, as a list, or the elements that each ignores"""

    @property
    def selected(self) -> dict[str, Rule | None]:
        """The rules that `select` means, with their settings; None for a rule without any."""
        if isinstance(self.select, SelectedRules):
            return dict(self.select.words)
        usual = [word for word, each in _PLAIN.items() if each.usual]
        words = self.select or [*(word for word, rule in RULES.items() if not rule.limits), *usual]
        codes = dict.fromkeys(code for word in words for code in _codes(word))
        return {code: RULES[code]() if code in RULES else None for code in codes}

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
                word: {**({} if rule is None else rule.model_dump(warnings=False)), "except": ignored.get(word, ())}
                for word, rule in self.selected.items()
                if ignored.get(word, ()) is not None
            }
        }


KIND = Lint


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return the findings of the rules."""
    findings: list[Fault] = []
    subject = subject_of(asked["text"], scope.mujoco, scope.model)
    for word, settings in asked["rules"].items():
        values = dict(scope.values)
        told = {**settings, "shapes": asked["shapes"]}
        found = _MODULES[word].check(scope, told) if word in _MODULES else _plain(word, subject, scope)
        for finding in found:
            each = replace(finding, at=_place(word, finding.at))
            if each.code == "check-failed":
                accepts = f"{{{word}: [NAME]}}" if word in RULES else f"[{word}]"
                help = each.help or f"fix it, or write `except: {accepts}` to accept it"
                each = replace(each, message=f"{each.message} ({word})", help=help)
            findings.append(each)
        new = {key: value for key, value in scope.values.items() if key not in values}
        scope.values.clear()
        scope.values.update({**values, **{f"{word} {key}": value for key, value in new.items()}})
    return findings


def _plain(code: str, subject: Subject, scope: Scope) -> list[Fault]:
    """Return the finding of a rule of the linter about the elements of the recipe."""
    lines = []
    for finding in _PLAIN[code].run(subject):
        near = finding.element if finding.element is not None else subject.root
        name = next((str(each.get("name")) for each in (near, *near.iterancestors()) if each.get("name")), "")
        if scope.whole or (name.startswith(scope.prefix) and not name.startswith(tuple(scope.others))):
            lines.append(finding.message)
    scope.found("findings", len(lines))
    return listed(lines, "no findings", str(len(lines)))


def _place(rule: str, at: Path) -> Path:
    """Return the place of a setting of a rule, or of its exceptions."""
    return ("except", rule, *at[1:]) if at[:1] == ("except",) else ("select", rule, *at)

"""The check `lint`: rules that most models should keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules import (
    inertia_implausible,
    joint_unactuated,
    key_out_of_range,
    shape_off_mesh,
)
from mjcompose.build.checks.rules.rule import Rule
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind
from mjcompose.language.form import Schema, kind_of

RULES: Mapping[str, Rule] = {
    each.RULE.word: each.RULE
    for each in (inertia_implausible, joint_unactuated, key_out_of_range, shape_off_mesh)
}
_ALL = [word for word, rule in RULES.items() if not rule.needs]
"""Those that run if the recipe selects none: the others need to be told limits."""


@dataclass(frozen=True, slots=True)
class Lint:
    """Each of `rules` finds nothing. They have their settings, and under `except` globs over elements to ignore."""

    word: ClassVar[str] = "lint"
    name: str
    rules: Mapping[str, Mapping[str, Any]]
    at: Path


def _known(keys: Keys, rule: Any, *at: str | int, key: bool) -> bool:
    """Return whether a rule exists; report it if not."""
    if isinstance(rule, str) and rule in RULES:
        return True
    if not isinstance(rule, str):
        keys.add("wrong-type", f"`{at[0]}` of {keys.owner} expects names of rules, got {kind_of(rule)}", *at)
        return False
    help, fix = advised(rule, RULES)
    note = exists_note("rule", RULES, rule)
    message = f"{keys.owner} knows no rule `{rule}`"
    code = "unknown-key" if key else "wrong-keyword"
    keys.add(code, message, *at, key=key, notes=(note,), help=help, fix=fix)
    return False


@dataclass(frozen=True, slots=True)
class Rules:
    """Form of names of rules: a list, or a mapping to what each is told."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> dict[str, Any]:
        if isinstance(value, dict):
            given = {rule: told for rule, told in value.items() if _known(keys, rule, *at, rule, key=True)}
            return {rule: self.told(keys, rule, told, *at, rule) for rule, told in given.items()}
        if not isinstance(value, list):
            message = f"`{at[-1]}` of {keys.owner} expects a list of rules, got {kind_of(value)}"
            help = (
                f"write `{at[-1]}: [{value}]`"
                if value in RULES
                else f"write for instance `{at[-1]}: [{_ALL[0]}]`"
            )
            keys.add("wrong-type", message, *at, help=help)
            return {}
        rules = [rule for index, rule in enumerate(value) if _known(keys, rule, *at, index, key=False)]
        return {rule: self.alone(keys, rule, *at, value.index(rule)) for rule in rules}

    def alone(self, keys: Keys, rule: str, *at: str | int) -> Any:
        """Return what a rule is told that stands in a list."""
        raise NotImplementedError

    def told(self, keys: Keys, rule: str, value: Any, *at: str | int) -> Any:
        """Return what a rule is told in a mapping."""
        raise NotImplementedError

    def told_schema(self, rule: Rule) -> Schema:
        raise NotImplementedError

    def schema(self) -> Schema:
        listed = [word for word, rule in RULES.items() if not rule.needs or isinstance(self, Excepted)]
        return {
            "anyOf": [
                {"type": "array", "items": {"enum": listed}, "minItems": 1},
                {
                    "type": "object",
                    "properties": {word: self.told_schema(rule) for word, rule in RULES.items()},
                    "additionalProperties": False,
                    "minProperties": 1,
                },
            ]
        }


class Selected(Rules):
    """Form of the rules that run, with their settings."""

    def alone(self, keys: Keys, rule: str, *at: str | int) -> Any:
        if RULES[rule].needs:
            self._needs(keys, rule, *at)
        return RULES[rule].form.read(Keys(keys.name, rule, {}, []))

    def told(self, keys: Keys, rule: str, value: Any, *at: str | int) -> Any:
        if not isinstance(value, dict):
            message = f"`{rule}` of {keys.owner} is a mapping of settings, got {kind_of(value)}"
            keys.add("wrong-type", message, *at, help=f"write for instance `{rule}: {RULES[rule].example}`")
            return {}
        inner = Keys(keys.name, rule, value, faults=[])
        settings = RULES[rule].form.read(inner)
        needs = RULES[rule].needs
        if needs and not inner.faults and not any(each in value for each in needs):
            self._needs(keys, rule, *at)
        RULES[rule].validate(inner, settings)
        keys.faults.extend(
            replace(each, at=(keys.name, keys.word, *at, *each.at[2:])) for each in inner.faults
        )
        return settings

    def _needs(self, keys: Keys, rule: str, *at: str | int) -> None:
        message = f"`{rule}` of {keys.owner} does not say how near"
        help = f"write for instance `select: {{{rule}: {RULES[rule].example}}}`"
        keys.add("missing-key", message, *at, key=True, help=help)

    def told_schema(self, rule: Rule) -> Schema:
        return {**rule.form.schema(), **({"minProperties": 1} if rule.needs else {})}


class Excepted(Rules):
    """Form of the rules that do not run, or of the elements that they ignore."""

    globs = Globs("globs over names of elements")

    def alone(self, keys: Keys, rule: str, *at: str | int) -> Any:
        return None

    def told(self, keys: Keys, rule: str, value: Any, *at: str | int) -> Any:
        return self.globs.read(keys, value, *at)

    def told_schema(self, rule: Rule) -> Schema:
        return {**self.globs.schema(), "description": f"elements that it ignores: {', '.join(rule.kinds)}"}


FORM = Keyed(
    "The model keeps rules that most models should keep.",
    Key(
        "select",
        Selected(),
        "the rules, in a list or with their settings; without it, all that need no settings",
    ),
    Key("except", Excepted(), "rules that do not count, in a list, or elements that they ignore", default={}),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Lint:
    select: Mapping[str, Any] | None = found["select"]
    if select is None:
        select = {rule: RULES[rule].form.read(Keys(keys.name, rule, {}, [])) for rule in _ALL}
    excepted = found["except"] or {}
    for rule in excepted:
        if rule not in select and "select" in keys.value:
            message = f"`except` of {keys.owner} names the rule `{rule}`, which `select` does not"
            keys.add("unknown-key", message, "except", rule, key=True, help=f"remove `{rule}`")
    rules = {
        rule: {**settings, "except": excepted.get(rule) or ()}
        for rule, settings in select.items()
        if rule not in excepted or excepted[rule] is not None
    }
    if not rules:
        keys.add(
            "missing-key", f"`lint` of {keys.owner} has no rule left", help="remove a rule from `except`"
        )
    return Lint(keys.name, rules, at)


KIND = Kind("lint", FORM, make, example="{except: [joint-unactuated]}")


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return what the rules find."""
    findings: list[Fault] = []
    for word, settings in asked["rules"].items():
        rule, values = RULES[word], dict(scope.values)
        told = {**settings, "shapes": asked["shapes"]}
        for finding in rule.check(scope, told):
            each = replace(finding, at=_place(word, finding.at))
            if each.code == "check-failed":
                help = each.help or f"fix it, or write `except: {{{word}: [NAME]}}` if it is meant"
                each = replace(each, message=f"{each.message} ({word})", help=help)
            findings.append(each)
        new = {key: value for key, value in scope.values.items() if key not in values}
        scope.values.clear()
        scope.values.update({**values, **{f"{word} {key}": value for key, value in new.items()}})
    return findings


def _place(rule: str, at: Path) -> Path:
    """Return the place of a setting of a rule, or of what it excepts."""
    return ("except", rule, *at[1:]) if at[:1] == ("except",) else ("select", rule, *at)

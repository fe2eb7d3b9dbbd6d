"""The section `check` of a recipe: which checks there are, and how one is written."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.extensions import Table
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.language.checks.form import Check, Keyed, Keys, Kind
from mjcompose.language.element import path_of
from mjcompose.language.form import Form, Schema, Settings, kind_of

MODULES = {
    "expect": "mjcompose.build.checks.expect",
    "settles": "mjcompose.build.checks.settles",
    "clearance": "mjcompose.build.checks.clearance",
    "reachable": "mjcompose.build.checks.reachable",
    "unchanged": "mjcompose.build.checks.unchanged",
    "budget": "mjcompose.build.checks.budget",
    "targets": "mjcompose.targets.check",
    "lint": "mjcompose.build.checks.lint",
}
"""The module of each check: what it accepts and how it is carried out. A recipe imports those that it writes."""
KINDS: Table[Kind] = Table("checks", {}, "KIND", kind=Kind, modules=MODULES)
_REPLACED = {
    "size": "expect: {attr: nu, equals: 7}",
    "mass": "expect: {attr: mass, range: [LOW, HIGH]}",
    "exists": "expect: {select: {site: NAME}}",
    "equal": "expect: {select: {joint: NAME}, attr: damping, equals: 0.5}",
    "stable": "settles: {key: home}",
    "no_penetration": "clearance: {key: home}",
    "clear": 'clearance: {between: ["arm/**", table], min: 0.02}',
    "limits": "lint: {select: [key-out-of-range]}",
    "actuated": "lint: {select: [joint-unactuated]}",
    "plausible": "lint: {select: [inertia-implausible]}",
    "collision": "lint: {select: {shape-off-mesh: {hausdorff: 0.002}}}",
    "runs_on": "targets: {in: [mjx], read: false}",
    "loads": "targets: {in: [mjx], losses: warning}",
}
"""Words that people may know, and what says the same."""
SEVERITY = "severity"
SEVERITIES = ("error", "warning")


@dataclass(frozen=True, slots=True)
class Checks(Form):
    """Form of the field `check`: a mapping from names to `{KIND: {…}}`, read as a tuple of checks."""

    def schema(self) -> Schema:
        kinds: dict[str, Any] = {"type": "object", "additionalProperties": False, "minProperties": 1}
        kinds["properties"] = {word: KINDS[word].form.schema() for word in KINDS}
        kinds["properties"][SEVERITY] = {
            "enum": list(SEVERITIES),
            "default": "error",
            "description": "whether the build fails if the check does not hold, or only warns",
        }
        return {"type": "object", "additionalProperties": kinds}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Check, ...]:
        found: list[Check] = []
        if isinstance(value, dict):
            found = [check for name, item in value.items() for check in _read(name, item, faults)]
        else:
            message = f"`check` expects a mapping from names to checks, got {kind_of(value)}"
            help = "give each a name: `check: {whole: {unchanged: {}}}`"
            faults.append(Fault("wrong-type", message, help=help))
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
    elif not any(word != SEVERITY for word in value):
        help = "write for instance `unchanged: {}` beside it"
        faults.append(Fault("missing-key", f"{owner} checks nothing", (name,), help=help))
    if name in KINDS and not any(word in (*KINDS, "when") for word in value):
        first = next(iter(value), None)
        if first is not None:
            message = f"`{first}` in {owner} is not a kind of check: `{name}` is the name of this check"
            faults.append(Fault("unknown-key", message, (name, first), key=True, help=_named(name)))
        return
    _check_severity(value, owner, (name,), faults=faults)
    for word, given in value.items():
        if word == SEVERITY:
            continue
        if word not in KINDS:
            faults.append(_unknown_kind(word, owner, (name, word)))
        elif not isinstance(given, (kind := KINDS[word]).form.shapes):
            shapes = " or a ".join("mapping" if each is dict else "list" for each in kind.form.shapes)
            message = f"`{word}` of {owner} is a {shapes}, got {kind_of(given)}"
            help = f"write for instance `{word}: {_alone(given, kind) or kind.example}`"
            faults.append(Fault("wrong-type", message, (name, word), help=help))
        else:
            keys, before = Keys(name, word, given, faults=faults), len(faults)
            check = kind.make(keys, kind.form.read(keys), path_of(value))
            if check is not None and len(faults) == before:
                yield check


def _alone(given: Any, kind: Kind) -> str | None:
    return kind.form.alone(given) if isinstance(kind.form, Keyed) else None


def _check_severity(value: dict[str, Any], owner: str, at: Path, faults: list[Fault]) -> None:
    if SEVERITY not in value or value[SEVERITY] in SEVERITIES:
        return
    given = value[SEVERITY]
    near = closest(given, SEVERITIES) if isinstance(given, str) else []
    message = f"`{SEVERITY}` of {owner} is `error` or `warning`, got {kind_of(given)}"
    help = f"write `{SEVERITY}: {near[0] if near else 'warning'}`"
    faults.append(Fault("wrong-keyword", message, (*at, SEVERITY), help=help))


def _named(word: str) -> str:
    """Return what to write if a kind of check is used as a name."""
    return f"the key is a name that you choose: write `NAME: {{{word}: {KINDS[word].example}}}`"


def _unknown_kind(key: str, owner: str, at: Path) -> Fault:
    help, fix = advised(key, (*KINDS, SEVERITY, "when"))
    if key in _REPLACED:
        help, fix = f"write `{_REPLACED[key]}`", None
    return Fault(
        "unknown-key",
        f"`{key}` in {owner} is not a kind of check",
        at,
        key=True,
        notes=(exists_note("check kind", KINDS, key),),
        help=help,
        fix=fix,
    )

"""The check `collision`, of what was measured when the shapes were made."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.build.checks.check import Scope, failed

_LENGTHS = {
    "hausdorff": "is {} m off",
    "beyond": "reaches {} m out of the mesh",
    "short": "leaves the mesh {} m outside",
}
_SHOWN = 8


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return a finding for each measure beyond its limit, with the worst meshes."""
    made = [each for each in asked["made"] if each["mesh"].startswith(scope.prefix)]
    names = [each["mesh"].removeprefix(scope.prefix) for each in made]
    chosen: set[str] = set() if asked["meshes"] else set(names)
    for at, glob in enumerate(asked["meshes"]):
        fitting = scope.fitting(glob, names)
        if not fitting:
            message = f"nothing was made of a mesh `{glob}`"
            notes = (exists_note("mesh", sorted(set(names)), glob),)
            return [
                Fault("unknown-name", message, ("meshes", at), notes=notes, help=did_you_mean(glob, names))
            ]
        chosen |= fitting
    found = [(name, each) for name, each in zip(names, made, strict=True) if name in chosen]
    if not found:
        message = "no `collision` or `simplify` made anything of a mesh"
        return [failed(message, "at least one mesh", "none")]
    scope.found("meshes", len(found))
    findings = []
    for measure, words in _LENGTHS.items():
        worst = max(each[measure] for _, each in found)
        scope.found(measure, worst)
        if asked[measure] is not None:
            wrong = [(each[measure], name) for name, each in found if each[measure] > asked[measure]]
            findings += _failed(wrong, words, f"at most {asked[measure]:g} m", measure=measure)
    covered = [(each["uncovered"], name) for name, each in found if each["uncovered"] is not None]
    if covered:
        scope.found("uncovered", max(covered)[0])
    if asked["uncovered"] is not None:
        wrong = [each for each in covered if each[0] > asked["uncovered"]]
        words = "leaves {} of the surface outside"
        findings += _failed(wrong, words, f"at most {asked['uncovered']:g}", measure="uncovered")
    if asked["volume"] is not None:
        findings += _volumes(found, *asked["volume"])
    return findings


def _volumes(found: list[tuple[str, dict[str, Any]]], low: float, high: float) -> list[Fault]:
    expected = f"{low:g} to {high:g}"
    open_ones = [name for name, each in found if each["volume"] is None]
    if open_ones:
        message = f"the mesh `{open_ones[0]}` is open: it has no volume to compare with"
        more = [f"so is `{name}`" for name in open_ones[1:_SHOWN]]
        help = "close the meshes, or name the others by `meshes`"
        return [failed(message, expected, "unknown", "volume", more=more, help=help)]
    wrong = [(each["volume"], name) for name, each in found if not low <= each["volume"] <= high]
    return _failed(wrong, "has {} of the volume", expected, measure="volume")


def _failed(wrong: list[tuple[float, str]], words: str, expected: str, measure: str) -> list[Fault]:
    if not wrong:
        return []
    ranked = sorted(wrong, reverse=True)
    lines = [f"what was made of `{name}` {words.format(f'{value:.4g}')}" for value, name in ranked]
    more = lines[1:_SHOWN] + ([f"and {len(lines) - _SHOWN} more"] if len(lines) > _SHOWN else [])
    return [failed(lines[0], expected, f"{ranked[0][0]:.4g}", measure, more=more)]

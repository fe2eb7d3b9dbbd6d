"""Rule `shape-off-mesh`: shapes that the verbs `collision` and `simplify` put instead of meshes are close to them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.build.checks.check import Scope, failed
from mjcompose.build.checks.rules.rule import SHOWN, Rule, listed
from mjcompose.language.forms.model import AnyOf
from mjcompose.language.forms.scalars import LENGTHS, Expects, Items, Name, NotNegative, Range, Scaled

_Length = Annotated[float, Scaled(LENGTHS, ge=0)]
_LIMITS = ("hausdorff", "beyond", "short", "uncovered", "volume")


class ShapeOffMesh(Rule):
    """Shapes and meshes from `collision` and `simplify` are close to the original meshes."""

    word: ClassVar = "shape-off-mesh"
    kinds: ClassVar = ("mesh",)
    limits: ClassVar = _LIMITS
    example: ClassVar = "{hausdorff: 0.002}"
    instead: ClassVar = {"meshes": "mesh"}
    rules: ClassVar = (
        AnyOf(*_LIMITS, lacks="does not say how near", advice="write for instance `hausdorff: 0.002`, in meters"),
    )

    mesh: Annotated[tuple[Annotated[str, Name("mesh", glob=True)], ...], Items(1, single=True)] = ()
    """the meshes; by default all"""
    hausdorff: _Length | None = None
    """the largest distance between the two surfaces, in meters"""
    beyond: _Length | None = None
    """the largest distance that the shapes may reach out of the mesh, in meters"""
    shortfall: _Length | None = Field(None, alias="short")
    """the largest distance that the mesh may reach out of the shapes, in meters"""
    uncovered: NotNegative | None = None
    """the largest share of the mesh's surface outside the shapes"""
    volume: Annotated[Range, Expects("a list of 2 numbers", "[0.9, 1.2]")] | None = None
    """the least and the largest volume, relative to the mesh's"""


RULE = ShapeOffMesh
_FIELDS = {"short": "shortfall"}
_LENGTHS = {
    "hausdorff": "is {} m off",
    "beyond": "reaches {} m out of the mesh",
    "short": "leaves the mesh {} m outside",
}


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Return a finding for each measure beyond its limit, with the worst meshes."""
    made = [each for each in settings["shapes"] if each["mesh"].startswith(scope.prefix)]
    pairs = [(each["mesh"].removeprefix(scope.prefix), each) for each in made]
    names = [name for name, _ in pairs]
    for key in ("mesh", "except"):
        for at, glob in enumerate(settings[key]):
            if not scope.fitting(glob, names):
                message = f"nothing was made of a mesh `{glob}`"
                notes = (exists_note("mesh", sorted(set(names)), glob),)
                help = did_you_mean(glob, names)
                return [Fault("unknown-name", message, (key, at), notes=notes, help=help)]
    fitting = {
        key: {name for glob in settings[key] for name in scope.fitting(glob, names)} for key in ("mesh", "except")
    }
    meant = [each for each in pairs if each[0] in (fitting["mesh"] or names) and each[0] not in fitting["except"]]
    if not meant:
        return [failed("no `collision` or `simplify` made anything of a mesh", "at least one mesh", "none")]
    scope.found("meshes", len(meant))
    findings = []
    for measure, words in _LENGTHS.items():
        scope.found(measure, max(each[measure] for _, each in meant))
        if (most := settings[_FIELDS.get(measure, measure)]) is not None:
            wrong = [(each[measure], name) for name, each in meant if each[measure] > most]
            findings += _failed(wrong, words, f"at most {most:g} m", measure=measure)
    covered = [(each["uncovered"], name) for name, each in meant if each["uncovered"] is not None]
    if covered:
        scope.found("uncovered", max(covered)[0])
    if (most := settings["uncovered"]) is not None:
        wrong = [each for each in covered if each[0] > most]
        findings += _failed(wrong, "leaves {} of the surface outside", f"at most {most:g}", measure="uncovered")
    if settings["volume"] is not None:
        findings += _volumes(meant, *settings["volume"])
    return findings


def _volumes(meant: list[tuple[str, dict[str, Any]]], low: float, high: float) -> list[Fault]:
    expected = f"{low:g} to {high:g}"
    open_ones = [name for name, each in meant if each["volume"] is None]
    if open_ones:
        message = f"the mesh `{open_ones[0]}` is open: it has no volume to compare with"
        more = [f"so is `{name}`" for name in open_ones[1:SHOWN]]
        help = "close the meshes, or name the others by `mesh`"
        return [failed(message, expected, "unknown", "volume", more=more, help=help)]
    wrong = [(each["volume"], name) for name, each in meant if not low <= each["volume"] <= high]
    return _failed(wrong, "has {} of the volume", expected, measure="volume")


def _failed(wrong: list[tuple[float, str]], words: str, expected: str, measure: str) -> list[Fault]:
    ranked = sorted(wrong, reverse=True)
    lines = [f"the shape of `{name}` {words.format(f'{value:.4g}')}" for value, name in ranked]
    return listed(lines, expected, f"{ranked[0][0]:.4g}" if ranked else "", measure)

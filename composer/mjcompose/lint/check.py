"""The check `lint`: rules that most models should keep."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.report import with_rest
from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.context import Rows, Settings
from mjcompose.language.forms.model import IT, AnyOf
from mjcompose.language.forms.scalars import (
    LENGTHS,
    Expects,
    Hints,
    Items,
    Name,
    NotNegative,
    NumberUnit,
    Positive,
    Range,
    Scaled,
)
from mjcompose.lint.rule import FAMILIES, Subject, rules, subject_of
from mjcompose.mujoco.arrays import HINGE, SLIDE
from mjcompose.mujoco.solids import Shapes, faults, largest_volume
from mjcompose.verify.checks.check import CheckEnds, Scope, at_keys, check_globs, failed, keys_named, names_nothing


class RuleSettings(CheckPart):
    """The settings of a rule, and the `kinds` that `except` can name. With `limits`, it runs only if one is written."""

    word: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    limits: ClassVar[tuple[str, ...]] = ()
    example: ClassVar = "{}"

    @staticmethod
    @abstractmethod
    def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
        """Return the findings for the settings."""


def chosen(scope: Scope, kind: str, settings: Mapping[str, Any], usual: Iterable[int]) -> list[int]:
    """Return the elements that the setting of their kind names, by default the usual ones, without excepted ones."""
    globs: Sequence[str] = settings[kind]
    check_globs(scope, (kind,), globs, at=(kind,))
    named = dict.fromkeys(each for glob in globs for each in scope.matching(kind, glob)) if globs else usual
    ignored = excepted(scope, (kind,), settings)
    return [each for each in named if (kind, each) not in ignored]


def excepted(scope: Scope, kinds: Sequence[str], settings: Mapping[str, Any]) -> set[tuple[str, int]]:
    check_globs(scope, kinds, settings["except"], at=("except",))
    return {(kind, each) for glob in settings["except"] for kind in kinds for each in scope.matching(kind, glob)}


def listed(lines: Sequence[str], expected: str, actual: str, *at: str | int) -> list[Fault]:
    """Return one finding for lines, the first of them as its message; nothing without lines."""
    if not lines:
        return []
    first, *more = with_rest(lines)
    return [failed(first, expected, actual, *at, more=more)]


class InertiaImplausible(RuleSettings):
    """Each body has a mass and an inertia that its geoms can have."""

    word: ClassVar = "inertia-implausible"
    kinds: ClassVar = ("body",)
    instead: ClassVar = {"bodies": "body"}

    body: Annotated[tuple[Annotated[str, Name("body", glob=True)], ...], Items(1, single=True)] = ()
    """the bodies; by default all with a mass and geoms"""
    density: Annotated[Range, Expects("a list of 2 numbers", "[100, 9000]"), NumberUnit("kg/m³")] | None = None
    """the smallest and largest density, in kg/m³; by default any"""
    gyration: Positive = 1.0
    """the largest radius of gyration, relative to the distance of the farthest point from the center of mass"""
    outside: NotNegative = 0.02
    """the allowed distance of the center of mass outside the box around the geoms, relative to the box's diagonal"""

    @staticmethod
    def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
        shapes = Shapes(scope.mujoco, scope.model)
        named = chosen(scope, "body", settings, usual=scope.own("body"))
        bodies = [each for each in named if each and scope.model.body_mass[each] > 0 and shapes.welded(each)]
        wrong = [
            f"{scope.called('body', body)}: {each}"
            for body in bodies
            for each in _faults(scope, shapes, body, settings=settings)
        ]
        scope.found("bodies", len(bodies))
        scope.found("implausible", len(wrong))
        actual = f"{len(wrong)} fault{'s' * (len(wrong) > 1)} in {len(bodies)} bodies"
        return listed(wrong, "masses and inertias that the geoms could have", actual)


def _faults(scope: Scope, shapes: Shapes, body: int, settings: Mapping[str, Any]) -> Iterator[str]:
    yield from faults(shapes, body, gyration=settings["gyration"], outside=settings["outside"])
    own = shapes.own(body)
    if settings["density"] is not None and own:
        mass = float(scope.model.body_mass[body])
        volume = largest_volume(scope.mujoco, scope.model, own)
        low, high = settings["density"]
        weighs = f"it weighs {mass:.4g} kg, which is {{:.4g}} kg/m³ of the volume of its geoms, {{}}"
        if volume.most > 0 and mass / volume.most > high:
            yield weighs.format(mass / volume.most, f"above {high:g}")
        elif volume.least > 0 and mass / volume.least < low:
            yield weighs.format(mass / volume.least, f"below {low:g}")


class JointUnactuated(RuleSettings):
    """An actuator moves every joint, directly or through a tendon or an equality."""

    word: ClassVar = "joint-unactuated"
    kinds: ClassVar = ("joint",)
    instead: ClassVar = {"joints": "joint"}

    joint: Annotated[tuple[Annotated[str, Name("joint", glob=True)], ...], Items(1, single=True)] = ()
    """the joints; by default all hinges and slides"""

    @staticmethod
    def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
        mujoco = scope.mujoco
        model = scope.model
        single = (joint for joint in scope.own("joint") if int(model.jnt_type[joint]) in (HINGE, SLIDE))
        joints = chosen(scope, "joint", settings, usual=single)
        moved = _moved(mujoco, model)
        without = [joint for joint in joints if joint not in moved]
        scope.found("joints", len(joints))
        lines = [f"{scope.called('joint', joint)} has no actuator" for joint in without]
        return listed(lines, f"{len(joints)} joints moved", f"{len(joints) - len(without)}")


def _moved(mujoco: Any, model: MjModel) -> set[int]:
    """Return the joints that an actuator moves in the reference configuration, directly or through an equality."""
    import numpy as np

    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    dofs = set(np.asarray(data.moment_colind[: int(np.sum(data.moment_rownnz))]).tolist())
    moved = {int(model.dof_jntid[dof]) for dof in dofs}
    is_joint = (model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)) & (model.eq_obj2id >= 0)
    coupled = list(zip(model.eq_obj1id[is_joint].tolist(), model.eq_obj2id[is_joint].tolist(), strict=True))
    for _ in coupled:
        for one, other in coupled:
            if one in moved or other in moved:
                moved |= {one, other}
    return moved


class KeyOutOfRange(RuleSettings):
    """In keyframes, positions, controls and activations are within their ranges."""

    word: ClassVar = "key-out-of-range"
    kinds: ClassVar = ("joint", "actuator")
    instead: ClassVar = {"keys": "key"}

    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes; by default all"""
    margin: NotNegative = 0.0
    """the smallest distance to both ends, in the unit of each range"""

    @staticmethod
    def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
        from mjcompose.mujoco.index import index, ranged

        keys = keys_named(scope, settings["key"])
        margin = settings["margin"]
        ignored = excepted(scope, KeyOutOfRange.kinds, settings)
        outside: list[str] = []
        count = 0
        compiled = index(scope.model, scope.mujoco)
        for name, data in at_keys(scope, keys):
            for each in ranged(compiled, {"qpos": data.qpos, "ctrl": data.ctrl, "act": data.act}):
                if (each.kind, each.number) in ignored or not scope.owns(each.kind, each.number):
                    continue
                count += 1
                if not each.is_within(margin):
                    low, high = each.range
                    unit = f" {each.unit}" if each.kind == "joint" else ""
                    where = f"`{each.vector}` of {scope.called(each.kind, each.number)} in `{name}`"
                    number = f"{each.value:.6g}{unit}"
                    ends = f"{low:.6g} to {high:.6g}"
                    outside.append(f"{where} is {number}, and its range is from {ends}")
        scope.found("values", count)
        ends = f", {margin:g} from both ends" if margin else ""
        return listed(outside, f"all within their ranges{ends}", f"{len(outside)} outside")


_Length = Annotated[float, Scaled(LENGTHS, ge=0)]
_LIMITS = ("hausdorff", "beyond", "short", "uncovered", "volume")
_LENGTHS = {
    "hausdorff": "is {} m off",
    "beyond": "reaches {} m out of the mesh",
    "short": "leaves the mesh {} m outside",
}


class ShapeOffMesh(RuleSettings):
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
    """the largest allowed distance of the shapes outside the mesh, in meters"""
    shortfall: _Length | None = Field(None, alias="short")
    """the largest allowed distance of the mesh outside the shapes, in meters"""
    uncovered: NotNegative | None = None
    """the largest share of the mesh's surface outside the shapes"""
    volume: Annotated[Range, Expects("a list of 2 numbers", "[0.9, 1.2]")] | None = None
    """the least and the largest volume, relative to the mesh's"""

    @staticmethod
    def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
        made = [each for each in settings["shapes"] if each["mesh"].startswith(scope.prefix)]
        pairs = [(each["mesh"].removeprefix(scope.prefix), each) for each in made]
        names = [name for name, _ in pairs]
        fitting: dict[str, set[str]] = {"mesh": set(), "except": set()}
        for key, found in fitting.items():
            for at, glob in enumerate(settings[key]):
                if not (fits := scope.fitting(glob, names)):
                    message = f"nothing was made of a mesh `{glob}`"
                    known = sorted(set(names))
                    raise names_nothing(message, glob, "mesh", known=known, at=(key, at))
                found |= fits
        meant = [each for each in pairs if each[0] in (fitting["mesh"] or names) and each[0] not in fitting["except"]]
        if not meant:
            return [failed("no `collision` or `simplify` made anything of a mesh", "at least one mesh", "none")]
        scope.found("meshes", len(meant))
        findings = []
        for measure, words in _LENGTHS.items():
            scope.found(measure, max(each[measure] for _, each in meant))
            if (most := settings["shortfall" if measure == "short" else measure]) is not None:
                wrong = [(each[measure], name) for name, each in meant if each[measure] > most]
                findings += _failed(wrong, words, f"at most {most:g} m", measure=measure)
        if covered := [(each["uncovered"], name) for name, each in meant if each["uncovered"] is not None]:
            scope.found("uncovered", max(covered)[0])
        if (most := settings["uncovered"]) is not None:
            wrong = [each for each in covered if each[0] > most]
            findings += _failed(wrong, "leaves {} of the surface outside", f"at most {most:g}", measure="uncovered")
        if settings["volume"] is not None:
            findings += _volumes(meant, *settings["volume"])
        return findings


def _volumes(meant: list[tuple[str, dict[str, Any]]], low: float, high: float) -> list[Fault]:
    expected = f"{low:g} to {high:g}"
    if open_ones := [name for name, each in meant if each["volume"] is None]:
        message = f"the mesh `{open_ones[0]}` is open: it has no volume to compare with"
        more = [f"so is `{name}`" for name in open_ones[1:8]]
        help = "close the meshes, or name the others by `mesh`"
        return [failed(message, expected, "unknown", "volume", more=more, help=help)]
    wrong = [(each["volume"], name) for name, each in meant if not low <= each["volume"] <= high]
    return _failed(wrong, "has {} of the volume", expected, measure="volume")


def _failed(wrong: list[tuple[float, str]], words: str, expected: str, measure: str) -> list[Fault]:
    ranked = sorted(wrong, reverse=True)
    lines = [f"the shape of `{name}` {words.format(f'{value:.4g}')}" for value, name in ranked]
    return listed(lines, expected, f"{ranked[0][0]:.4g}" if ranked else "", measure)


RULES: ExtensionTable[type[RuleSettings]] = ExtensionTable(
    "rules", {each.word: each for each in (InertiaImplausible, JointUnactuated, KeyOutOfRange, ShapeOffMesh)}, "RULE"
)
_PLAIN = {code: each for code, each in rules().items() if code not in RULES and not each.in_files}
"""The rules of `mjcompose lint` that read no files. They have no settings."""


def _globs(kinds: tuple[str, ...]) -> Any:
    """Return the form of one glob or several over the names of elements."""
    about = Field(description=f"elements that it ignores: {', '.join(kinds)}")
    return Annotated[tuple[Annotated[str, Name(*kinds, glob=True)], ...], Items(1, single=True), about]


_EXCEPTED: ExtensionTable[Any] = ExtensionTable(
    "rules", {word: _globs(rule.kinds) for word, rule in RULES.items()}, "RULE"
)
if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

    _Word: TypeAlias = str
    _WithoutSettings: TypeAlias = str
else:
    _Word = Literal[(*RULES, *_PLAIN)]
    _WithoutSettings = Literal[(*(word for word, rule in RULES.items() if not rule.limits), *FAMILIES, *_PLAIN)]
    """The rules that run if they are selected in a list, and the families: other rules need limits."""
_Shape = Discriminator(lambda value: "<mapping>" if isinstance(value, dict | CheckPart) else "<list>")


class SelectedRules(CheckPart):
    """Rules with their settings."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: RULES)] = Field({}, alias="<rules>")


class ExceptedElements(CheckPart):
    """Rules with the elements that they ignore."""

    noun: ClassVar = "rule"
    words: Annotated[Mapping[str, Any], Rows(lambda: _EXCEPTED)] = Field({}, alias="<rules>")


_Mapping = Tag("<mapping>")
_List = Tag("<list>")
_Rules = Expects("a list of rules", "[joint-unactuated]")
_NeedsLimits = Hints({"shape-off-mesh": "write `select: {shape-off-mesh: {hausdorff: 0.002}}`"})
_Listed = Annotated[tuple[Annotated[_WithoutSettings, _NeedsLimits], ...], Items(1), _Rules, _List]
_Selected = Annotated[_Listed | Annotated[SelectedRules, _Mapping], _Shape]
_Names = Annotated[tuple[_Word, ...], Items(1), _Rules, _List]
_Excepted = Annotated[_Names | Annotated[ExceptedElements, _Mapping], _Shape]


class Lint(Check):
    """The model follows rules that most models should follow."""

    word: ClassVar = "lint"
    example: ClassVar = "{except: [joint-unactuated]}"

    select: _Selected | None = None
    """rules or families as a list, or rules with settings; by default all rules that need no settings"""
    excepted: _Excepted | None = Field(None, alias="except")
    """rules to skip, as a list, or the elements that each ignores"""

    @property
    def selected(self) -> dict[str, RuleSettings | None]:
        """The rules that `select` selects, with their settings; None for a rule without settings."""
        if isinstance(self.select, SelectedRules):
            return dict(self.select.words)
        usual = [word for word, each in _PLAIN.items() if each.usual]
        words = self.select or [*(word for word, rule in RULES.items() if not rule.limits), *usual]
        families = {word: [code for code, each in _PLAIN.items() if each.family == word] for word in FAMILIES}
        codes = dict.fromkeys(code for word in words for code in families.get(word, (word,)))
        return {code: RULES[code]() if code in RULES else None for code in codes}

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        selected = self.selected
        excepted = self.excepted
        words = excepted.words if isinstance(excepted, ExceptedElements) else excepted or ()
        for index, word in enumerate(words):
            if word not in selected:
                at = ("except", index if isinstance(words, tuple) else word)
                message = f"`except` names the rule `{word}`, which {IT} does not run"
                yield Fault("unknown-key", message, at, help=f"remove `{word}`")
        if isinstance(words, tuple) and {*selected} <= {*words}:
            yield Fault("missing-key", f"{IT} has no rule left", ("except",), help="remove a rule from `except`")

    def asked(self) -> dict[str, Any]:
        excepted = self.excepted
        ignored = excepted.words if isinstance(excepted, ExceptedElements) else dict.fromkeys(excepted or ())
        rules = {word: each for word, each in self.selected.items() if ignored.get(word, ()) is not None}
        settings = {word: {} if each is None else each.model_dump(warnings=False) for word, each in rules.items()}
        return {"rules": {word: {**each, "except": ignored.get(word, ())} for word, each in settings.items()}}


KIND = Lint


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    findings: list[Fault] = []
    subject = subject_of(asked["text"], scope.mujoco, scope.model)
    for word, settings in asked["rules"].items():
        values = dict(scope.values)
        told = {**settings, "shapes": asked["shapes"]}
        try:
            found = RULES[word].check(scope, told) if word in RULES else _plain(word, subject, scope)
        except CheckEnds as end:
            found = [end.fault]
        for finding in found:
            key, *below = finding.at if finding.at[:1] == ("except",) else ("select", *finding.at)
            each = replace(finding, at=(key, word, *below))
            if each.code == "check-failed":
                accepts = f"{{{word}: [NAME]}}" if word in RULES else f"[{word}]"
                help = each.help or f"fix it, or write `except: {accepts}` to accept it"
                each = replace(each, message=f"{each.message} ({word})", help=help)
            findings.append(each)
        named = {key if key in values else f"{word} {key}": value for key, value in scope.values.items()}
        scope.values.clear()
        scope.values.update(named)
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

"""The form of the check `lint`: rules that most models should keep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import ExtensionTable
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
from mjcompose.language.lint_rules import FAMILY_RULES, SELECTED_BY_NAME


class RuleSettings(CheckPart):
    """The settings of a rule, and the `kinds` that `except` can name. With `limits`, it runs only if one is written."""

    word: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    limits: ClassVar[tuple[str, ...]] = ()
    example: ClassVar = "{}"


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


class JointUnactuated(RuleSettings):
    """An actuator moves every joint, directly or through a tendon or an equality."""

    word: ClassVar = "joint-unactuated"
    kinds: ClassVar = ("joint",)
    instead: ClassVar = {"joints": "joint"}

    joint: Annotated[tuple[Annotated[str, Name("joint", glob=True)], ...], Items(1, single=True)] = ()
    """the joints; by default all hinges and slides"""


class KeyOutOfRange(RuleSettings):
    """In keyframes, positions, controls and activations are within their ranges."""

    word: ClassVar = "key-out-of-range"
    kinds: ClassVar = ("joint", "actuator")
    instead: ClassVar = {"keys": "key"}

    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes; by default all"""
    margin: NotNegative = 0.0
    """the smallest distance to both ends, in the unit of each range"""


_Length = Annotated[float, Scaled(LENGTHS, ge=0)]
_LIMITS = ("hausdorff", "beyond", "short", "uncovered", "volume")


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


RULES: ExtensionTable[type[RuleSettings]] = ExtensionTable(
    "rules", {each.word: each for each in (InertiaImplausible, JointUnactuated, KeyOutOfRange, ShapeOffMesh)}, "RULE"
)
PLAIN = [code for codes in FAMILY_RULES.values() for code in codes if code not in RULES]
"""The rules of `mjcompose lint` that read no files. They have no settings."""


def _globs(kinds: tuple[str, ...]) -> Any:
    """Return the form of one glob or several over the names of elements."""
    about = Field(description=f"elements that it ignores: {', '.join(kinds)}")
    return Annotated[tuple[Annotated[str, Name(*kinds, glob=True)], ...], Items(1, single=True), about]


_EXCEPTED: ExtensionTable[Any] = ExtensionTable(
    "rules", {word: _globs(rule.kinds) for word, rule in RULES.items()}, "RULE"
)
if TYPE_CHECKING:
    _Word: TypeAlias = str
    _WithoutSettings: TypeAlias = str
else:
    _Word = Literal[(*RULES, *PLAIN)]
    _WithoutSettings = Literal[(*(word for word, rule in RULES.items() if not rule.limits), *FAMILY_RULES, *PLAIN)]
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
    reads_text: ClassVar = True
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
        usual = [code for code in PLAIN if code not in SELECTED_BY_NAME]
        words = self.select or [*(word for word, rule in RULES.items() if not rule.limits), *usual]
        families = {family: [code for code in codes if code in PLAIN] for family, codes in FAMILY_RULES.items()}
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

    @property
    def ignored(self) -> Mapping[str, Sequence[str] | None]:
        """The elements that each rule ignores, by its word; None for a rule that does not run."""
        excepted = self.excepted
        return excepted.words if isinstance(excepted, ExceptedElements) else dict.fromkeys(excepted or ())


KIND = Lint

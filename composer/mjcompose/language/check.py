"""The section `check` of a recipe: the kinds of checks, and their forms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, PrivateAttr

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.extensions import ExtensionTable
from mjcompose.language.element import path_of
from mjcompose.language.forms.context import Rows, Schema, Settings
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import Turns, When

_OWN = (
    "expect",
    "settles",
    "clearance",
    "reachable",
    "unchanged",
    "budget",
    "targets",
    "moves_alike",
    "tracks",
    "lint",
)
SEVERITY = "severity"


class CheckPart(Model):
    """A mapping inside a check: at `check.NAME.WORD`, or below it."""

    @classmethod
    def subject(cls, at: Path) -> str:
        return f"`{at[-1]}` of check `{at[1]}`" if len(at) > 2 else super().subject(at)

    @classmethod
    def owner(cls, at: Path) -> str:
        return f"check `{at[1]}`" if len(at) > 1 else super().owner(at)


class Check(CheckPart):
    """The form of the value behind the word of a check.

    A check that `needs_world` is about points in the world of its recipe, and cannot run in a nested recipe whose place
    is unknown. One that `reads_text` reads the XML of the model, too. The effect of a check that `is_in_mujoco` is a
    function `check`, which runs next to the compiled model; the effect of any other check is a function `run`.
    """

    keeps_written: ClassVar[bool] = True

    word: ClassVar[str]
    needs_world: ClassVar[bool] = False
    reads_text: ClassVar[bool] = False
    is_in_mujoco: ClassVar[bool] = True
    _written: Any = PrivateAttr(None)

    @property
    def files(self) -> tuple[str, ...]:
        """The files that the check reads, relative to its recipe."""
        return ()

    @property
    def name(self) -> str:
        return str(self.at[-2])

    @property
    def written(self) -> Any:
        """The value as the recipe writes it, which the form reads again in another process."""
        return self._written


KINDS: ExtensionTable[type[Check]] = ExtensionTable(
    "checks",
    {},
    "KIND",
    kind=type,
    modules={word: f"mjcompose.language.checks.{word}" for word in _OWN},
    effects=("check", "run"),
)
"""All checks: the form of each value. One of ours is imported when a recipe writes it.

`mjcompose.homes` has the effects.
"""
_INSTEAD = {
    "size": "write `expect: {attr: nu, equals: 7}`",
    "mass": "write `expect: {attr: mass, range: [LOW, HIGH]}`",
    "exists": "write `expect: {select: {site: NAME}}`",
    "equal": "write `expect: {select: {joint: NAME}, attr: damping, equals: 0.5}`",
    "stable": "write `settles: {key: home}`",
    "no_penetration": "write `clearance: {key: home}`",
    "clear": 'write `clearance: {between: ["arm/**", table], min: 0.02}`',
    "limits": "write `lint: {select: [key-out-of-range]}`",
    "actuated": "write `lint: {select: [joint-unactuated]}`",
    "plausible": "write `lint: {select: [inertia-implausible]}`",
    "collision": "write `lint: {select: {shape-off-mesh: {hausdorff: 0.002}}}`",
    "runs_on": "write `targets: {in: [mjx], read: false}`",
    "loads": "write `targets: {in: [mjx], losses: warning}`",
}
"""Words of other versions, with help."""


class _SaysSomething:
    """A check has a kind. If the name of a check is a kind, the name itself is probably missing."""

    alone = True

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        at = path_of(value)
        name = str(at[-1]) if at else ""
        if name in KINDS and not any(word in KINDS for word in value):
            help = f"the key is a name that you choose: write `NAME: {{{name}: {KINDS[name].example}}}`"
            first = next(iter(value), None)
            if first is None:
                yield Fault("missing-key", f"{IT} checks nothing", help=help)
            else:
                message = f"`{first}` in {IT} is not a kind of check: `{name}` is the name of this check"
                yield Fault("unknown-key", message, (first,), key=True, help=help)
        elif not any(word != SEVERITY for word in value):
            yield Fault("missing-key", f"{IT} checks nothing", help="write for instance `unchanged: {}`")

    def schema(self) -> Iterator[Schema]:
        none: Schema = dict.fromkeys(KINDS.own, False)
        advice = f"write one or more of {', '.join(f'`{word}`' for word in KINDS.own)}"
        yield {"if": {"properties": none}, "then": {"required": ["expect"], "errorMessage": advice}}


class CheckEntry(Model):
    """Conditions that every built model must meet: one or more kinds of check."""

    rules: ClassVar = (_SaysSomething(),)
    example: ClassVar = "{unchanged: {}}"
    noun: ClassVar = "kind"
    instead: ClassVar = _INSTEAD
    called: ClassVar = "check `{}`"

    kinds: Annotated[Mapping[str, Any], Rows(lambda: KINDS)] = Field({}, alias="<kinds>")
    severity: Literal["error", "warning"] = "error"
    """a check that does not hold is an error, or only a warning"""
    repeats: Turns = Field(None, alias="for")
    when: When = None


def checks_of(section: Mapping[str, CheckEntry]) -> Iterator[Check]:
    for name, entry in section.items():
        for word, check in entry.kinds.items():
            if not check.at:  # it is written as a list
                check._at = (*(entry.at or ("check", name)), word)
            yield check

"""What is done to a model that a recipe uses: `drop`, `edit`, `with`, `urdf`, `allow`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import advised
from mjcompose.language.form import (
    COUNT,
    Form,
    Schema,
    Settings,
    check_rows,
    definition,
    kind_of,
    read_count,
    reference,
)
from mjcompose.language.form import SCHEMAS as COUNTS
from mjcompose.language.forms.model import Model
from mjcompose.language.forms.scalars import Keywords
from mjcompose.language.select import GLOB, NARROWING, read_selector
from mjcompose.model.grammar import GRAMMAR
from mjcompose.model.selector import EVERYTHING, Selector, known_tags, paths_of


class UrdfKeys(Model):
    """How to read elements that MuJoCo ignores. Omitted keys keep the behavior of the file or of MuJoCo."""

    visuals: Literal["keep", "drop"] | None = None
    """Whether visuals become geoms that touch nothing; what collides is then in group 3, which viewers hide. By default
    as `discardvisual` in the file says, which MuJoCo takes for `true`."""
    fixed: Literal["keep", "fuse"] | None = None
    """Whether links without a joint of their own stay bodies, or become frames of the one above. By default as
    `fusestatic` in the file says, which MuJoCo takes for `true`."""
    actuators: Literal["declared", "all", "none"] = "declared"
    """Which joints get an actuator: those that `<ros2_control>` and `<transmission>` command, every joint that moves by
    itself, or none."""
    inertia: Annotated[Literal["repair", "keep"], Keywords({"mend": "repair"})] | None = None
    """Whether inertias that no body can have, which MuJoCo refuses, are changed as little as possible; each is a
    warning."""


@dataclass(frozen=True, slots=True)
class Given(Form):
    """Form of the field `with`, a mapping from names to values. The nested recipe checks these."""

    def schema(self) -> Schema:
        value = {"type": ["number", "boolean", "string", "array"]}
        return {"type": "object", "additionalProperties": value}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> dict[str, Any]:
        if not isinstance(value, dict):
            message = f"`with` expects a mapping from names to values, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message, help="write `with: {reach: 0.5}`"))
            return {}
        for name, each in value.items():
            if each is None or isinstance(each, dict):
                message = f"`with.{name}` expects a number, a text, true, false or a list, got {kind_of(each)}"
                faults.append(Fault("wrong-type", message, (name,)))
        return dict(value)


# Without these, nothing else in a model can be read.
_KEPT = ("worldbody", "compiler")


@dataclass(frozen=True, slots=True)
class Drop:
    """One entry: a whole section, or a selector. `index` is its place in the list.

    `expect` is the number of elements, None for at least one; with `optional`, none is allowed.
    """

    section: str | None
    select: Selector | None
    index: int
    expect: int | None = None
    optional: bool = False

    def __str__(self) -> str:
        if self.section is not None:
            return self.section
        assert self.select is not None
        return self.select.tag if self.select == Selector(self.select.tag, EVERYTHING) else str(self.select)

    @property
    def leaves_keys(self) -> bool:
        """Whether it leaves out all keys. Keyframes of the recipe may read them nevertheless."""
        return self.expect is None and (self.section == "keyframe" or self.select in _ALL_KEYS)


_ALL_KEYS = (Selector("key", EVERYTHING), Selector("keyframe/key", EVERYTHING))


@dataclass(frozen=True, slots=True)
class Drops(Form):
    """Form of a field `drop`: `[light, contact, {geom: "visual_*"}]`, read as a tuple of `Drop`."""

    def schema(self) -> Schema:
        return drops()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Drop, ...]:
        found: list[Drop | None] = []
        if isinstance(value, list):
            found = [_drop(item, index, (index,), faults=faults) for index, item in enumerate(value)]
        else:
            help = f"write `drop: [{value}]`" if isinstance(value, str) else "write `drop: [light, contact]`"
            faults.append(Fault("wrong-type", f"`drop` expects a list, got {kind_of(value)}", help=help))
        return tuple(each for each in found if each is not None)


def _drop(value: Any, index: int, at: Path, faults: list[Fault]) -> Drop | None:
    if not isinstance(value, str):
        selector = read_selector(value, at, "an entry of `drop`", faults=faults, beside=COUNT)
        if selector is None:
            return None
        expect, optional = read_count(value, at, faults, owner="an entry of `drop`")
        return Drop(None, selector, index, expect=expect, optional=optional)
    if value in GRAMMAR.root.children:
        if value not in _KEPT:
            return Drop(value, None, index)
        message = f"`{value}` cannot be left out of a model"
        faults.append(Fault("not-supported", message, at, help="name what in it is to be left out"))
        return None
    if paths_of(value):
        return Drop(None, Selector(value, EVERYTHING), index)
    help, fix = advised(value, known_tags())
    notes = () if help else (Note("a section (`contact`), a tag (`light`) or a selector (`{geom: visual_*}`)"),)
    faults.append(
        Fault("unknown-element", f"MJCF has no section and no element `{value}`", at, notes=notes, help=help, fix=fix)
    )
    return None


KeyPolicy = Literal["merge", "prefix", "none"]

_TEXT: Schema = {"type": "string", "minLength": 1}
_NARROWING: dict[str, Schema] = {
    "parent": {**reference("selector"), "description": "the body, or other element, that it stands in"},
    "in": {**reference("selector"), "description": "an element that it stands in, at any depth"},
    "part": {**GLOB, "description": "the part that it came from"},
    "class": {**GLOB, "description": "the default class in effect, or one that it descends from"},
    "where": {
        "type": ["object", "string"],
        "description": "attributes and their values in effect, or one boolean `${…}`",
    },
}
check_rows("the JSON Schema of selectors in composer/mjcompose/language/used_model.py", _NARROWING, NARROWING)


def drops() -> Schema:
    """Return the schema of the list `drop`."""
    return {"type": "array", "items": {"anyOf": [_TEXT, reference("dropped")]}}


@definition("selector")
def selector(_: str) -> Schema:
    """Return the schema of a mapping from a tag to a glob, with the keys that narrow it down."""
    return {
        "type": "object",
        "properties": dict(_NARROWING),
        "propertyNames": {"enum": [*NARROWING, *known_tags(), *_paths()]},
        "additionalProperties": GLOB,
        "minProperties": 1,
    }


@definition("dropped")
def dropped(_: str) -> Schema:
    """Return the schema of a selector in `drop`, with the number of elements."""
    schema = selector("")
    schema["properties"] |= COUNTS
    schema["propertyNames"] = {"enum": [*COUNTS, *schema["propertyNames"]["enum"]]}
    return schema


def _paths() -> list[str]:
    known = set(known_tags())
    return [path for path in GRAMMAR.paths if "/" in path and path not in known and path != "mujoco/include"]

"""What is done to a model that a recipe uses: `drop`, `edit`, `with`, `urdf`, `allow`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
)

from mjcompose.base.codes import CODES
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Fix, Note, Path
from mjcompose.base.suggest import advised
from mjcompose.language.element import path_of
from mjcompose.language.form import (
    COUNT,
    EXCLUSIVE,
    Form,
    Schema,
    Settings,
    check_rows,
    definition,
    kind_of,
    read_count,
    reference,
    unknown_key,
)
from mjcompose.language.form import SCHEMAS as COUNTS
from mjcompose.language.forms.model import Model as FormModel
from mjcompose.language.select import GLOB, NARROWING, advice_on_narrowing, read_selector
from mjcompose.language.verbs.table import VERBS
from mjcompose.language.verbs.values import TAGS, Checker, Selected
from mjcompose.model.grammar import GRAMMAR
from mjcompose.model.selector import EVERYTHING, Selector, known_tags, paths_of


class Model(BaseModel):
    """A mapping with fixed keys: frozen, no other keys, nothing converted."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        # Most models are never validated on their own. Building their validators would be most of the import time.
        defer_build=True,
        hide_input_in_errors=True,
    )


def key_names(model: type[Model]) -> list[str]:
    """Return the keys of a mapping as a recipe writes them, in the order of the fields."""
    return [field.alias or name for name, field in model.model_fields.items()]


class UrdfKeys(FormModel):
    """What becomes of what MuJoCo leaves out, or leaves to others; without it, it is as the file or MuJoCo says."""

    visuals: Literal["keep", "drop"] | None = None
    """Whether visuals become geoms that touch nothing; what collides is then in group 3, which viewers hide. By default
    as `discardvisual` in the file says, which MuJoCo takes for `true`."""
    fixed: Literal["keep", "fuse"] | None = None
    """Whether links without a joint of their own stay bodies, or become frames of the one above. By default as
    `fusestatic` in the file says, which MuJoCo takes for `true`."""
    actuators: Literal["declared", "all", "none"] = "declared"
    """Which joints get an actuator: those that `<ros2_control>` and `<transmission>` command, every joint that moves by
    itself, or none."""
    inertia: Literal["mend", "keep"] | None = None
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
                message = (
                    f"`with.{name}` expects a number, a text, true, false or a list, got {kind_of(each)}"
                )
                faults.append(Fault("wrong-type", message, (name,)))
        return dict(value)


ALLOW = "allow"


@dataclass(frozen=True, slots=True)
class Allowed(Form):
    """Form of a field `allow`: a list of codes, read as a tuple of texts."""

    def schema(self) -> Schema:
        return codes_schema()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[str, ...]:
        return read_codes(value, (), faults)


def read_codes(value: Any, at: Path, faults: list[Fault]) -> tuple[str, ...]:
    """Return the codes of a list. Anything else in it is a fault."""
    if not isinstance(value, list) or not value:
        got = "an empty list" if value == [] else kind_of(value)
        help = f"write `{ALLOW}: [{value}]`" if isinstance(value, str) else f"write `{ALLOW}: [convert-loss]`"
        message = f"`{ALLOW}` expects a list of codes of warnings, got {got}"
        fix = Fix(f"[{value}]") if isinstance(value, str) and value in CODES else None
        faults.append(Fault("wrong-type", message, at, help=help, fix=fix))
        return ()
    for index, code in enumerate(value):
        if not isinstance(code, str):
            message = f"`{ALLOW}` expects codes of warnings, got {kind_of(code)}"
            faults.append(Fault("wrong-type", message, (*at, index)))
        elif code not in CODES:
            near, fix = advised(code, CODES)
            note = Note("`mjcompose explain --codes` lists all codes")
            message = f"the code `{code}` does not exist"
            faults.append(Fault("wrong-keyword", message, (*at, index), notes=(note,), help=near, fix=fix))
        elif code in value[:index]:
            faults.append(
                Fault("name-clash", f"`{code}` is allowed twice", (*at, index), help="take one out")
            )
    return tuple(each for each in value if isinstance(each, str))


@definition("code")
def code(_: str) -> Schema:
    """Return the schema of a warning's code."""
    return {"enum": list(CODES)}


def codes_schema() -> Schema:
    return {"type": "array", "items": reference("code"), "minItems": 1, "uniqueItems": True}


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
    notes = (
        () if help else (Note("a section (`contact`), a tag (`light`) or a selector (`{geom: visual_*}`)"),)
    )
    faults.append(
        Fault(
            "unknown-element",
            f"MJCF has no section and no element `{value}`",
            at,
            notes=notes,
            help=help,
            fix=fix,
        )
    )
    return None


KeyPolicy = Literal["merge", "prefix", "none"]

_TEXT: Schema = {"type": "string", "minLength": 1}
OWN: dict[str, Schema] = {
    "select": {**reference("selector"), "description": "which elements are meant"},
    **COUNTS,
    "id": {
        **_TEXT,
        "description": "a name by which a recipe that extends this one can replace the entry",
    },
    "allow": {
        **codes_schema(),
        "description": "the codes of warnings about it that are meant to be there",
    },
    "when": {"description": "the builds that it belongs to"},
}
"""The keys of an entry of `edit` that are not verbs."""
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


def edits() -> Schema:
    """Return the schema of the list `edit`."""
    return {"type": "array", "items": reference("edit")}


def drops() -> Schema:
    """Return the schema of the list `drop`."""
    return {"type": "array", "items": {"anyOf": [_TEXT, reference("dropped")]}}


@definition("edit")
def edit(_: str) -> Schema:
    """Return the schema of one entry of `edit`."""
    verbs = {name: {**verb.schema(), "description": verb.description} for name, verb in VERBS.items()}
    first = ("select", *COUNTS)
    properties: Schema = {**{name: OWN[name] for name in first}, **verbs, **OWN}
    return {
        "type": "object",
        "properties": properties,
        "required": ["select"],
        "additionalProperties": False,
        "minProperties": 2,
        "allOf": [*map(_alone, (name for name, verb in VERBS.items() if verb.alone)), *_by_tag()],
    }


def _alone(verb: str) -> Schema:
    """Return the condition that no other verb is written beside this one."""
    others = dict.fromkeys((name for name in VERBS if name != verb), False)
    then = {"properties": others, "errorMessage": f"`{verb}` stands alone"}
    return {"if": {"required": [verb]}, "then": then}


def _by_tag() -> list[Schema]:
    """Return conditions on the attributes that verbs may name, by the tag of the selector."""
    conditions: list[Schema] = []
    for tag in TAGS:
        forms = {name: verb.schema_of_tag(tag) for name, verb in VERBS.items() if verb.schema_of_tag}
        conditions.append(_where_selected(tag, forms))
    forms = {name: verb.schema_of_classes() for name, verb in VERBS.items() if verb.schema_of_classes}
    return [*conditions, _where_selected("default", forms)]


def _where_selected(tag: str, forms: dict[str, Schema]) -> Schema:
    selected: Schema = {"properties": {"select": {"required": [tag]}}, "required": ["select"]}
    verbs = {name: {**form, "description": VERBS[name].description} for name, form in forms.items()}
    return {"if": selected, "then": {"properties": verbs}}


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


KEYS = ("id", "select", *COUNT, *VERBS.own, "allow", "when")
"""The keys of an entry, in the order in which `fmt` writes them."""
check_rows("the keys of `edit` in composer/mjcompose/language/used_model.py", [*OWN, *VERBS.own], KEYS)
_KNOWN = ("select", *VERBS.own, *COUNT, "id", "allow", "when")
"""The same for messages, which list the first few: what does something comes first."""


@dataclass(frozen=True, slots=True)
class Edit:
    """One entry. `verbs` has the values of the verbs in the order in which they run; `at` is the path to the entry.

    Values are as written: `${…}` in them is evaluated for each element.
    """

    select: Selector
    verbs: Mapping[str, Any] = field(default_factory=dict)
    expect: int | None = None
    optional: bool = False
    at: Path = ()

    @property
    def words(self) -> str:
        """Return the entry on one line, as `plan` prints it."""
        return (
            f"edit {self.select}: {'; '.join(VERBS[name].words(each) for name, each in self.verbs.items())}"
        )


@dataclass(frozen=True, slots=True)
class Edits(Form):
    """Form of a field `edit`: a list of entries, read as a tuple of `Edit`."""

    def schema(self) -> Schema:
        return edits()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Edit, ...]:
        found: list[Edit] = []
        if isinstance(value, list):
            checker = Checker(settings.bare_angles, faults)
            found = [
                edit
                for index, item in enumerate(value)
                if (edit := _edit(item, (index,), checker, faults=faults)) is not None
            ]
        else:
            help = "put `- ` in front of `select`" if isinstance(value, dict) and "select" in value else None
            faults.append(
                Fault("wrong-type", f"`edit` expects a list of entries, got {kind_of(value)}", help=help)
            )
        return tuple(found)


def _edit(value: Any, at: Path, checker: Checker, faults: list[Fault]) -> Edit | None:
    if not isinstance(value, dict):
        message = f"an entry of `edit` is a mapping, got {kind_of(value)}"
        help = "write `{select: {TAG: NAME}, set: {ATTRIBUTE: VALUE}}`"
        faults.append(Fault("wrong-type", message, at, help=help))
        return None
    before = len(faults)
    faults += _unknown(value, at)
    if "select" not in value:
        help = "write `select: {TAG: NAME}`: which elements are meant"
        faults.append(
            Fault("missing-key", "an entry of `edit` lacks `select`", at, help=help, lacks="select")
        )
        return None
    selector = read_selector(value["select"], (*at, "select"), "`select`", faults=faults)
    verbs = [name for name in VERBS if name in value]
    if not verbs and len(faults) == before:
        known = ", ".join(f"`{name}`" for name in VERBS)
        message = "an entry of `edit` says nothing to be done"
        faults.append(Fault("missing-key", message, at, help=f"write one of {known}"))
    alone = next((name for name in verbs if VERBS[name].alone), None)
    if alone is not None and len(verbs) > 1:
        other = next(name for name in verbs if name != alone)
        faults.append(
            Fault(
                EXCLUSIVE,
                f"`{alone}` stands alone, and there is `{other}` as well",
                (*at, alone),
                key=True,
                related=((f"`{other}` is written here", (*at, other)),),
                help=f"leave `{alone}` or `{other}` out",
            )
        )
    read = {name: VERBS[name].read(value[name], Selected(selector, (*at, name), checker)) for name in verbs}
    expect, optional = read_count(value, at, faults)
    if ALLOW in value:
        read_codes(value[ALLOW], (*at, ALLOW), faults)
    if selector is None or len(faults) > before:
        return None
    return Edit(selector, read, expect, optional=optional, at=path_of(value))


def _unknown(value: dict[str, Any], at: Path) -> Iterator[Fault]:
    for name in value:
        if name in KEYS or name in VERBS:
            continue
        message = f"`{name}` is not a key of an entry of `edit`"
        fault = unknown_key(message, name, _KNOWN, at=(*at, name))
        elsewhere = advice_on_narrowing(name)
        yield replace(fault, help=elsewhere, fix=None) if elsewhere else fault

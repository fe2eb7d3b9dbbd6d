"""The section `attach`: the parts of a recipe, by prefix, and rows of copies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.limits import advice, in_force
from mjcompose.base.suggest import advised, unknown_attribute
from mjcompose.language.element import Reader, path_of
from mjcompose.language.element_schema import at_most_one, attribute_schema, mapping
from mjcompose.language.form import (
    Choice,
    Element,
    Form,
    Schema,
    Settings,
    Single,
    Text,
    Value,
    fault_at,
    is_unprintable,
    kind_of,
    settings,
    unprintable,
    validated_with,
    validation_error,
)
from mjcompose.language.fragment import missing_key, report_exclusive
from mjcompose.language.placing import (
    ORIENTATIONS,
    JointField,
    JointWord,
    ModelField,
    Offset,
    Sense,
    SenseField,
    fault_of_inline_recipe,
)
from mjcompose.language.used_model import (
    Allowed,
    Drop,
    Drops,
    Edit,
    Edits,
    Given,
    KeyPolicy,
    Model,
    UrdfKeys,
)
from mjcompose.language.value import bare_angle, read_value
from mjcompose.model.grammar import GRAMMAR

COUNT = "count"
ATTRIBUTES = (COUNT, "offset", "euler")
"""What an axis has of MJCF's `<replicate>`."""
_STILL: tuple[Single, ...] = (0, 0, 0)


@dataclass(frozen=True, slots=True)
class Axis:
    """A row of copies. Each is `offset` (metres) from the one before and turned by `euler`."""

    count: int
    offset: tuple[Single, ...] = _STILL
    euler: tuple[Single, ...] = _STILL


@dataclass(frozen=True, slots=True)
class Axes(Form):
    """Form of the field `replicate`: a list of axes, each of which copies what the ones after it make."""

    def schema(self) -> Schema:
        kind = GRAMMAR.element("replicate")
        axis = mapping({name: attribute_schema(kind.attributes[name]) for name in ATTRIBUTES})
        return {"type": "array", "minItems": 1, "items": {**axis, "required": [COUNT]}}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Axis, ...]:
        reader = Reader(settings, faults)
        axes: list[Axis] = []
        if not isinstance(value, list) or not value:
            got = "an empty list" if value == [] else kind_of(value)
            message = f"`replicate` expects a list of axes, got {got}"
            faults.append(
                Fault("wrong-type", message, help="write `replicate: [{count: 3, offset: [0.1, 0, 0]}]`")
            )
        else:
            axes = [each for at, item in enumerate(value) if (each := _axis(reader, item, (at,)))]
        if not faults and (total := math.prod(axis.count for axis in axes)) > in_force().copies:
            message = f"`replicate` makes {total} copies, and at most {in_force().copies} are allowed"
            faults.append(Fault("limit-exceeded", message, help=advice("copies", total)))
        return tuple(axes)


def _axis(reader: Reader, value: Any, at: Path) -> Axis | None:
    owner = "an axis of `replicate`"
    if not isinstance(value, dict):
        message = f"{owner} is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help="write `{count: 3, offset: [0.1, 0, 0]}`"))
        return None
    kind = GRAMMAR.element("replicate")
    read: dict[str, Value] = {}
    for name, item in value.items():
        path = (*at, name)
        if name not in ATTRIBUTES:
            help, fix = advised(name, ATTRIBUTES)
            unknown = unknown_attribute(name, owner, ATTRIBUTES)
            reader.faults.append(fault_at(unknown, path, key=True, help=help, fix=fix))
            continue
        found = read_value(kind.attributes[name], item, path, owner=owner, faults=reader.faults)
        if found is not None:
            read[name] = found
            if not reader.settings.bare_angles:
                bare = bare_angle(kind.attributes[name], found, None, at=path, owner=owner)
                reader.faults += [bare] if bare is not None else []
    if COUNT not in value:
        reader.faults.append(missing_key(owner, COUNT, at))
    count, offset, euler = read.get(COUNT, 1), read.get("offset", _STILL), read.get("euler", _STILL)
    if not isinstance(count, int | float) or not isinstance(offset, tuple) or not isinstance(euler, tuple):
        return None
    if count < 1:
        message = f"`{COUNT}` of {owner} is at least 1, got {count}"
        reader.faults.append(Fault("out-of-range", message, (*at, COUNT)))
    return Axis(int(count), offset, euler)


RESERVED = "base"
PATH_LIKE = ("/", ":")
"""Separators that make levels of a name; `_` and the like may stand in a prefix as well."""
PLACES = ("site", "body", "frame")

Vector = tuple[Single, ...]


def _restrict(schema: dict[str, Any]) -> None:
    schema["allOf"] = [*at_most_one(PLACES), *at_most_one(ORIENTATIONS)]


@dataclass(frozen=True, slots=True)
class Prefix(Form):
    """Form of the field `prefix`, which replaces the key of a part. Empty means no prefix and no separator."""

    def schema(self) -> Schema:
        return {"type": "string", **_pattern("*")}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> str:
        if not isinstance(value, str):
            help = f"quote it: '{value}'" if isinstance(value, int | float) else None
            faults.append(Fault("wrong-type", f"`prefix` expects text, got {kind_of(value)}", help=help))
        elif value and (fault := prefix_fault(value, settings)) is not None:
            faults.append(fault)
        return str(value)


class Attachment(Model):
    """A part: the model, where it hangs, how it is turned, and what stands between.

    `joint` is None, a word, an `Element` for one joint that is called after the prefix, or a tuple of
    `Element` for joints with names of their own.
    """

    model_config = ConfigDict(json_schema_extra=_restrict)

    model: Annotated[str | Mapping[str, Any], ModelField()]
    """A model reference (a file relative to the recipe, `package:…`, `menagerie:…`), or a recipe written in place."""
    packages: dict[str, Annotated[str, Text("packages")]] = Field(default_factory=dict)
    """The folders that `package://NAME` stands for in URDF: a mapping from NAME to a path relative to the recipe; `"*"`
    is a ROS workspace, all of whose packages are meant."""
    urdf: UrdfKeys = Field(default_factory=UrdfKeys)
    """How a URDF is read: visuals, fixed links, actuators."""
    given: Annotated[dict[str, Any], Given()] = Field(default_factory=dict, alias="with")
    """Values of the parameters and variants of a nested recipe, or of the arguments of a xacro template, by name."""
    subtree: Annotated[str | None, Text("subtree")] = None
    """The one body of the model to take, with exactly what it needs; without it, the whole model."""
    drop: Annotated[tuple[Drop, ...], Drops()] = ()
    """What to leave out, with all that refers to it: sections, tags and selectors, in the part's own names."""
    edit: Annotated[tuple[Edit, ...], Edits()] = ()
    """Ordered changes to the part, in its own names, before it is attached."""
    site: Annotated[str | None, Text("site")] = None
    """The site that the part is attached to."""
    body: Annotated[str | None, Text("body")] = None
    """The body that the part is attached to."""
    frame: Annotated[str | None, Text("frame")] = None
    """The frame that the part is attached to."""
    mate: Annotated[str | None, Text("mate")] = None
    """A site, body or frame of the part that is to coincide with that place; without it, the part's own origin."""
    pos: Annotated[Vector | None, Offset("pos")] = None
    """Offset in the frame of that place."""
    quat: Annotated[Vector | None, Offset("quat")] = None
    """Rotation in the frame of that place, as a quaternion (w, x, y, z)."""
    euler: Annotated[Vector | None, Offset("euler")] = None
    """Rotation in the frame of that place, as three angles in the order of `eulerseq`."""
    axisangle: Annotated[Vector | None, Offset("axisangle")] = None
    """Rotation in the frame of that place, as an axis and an angle: (x, y, z, a)."""
    xyaxes: Annotated[Vector | None, Offset("xyaxes")] = None
    """Rotation in the frame of that place, as the x axis and the y axis of the part."""
    zaxis: Annotated[Vector | None, Offset("zaxis")] = None
    """Rotation in the frame of that place, as the z axis of the part, turned the shortest way."""
    joint: Annotated[JointWord | Element | tuple[Element, ...] | None, JointField()] = None
    """What stands between the place and the part. Without it nothing is added, and a free joint of the part's
    root is kept where it may be; `none` removes it."""
    sense: Annotated[Sense | None, SenseField()] = None
    """What the place carries is measured there: force and torque between the place and the part, by sensors."""
    prefix: Annotated[str | None, Prefix()] = None
    """What stands before the part's names in place of the key; empty for no prefix and no separator."""
    replicate: Annotated[tuple[Axis, ...], Axes()] = ()
    """Copies in rows, one axis an entry: `PREFIX0/`, `PREFIX1/`, … or `PREFIX0_0/`, …"""
    keys: Annotated[Literal["merge", "prefix"], Choice("keys")] = "merge"
    """How the part's keyframes are called: merged by name, or kept apart as `PREFIX/NAME`. `drop: [key]` leaves them
    out."""
    allow: Annotated[tuple[str, ...], Allowed()] = ()
    """The codes of warnings about this part that are meant to be there."""

    @property
    def key_policy(self) -> KeyPolicy:
        """What becomes of the part's keyframes."""
        return "none" if any(each.leaves_keys for each in self.drop) else self.keys

    @property
    def is_placed(self) -> bool:
        """Whether something is said about its place, or about what stands between the two."""
        return not _OF_A_PLACE.isdisjoint(self.model_fields_set)

    @property
    def place(self) -> tuple[str, str]:
        """Return kind and name of what the part is attached to; `world` without a name for the world."""
        named = ((kind, getattr(self, kind)) for kind in PLACES)
        return next(((kind, name) for kind, name in named if name is not None), ("world", ""))

    @model_validator(mode="wrap")
    @classmethod
    def _alternatives(cls, value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        faults: list[Fault] = []
        if isinstance(value, Mapping):
            path = path_of(value)
            owner = f"part `{path[-1]}`" if path[:1] == ("attach",) else f"`{RESERVED}`"
            in_place = fault_of_inline_recipe(value, owner, cls.model_fields)
            if in_place is not None:
                raise validation_error([in_place], value)
            report_exclusive(PLACES, list(value), owner, at=(), faults=faults)
            report_exclusive(ORIENTATIONS, list(value), owner, at=(), faults=faults)
            if value.get("prefix") == "" and value.get("replicate"):
                faults.append(_nameless_copies(owner))
        attachment: Attachment = validated_with(handler, value, faults)
        return attachment


def _nameless_copies(owner: str) -> Fault:
    message = f"the copies of {owner} would have the same names: it has no prefix"
    return Fault("name-clash", message, ("prefix",), help="leave `prefix` out, or write one")


_OF_A_PLACE = frozenset({*ORIENTATIONS, "pos", "mate", "joint", "sense"})
_NOT_OF_A_BASE = (*PLACES, "prefix", "replicate")


@dataclass(frozen=True, slots=True)
class Start:
    """Form of the field `base`: a part without a prefix, at the world, or only its `model`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        part = handler.generate_schema(Attachment)
        return core_schema.no_info_wrap_validator_function(self._validate, part)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        message = f"`{RESERVED}` is at the world and has no prefix"
        barred = {"properties": dict.fromkeys(_NOT_OF_A_BASE, False), "errorMessage": message}
        return {"anyOf": [{"type": "string", "minLength": 1}, {"allOf": [handler(schema), barred]}]}

    def _validate(self, value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        if not isinstance(value, Mapping):
            return handler({"model": value} if isinstance(value, str) else value)
        help = "write it as a part: `attach: {NAME: {model: …}}`"
        faults = [
            Fault(
                "not-supported",
                f"`{RESERVED}` is at the world and has no prefix: it cannot have `{key}`",
                (key,),
                key=True,
                help=help,
            )
            for key in _NOT_OF_A_BASE
            if key in value
        ]
        return validated_with(handler, value, faults)


@dataclass(frozen=True, slots=True)
class Prefixes:
    """Form of the field `attach`, a mapping from prefixes to parts. It checks the prefixes."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        parts = core_schema.dict_schema(core_schema.str_schema(), handler.generate_schema(Attachment))
        return core_schema.with_info_wrap_validator_function(self._validate, parts)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        return {**handler(schema), "propertyNames": _pattern("+")}

    def _validate(self, value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        faults = []
        for prefix in value if isinstance(value, Mapping) else ():
            fault = prefix_fault(prefix, settings(info.context), (prefix,), key=True)
            faults += [fault] if fault is not None else []
        return validated_with(handler, value, faults)


def _pattern(times: str) -> Schema:
    """Return the rules of `prefix_fault` as a pattern of JSON Schema. `times` is `*` if it may be empty, else `+`."""
    message = f"expected a prefix: a name without spaces, and not `{RESERVED}`"
    return {"pattern": rf"^(?!{RESERVED}$)\S{times}$", "patternErrorMessage": message}


def prefix_fault(prefix: str, context: Settings, at: tuple[str, ...] = (), key: bool = False) -> Fault | None:
    """Return the fault of a prefix, or None."""
    separator = context.separator
    if prefix == RESERVED:
        message = f"`{RESERVED}` means the model to start from and is not a prefix"
        return Fault("reserved-prefix", message, at, key=key, help="choose another name for the part")
    if not prefix:
        message = "a prefix is empty"
        return Fault(
            "bad-name",
            message,
            at,
            key=key,
            help='to attach without a prefix, write `prefix: ""` in the part',
        )
    if any(character.isspace() for character in prefix):
        joined = "_".join(prefix.split())
        return Fault(
            "bad-name", f"the prefix `{prefix}` has a space in it", at, key=key, help=f"write `{joined}`"
        )
    if is_unprintable(prefix):
        return unprintable("a prefix", at, key=key)
    if separator in prefix and separator in PATH_LIKE:
        help = "mjcompose adds the separator; a part that is attached to another part has a prefix of its own"
        return Fault(
            "bad-name", f"the prefix `{prefix}` has the separator `{separator}` in it", at, key=key, help=help
        )
    return None

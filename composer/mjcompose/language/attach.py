"""The section `attach`: the parts of a recipe, by prefix; and `base`, a part without a prefix."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, core_schema

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.limits import advice, in_force
from mjcompose.base.suggest import closest
from mjcompose.language.edit import Drops, Edits, Given, UrdfKeys
from mjcompose.language.element import FRAGMENT, Reader
from mjcompose.language.forms.context import ByGrammar, Schema, Settings, reference, validated_with
from mjcompose.language.forms.model import IT, Bars, Exclusive, Model, Needs, OneOf
from mjcompose.language.forms.scalars import (
    LENGTHS,
    AtLeastOne,
    AttributeValue,
    Checked,
    Codes,
    Count,
    Expects,
    Items,
    Keys,
    Name,
    NotNegative,
    Scaled,
    Text,
    Turns,
    When,
)
from mjcompose.language.placing import ORIENTATIONS, Inline, JointField, JointWord, Mirror, ModelReference, Offset
from mjcompose.language.value import EXCLUSIVE, RecipeElement, Single, odd_name
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.merged_settings import KeyPolicy

Vector = tuple[Single, ...]
SURFACES = ("geom", "site")
_ROW = ("count", "offset", "euler")


class Surface(Model):
    """A geom or a site with a size."""

    rules: ClassVar = (OneOf(*SURFACES, lacks="names no surface", advice="write `over: {geom: NAME}`"),)
    example: ClassVar = "{geom: …}"
    short: ClassVar = "geom"

    geom: Annotated[str, Name("geom")] | None = None
    """the copies lie on this geom"""
    site: Annotated[str, Name("site")] | None = None
    """the copies lie on the surface of this site, such as a flat box that marks a region of a table"""

    @property
    def named(self) -> tuple[str, str]:
        return ("geom", self.geom) if self.geom is not None else ("site", self.site or "")


class Scatter(Model):
    """Copies at random places on a surface, without overlap."""

    example: ClassVar = "{count: 12, over: {geom: table/top}}"

    count: AtLeastOne = Field(examples=["12"])
    """how many"""
    over: Surface = Field(examples=["{geom: NAME}"])
    """the surface; each copy lies on it completely"""
    clearance: Annotated[float, Scaled(LENGTHS, ge=0)] = 0.0
    """the smallest distance of a copy from other copies and from other bodies, in meters; `1cm` is 0.01"""
    upright: bool = True
    """copies are turned only about the vertical; false turns them in any direction"""
    seed: Count = 0
    """the seed of the places; draw a parameter for it to get other places in each sample"""
    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe in which nothing overlaps; without it, the reference configuration"""
    settle: Annotated[float, Scaled({"ms": 1e-3, "s": 1.0}, gt=0, le=60)] | None = None
    """lets the copies fall and come to rest for this time, at most 60 s; the rest of the model does not move"""


class Axis(Model):
    """A row of copies, each moved and turned relative to the previous copy; or copies on a surface."""

    rules: ClassVar = (Needs({"count": "3"}, unless=("scatter",)), Bars("scatter", *_ROW, why="scatters its copies"))
    example: ClassVar = "{count: 3, offset: [0.1, 0, 0]}"
    called: ClassVar = "an axis of `replicate`"

    count: AtLeastOne = Field(1, examples=["3"])
    """how many"""
    offset: Annotated[Vector, AttributeValue("replicate", "offset")] = (0, 0, 0)
    """from each to the next, in the frame of the copy before it"""
    euler: Annotated[Vector, AttributeValue("replicate", "euler")] = (0, 0, 0)
    """the rotation from one copy to the next"""
    scatter: Scatter | None = None
    """copies at random places on a surface, instead of a row"""

    @property
    def copies(self) -> int:
        return self.count if self.scatter is None else self.scatter.count


def _too_many(axes: tuple[Axis, ...]) -> Fault | None:
    total = math.prod(axis.copies for axis in axes)
    most = in_force().copies
    if total <= most:
        return None
    message = f"{IT} makes {total} copies, and at most {most} are allowed"
    return Fault("limit-exceeded", message, help=advice("copies", total))


Axes = Annotated[
    tuple[Axis, ...], Items(1), Checked(_too_many), Expects("a list of axes", "[{count: 3, offset: [0.1, 0, 0]}]")
]


class ScatterAlone:
    """The rule that `scatter` is the only axis of a part, and places it alone."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        axes = value.get("replicate")
        axes = axes if isinstance(axes, list) else []
        scattering = any(isinstance(axis, dict) and "scatter" in axis for axis in axes)
        if scattering and len(axes) > 1:
            message = "`scatter` cannot have other axes next to it"
            help = "write the number of all copies in `scatter`"
            yield Fault(EXCLUSIVE, message, ("replicate",), key=True, help=help)
        if scattering and "pos" in value:
            help = "remove `pos`: `scatter` finds the position of each copy"
            yield Fault(EXCLUSIVE, f"{IT} has both `pos` and `scatter`", ("pos",), key=True, help=help)

    def schema(self) -> Iterator[Schema]:
        for refused, more in (("replicate", {"minItems": 2}), ("pos", {})):
            axes = {"contains": {"required": ["scatter"]}, **more}
            then = {"properties": {refused: False}, "errorMessage": "`scatter` alone places the copies"}
            yield {"if": {"properties": {"replicate": axes}, "required": ["replicate"]}, "then": then}


RESERVED = "base"
PATH_LIKE = ("/", ":")
"""Separators that make levels of a name; a prefix may contain `_` and the like."""
PLACES = ("site", "body", "frame")

_QUANTITIES = ("force", "torque")


class _Something:
    help = "write `force: true`, `torque: true` or both"

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        unknown = [key for key in value if key not in model.key_names()]
        is_open = not any(value.get(each, False) is not False for each in _QUANTITIES)
        if is_open and not any(closest(key, _QUANTITIES) for key in unknown):
            yield Fault("missing-key", f"{IT} measures nothing", key=True, help=self.help)

    def schema(self) -> Iterator[Schema]:
        none: Schema = {"properties": {each: {"const": False} for each in _QUANTITIES}}
        first = {"required": ["force"], "maxProperties": 0, "errorMessage": self.help}  # which nothing is
        yield {"if": none, "then": first}


class Sense(Model):
    """Sensors between the place and the part, in the axes of the place: they measure the load below."""

    rules: ClassVar = (_Something(),)
    example: ClassVar = "[force, torque]"

    name: Text | None = None
    """the body and its site are PREFIX/NAME, the sensors PREFIX/NAME_force and _torque"""
    force: bool = False
    """the force between the place and the part"""
    torque: bool = False
    """the torque between the place and the part"""
    cutoff: NotNegative = 0.0
    """the largest value of the sensors; 0 for none"""

    @property
    def quantities(self) -> tuple[str, ...]:
        return tuple(each for each in _QUANTITIES if getattr(self, each))


_Sense = Annotated[
    Annotated[tuple[Literal["force", "torque"], ...], Items(1, unique=True), Tag("<list>")]
    | Annotated[Sense, Tag("<mapping>")],
    Discriminator(lambda value: "<mapping>" if isinstance(value, dict | Sense) else "<list>"),
    Expects("a list of `force` and `torque`, or a mapping", "[force, torque]"),
]


def _pattern(times: str) -> Schema:
    """Return the rules of `prefix_fault` as a pattern of JSON Schema. `times` is `*` if it may be empty, else `+`."""
    message = f"expected a prefix: a name without spaces, and not `{RESERVED}`"
    return {"pattern": rf"^(?!{RESERVED}$)(?:\S|\$\{{[^}}]*\}}){times}$", "patternErrorMessage": message}


class _Prefix:
    """The rule that a prefix is valid, and that copies have one, which distinguishes them."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        prefix = value.get("prefix")
        if isinstance(prefix, str) and prefix and (fault := prefix_fault(prefix, context, ("prefix",))) is not None:
            yield fault
        if prefix == "" and value.get("replicate"):
            message = f"the copies of {IT} would have the same names: it has no prefix"
            yield Fault("name-clash", message, ("prefix",), help="leave `prefix` out, or write one")

    def schema(self) -> Iterator[Schema]:
        message = "copies need a prefix"
        without = {"properties": {"prefix": {"const": ""}}, "required": ["prefix"]}
        yield {"if": without, "then": {"properties": {"replicate": False}, "errorMessage": message}}


class FileCompiler(ByGrammar):
    """Form of `compiler` next to a `model`: attributes of `<compiler>`."""

    kind = GRAMMAR.section("compiler")

    def schema(self) -> Schema:
        return reference("attributes:compiler")

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> RecipeElement | None:
        below = [*self.kind.children, FRAGMENT]
        refused = [name for name in value if name in below] if isinstance(value, dict) else []
        for name in refused:
            message = f"`{name}` cannot be in the `compiler` of a part, which has attributes"
            help = "write the attributes as keys" if name == FRAGMENT else "write it in the recipe's own `compiler`"
            faults.append(Fault("compiler-setting", message, (name,), key=True, help=help))
        return Reader(settings, faults).element(self.kind, value, (), "`compiler`", own=refused)


_MIRROR = Bars("mirror", *("pos", *ORIENTATIONS, "mate", "replicate"), why="takes its pose from another part")


class Attachment(Model):
    """A part: its model, its place, its pose there, and the joints in between."""

    rules: ClassVar = (Inline(), Exclusive(*PLACES), Exclusive(*ORIENTATIONS), _Prefix(), ScatterAlone(), _MIRROR)
    example: ClassVar = "{model: …}"
    instead: ClassVar = {
        "keyframes": "write `keys: prefix` to keep them apart, or `drop: [key]` to leave them out",
        **dict.fromkeys(("before", "after"), "move the part there in the file, which has the order of the parts"),
    }

    model: ModelReference = Field(examples=["./FILE.xml"])
    """A model reference (a file relative to the recipe, `package:…`, `menagerie:…`), or a recipe written in place."""
    packages: dict[str, Text] = Field(default_factory=dict)
    """The folders of `package://NAME` in URDF: a mapping from NAME to a path relative to the recipe; `"*"`
    is a ROS workspace with all of its packages."""
    urdf: UrdfKeys = Field(default_factory=UrdfKeys)
    """The reading of a URDF: visuals, fixed links, actuators."""
    compiler: Annotated[RecipeElement | None, FileCompiler()] = None
    """Attributes of `<compiler>` for a file that does not write them, such as `{angle: radian}`. The file is read as if
    it began with this `<compiler>`."""
    given: Given = Field(default_factory=dict, alias="with")
    """Values of the parameters and variants of a nested recipe, or of the arguments of a xacro template, by name."""
    subtree: Annotated[str, Name("body", inside="model")] | None = None
    """The body of the model to take, with everything it needs. Without it, the whole model."""
    drop: Drops = ()
    """Sections, tags and selectors to remove, with everything that refers to them. Use the part's own names."""
    edit: Edits = ()
    """Ordered changes to the part, in its own names, before it is attached."""
    site: Annotated[str, Name("site")] | None = None
    """The site that the part is attached to."""
    body: Annotated[str, Name("body")] | None = None
    """The body that the part is attached to."""
    frame: Annotated[str, Name("frame")] | None = None
    """The frame that the part is attached to."""
    mate: Annotated[str, Name("site", "body", "frame", inside="model")] | None = None
    """The site, body or frame of the part that coincides with the place; by default the part's origin."""
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
    mirror: Mirror | None = None
    """The pose of another part, reflected, at the same site, body or frame unless the part has its own."""
    joint: Annotated[JointWord | RecipeElement | tuple[RecipeElement, ...] | None, JointField()] = None
    """The joint between the place and the part. By default no joint is added, and a free joint at the part's root
    stays if the place allows it; `none` removes it."""
    sense: _Sense | None = None
    """Sensors at the place: force and torque between the place and the part."""
    prefix: Annotated[str, WithJsonSchema({"type": "string", **_pattern("*")})] | None = None
    """The prefix of the part's names, instead of the key. Empty for no prefix and no separator."""
    replicate: Axes = ()
    """Copies in rows, one axis an entry: `PREFIX0/`, `PREFIX1/`, … or `PREFIX0_0/`, …; or scattered copies."""
    keys: Literal["merge", "prefix"] = "merge"
    """`merge` joins the part's keyframes with others of the same name; `prefix` keeps them separate, as
    `PREFIX/NAME`. `drop: [key]` removes them."""
    allow: Codes = ()
    """The codes of warnings about this part that you accept."""
    repeats: Turns = Field(None, alias="for")
    when: When = None

    @property
    def key_policy(self) -> KeyPolicy:
        """How the part's keyframes are copied."""
        return "none" if any(each.leaves_keys for each in self.drop) else self.keys

    @property
    def scatter(self) -> Scatter | None:
        return self.replicate[0].scatter if self.replicate else None

    @property
    def sensors(self) -> Sense | None:
        if not isinstance(self.sense, tuple):
            return self.sense
        return Sense(force="force" in self.sense, torque="torque" in self.sense)

    @property
    def is_placed(self) -> bool:
        """Whether the part has keys about its place, or about a joint or sensors at that place."""
        return not _OF_A_PLACE.isdisjoint(self.model_fields_set)

    @property
    def place(self) -> tuple[str, str]:
        """Return kind and name of the part's place; `world` without a name for the world."""
        named = ((kind, getattr(self, kind)) for kind in PLACES)
        return next(((kind, name) for kind, name in named if name is not None), ("world", ""))

    @classmethod
    def subject(cls, at: Path) -> str:
        return f"part `{at[-1]}`" if len(at) > 1 else f"`{RESERVED}`"

    @classmethod
    def listed(cls) -> list[str]:
        return sorted(cls.key_names(), key=lambda name: name in _OF_A_MODEL)


_OF_A_MODEL = ("packages", "urdf", "compiler", "with", "subtree", "drop", "edit", "keys", "allow")
"""Keys about the model itself, which an unknown key seldom means."""
_OF_A_PLACE = frozenset({*ORIENTATIONS, "pos", "mate", "joint", "sense"})
_NOT_OF_A_BASE = (*PLACES, "prefix", "replicate", "mirror")


class Start(Struct):
    """Form of the field `base`: a part without a prefix, at the world, or only its `model`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._validate, handler.generate_schema(Attachment))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        message = f"`{RESERVED}` is at the world and has no prefix"
        barred = {"properties": dict.fromkeys(_NOT_OF_A_BASE, False), "errorMessage": message}
        return {"anyOf": [{"type": "string", "minLength": 1}, {"allOf": [handler(schema), barred]}]}

    def _validate(self, value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        if not isinstance(value, Mapping):
            return handler({"model": value} if isinstance(value, str) else value)
        help = "write it as a part: `attach: {NAME: {model: …}}`"
        message = f"`{RESERVED}` is at the world and has no prefix: it cannot have `{{}}`"
        barred = [key for key in _NOT_OF_A_BASE if key in value]
        faults = [Fault("not-supported", message.format(key), (key,), key=True, help=help) for key in barred]
        return validated_with(handler, value, faults)


def prefix_fault(prefix: str, context: Settings, at: tuple[str, ...] = (), key: bool = False) -> Fault | None:
    """Return the fault of a prefix, or None."""
    separator = context.separator
    if prefix == RESERVED:
        message = f"`{RESERVED}` means the model to start from and is not a prefix"
        return Fault("reserved-prefix", message, at, key=key, help="choose another name for the part")
    if not prefix:
        message = "a prefix is empty"
        help = 'to attach without a prefix, write `prefix: ""` in the part'
        return Fault("bad-name", message, at, key=key, help=help)
    if any(character.isspace() for character in prefix):
        joined = "_".join(prefix.split())
        return Fault("bad-name", f"the prefix `{prefix}` has a space in it", at, key=key, help=f"write `{joined}`")
    fault = odd_name(prefix, "a prefix", at, key=key)
    if fault is not None:
        return fault
    if separator in prefix and separator in PATH_LIKE:
        help = "mjcompose adds the separator; a part that is attached to another part has a prefix of its own"
        return Fault("bad-name", f"the prefix `{prefix}` has the separator `{separator}` in it", at, key=key, help=help)
    return None


Prefixes = Keys(lambda each, context: prefix_fault(each, context, (each,), key=True), _pattern("+"))

"""A recipe as a whole, with its sections `add`, `interface` and `check`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, ValidationInfo, WithJsonSchema
from pydantic.fields import FieldInfo

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.language.attach import Attachment, Prefixes, Start
from mjcompose.language.check import CheckEntry
from mjcompose.language.contact import Contact
from mjcompose.language.datasheets import Datasheets
from mjcompose.language.edit import Edits
from mjcompose.language.element import FRAGMENT, Reader
from mjcompose.language.element_schema import one_or_more
from mjcompose.language.forms.context import ByGrammar, Lazy, Schema, Settings, reference, settings, validation_error
from mjcompose.language.forms.model import IT, Model, Rest
from mjcompose.language.forms.scalars import Checked, Codes, Expects, Items, Keys, Name, Text, Turns, When
from mjcompose.language.forms.translate import has_key, inside
from mjcompose.language.keyframe import Keyframe
from mjcompose.language.placing import Frame, Place
from mjcompose.language.sections import Assets, ByTag, Defaults, PluginForm, RecipeClass, Section, Singleton, Typed
from mjcompose.language.value import RecipeElement, exclusive, is_unprintable, kind_of, name_fault, unprintable
from mjcompose.tree.grammar import GRAMMAR, ElementType

MORE = ("…", "...")
"""The last entry of a list that does not name everything."""
KINDS = ("joint", "actuator", "sensor", "key")


class NameEntry(Model):
    """One name, and the builds that have it."""

    example: ClassVar = "{name: NAME, when: {…}}"

    name: Annotated[str, Name(*KINDS)]
    """the name in the built model, or `…` as the last entry for more names"""
    repeats: Turns = Field(None, alias="for")
    when: When = None


def _name_of(entry: Any) -> str:
    return entry if isinstance(entry, str) else str(entry.name)


def _order_fault(entries: tuple[Any, ...]) -> Fault | None:
    names = [*map(_name_of, entries)]
    for index, name in enumerate(names):
        if name in MORE and index < len(names) - 1:
            message = f"`{name}` in {IT} is not the last entry"
            return Fault("out-of-range", message, (index,), help="write `…` at the end, for all other names")
        if name in names[:index]:
            return Fault("name-clash", f"`{name}` is in {IT} twice", (index,), help="remove one of them")
    return None


def _form_of(entry: Any) -> str:
    return "<mapping>" if isinstance(entry, dict | list | NameEntry) else "<word>"


_Entry = Annotated[NameEntry, Tag("<mapping>")]
_Joint = Annotated[Annotated[str, Name("joint"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Actuator = Annotated[Annotated[str, Name("actuator"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Sensor = Annotated[Annotated[str, Name("sensor"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Key = Annotated[Annotated[str, Name("key"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_EXPECTS = Expects("a list of names", "[lift, grip]")


class Order(Struct):
    """The names of one kind in their order; `more` says that other names may follow. `at` is the path of the list."""

    kind: str
    names: tuple[str, ...]
    more: bool
    at: Path


class Interface(Model):
    """Names in the order that programs rely on, such as a trained policy."""

    depth: ClassVar = 3
    example: ClassVar = "{actuator: [NAME, NAME]}"

    joint: Annotated[tuple[_Joint, ...], Items(), Checked(_order_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: joints, as in `qpos`."""
    actuator: Annotated[tuple[_Actuator, ...], Items(), Checked(_order_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: actuators, as in `ctrl`."""
    sensor: Annotated[tuple[_Sensor, ...], Items(), Checked(_order_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: sensors, as in `sensordata`."""
    key: Annotated[tuple[_Key, ...], Items(), Checked(_order_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: keys."""

    @property
    def orders(self) -> tuple[Order, ...]:
        found: list[Order] = []
        for kind in KINDS:
            entries: tuple[Any, ...] | None = getattr(self, kind)
            if entries is not None:
                names = tuple(name for name in map(_name_of, entries) if name not in MORE)
                at = (*(self.at or ("interface",)), kind)
                found.append(Order(kind, names, more=len(names) < len(entries), at=at))
        return tuple(found)


TO = "to"
WORLD = "world"


def addable(place: str) -> Mapping[str, ElementType]:
    """Return the elements that can be added to the world, a body or a frame."""
    return GRAMMAR.element("worldbody" if place == WORLD else place).children


def _elements(
    reader: Reader, value: dict[str, Any], at: Path, kinds: Mapping[str, ElementType], place: str
) -> tuple[RecipeElement, ...]:
    """Return the element of an entry, or all of a list of elements of one kind; empty after a reported fault."""
    found = [name for name in value if name in kinds or name == FRAGMENT]
    for name in value:
        if name not in _OF_AN_ADDITION and name not in found:
            reader.faults.append(_unknown(name, (*at, name), kinds, place=place))
    if not found:
        if set(value) <= _OF_AN_ADDITION:
            reader.faults.append(Fault("missing-key", "an entry of `add` has no element", at, help=_NO_ELEMENT))
        return ()
    first, *others = found
    for name in others:
        message = f"an entry of `add` has both `{first}` and `{name}`, of which only one is allowed"
        help = f"write an entry of its own for `{name}`"
        reader.faults.append(exclusive(message, (first, name), at, help=help))
    if first == FRAGMENT:
        fragment = reader.fragment(kinds, place, value, at=at, own=(*_OF_AN_ADDITION, *others))
        return () if fragment is None else (fragment,)
    path = (*at, first)
    if value[first] == []:
        reader.faults.append(Fault("missing-key", f"the list `{first}` has no element", path, help=_NO_ELEMENT))
    return tuple(reader.children(kinds[first], value[first], path, owner="an entry of `add`"))


_NO_ELEMENT = "write the element as `TAG: {…}`, for instance `site: {name: tcp, pos: [0, 0, 0.1]}`"


def _unknown(name: str, at: Path, kinds: Mapping[str, ElementType], place: str) -> Fault:
    if name in addable("body"):
        message = f"`{name}` is not allowed in {place}, only in a body"
        return Fault("unknown-element", message, at, key=True)
    help, fix = advised(name, [*kinds, TO])
    note = exists_note("element", kinds, name)
    if name in GRAMMAR.section("asset").children and name not in kinds:
        help = f"write it in the section `asset`: `asset: {{{name}: {{NAME: {{…}}}}}}`"
        fix = None
    if name in GRAMMAR.root.children:
        help = f"write it in the section `{name}`"
        fix = None
    message = f"`{name}` is not an element that can be added"
    return Fault("unknown-element", message, at, key=True, notes=(note,), help=help, fix=fix)


class _Added(ByGrammar):
    """The elements of an entry of `add`, which are written by their tag next to the entry's own keys."""

    def _validate(self, value: Any, info: ValidationInfo) -> tuple[RecipeElement, ...]:
        context = settings(info.context)
        faults: list[Fault] = []
        place = info.data.get(TO)
        kinds = addable(WORLD if place == WORLD else "frame" if isinstance(place, Frame) else "body")
        where = "the world" if place == WORLD else "`add`"
        elements = _elements(Reader(context, faults), value, (), kinds=kinds, place=where)
        if faults:
            raise validation_error(faults, value)
        return elements

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[RecipeElement, ...]:
        raise NotImplementedError

    def schema(self) -> Schema:
        elements = {tag: one_or_more(kind) for tag, kind in GRAMMAR.element("body").children.items()}
        size = 1 + len(_OF_AN_ADDITION)
        return {"properties": {**elements, FRAGMENT: reference("fragment")}, "minProperties": 2, "maxProperties": size}


class Addition(Model):
    """One entry of `add`: an element, or several of one kind, and where they are added.

    The place of the name is `locate(node, (*at, "to"))`, and for a frame `locate(node, (*at, "to", "frame"))`.
    """

    example: ClassVar = "{to: NAME, TAG: {…}}"

    id: Text | None = None
    """A name for merging: an item with the same name replaces this item."""
    to: Place = Field(examples=["world"])
    """The name of a body, `world`, or `{frame: NAME}`."""
    elements: Annotated[tuple[RecipeElement, ...], _Added(), Rest()] = Field(alias="<element>")
    repeats: Turns = Field(None, alias="for")
    when: When = None

    @property
    def to_kind(self) -> Literal["world", "body", "frame"]:
        return "frame" if isinstance(self.to, Frame) else "world" if self.to == WORLD else "body"

    @property
    def to_name(self) -> str:
        return self.to.frame if isinstance(self.to, Frame) else self.to


_OF_AN_ADDITION = frozenset(Addition.key_names())

VERSION = 1
SETTABLE = frozenset("discardvisual fusestatic boundmass boundinertia settotalmass lengthrange".split())


def _version_fault(value: Any) -> Fault | None:
    # In Python, `True == 1` and `1.0 == 1`.
    if type(value) is int and value == VERSION:
        return None
    message = f"`recipe` expects the version of the language, the number {VERSION}, got {kind_of(value)}"
    help = f"write `recipe: {VERSION}`"
    if type(value) is int and value > VERSION:
        message = f"the recipe is written in version {value} of the language; this mjcompose knows {VERSION}"
        help = f"install a newer mjcompose, or write `recipe: {VERSION}`"
    return Fault("recipe-version", message, help=help)


class Settled:
    """Marks a key that is resolved and removed before a recipe is validated."""


def _sequence_fault(text: str) -> Fault | None:
    if len(text) == 3 and set(text.lower()) <= set("xyz"):
        return None
    message = f"`eulerseq` is three letters of `xyz` (about the moving axes) and `XYZ` (fixed axes), got `{text}`"
    return Fault("wrong-keyword", message, help="write for instance `eulerseq: xyz`")


class Recipe(Model):
    """A recipe: the sources of a model and their changes.

    The fields are in the order of the language: `fmt` writes the keys, and sections of one form are carried out, in
    this order. Sections hold their elements in the order of the file. A section that is not written is None or empty.
    """

    instead: ClassVar = {"motors": "datasheets"}
    owned: ClassVar = ""

    recipe: Annotated[int, Checked(_version_fault, first=True), WithJsonSchema({"const": VERSION})]
    """The version of the language: 1."""
    name: Annotated[str, Name(what="text", new=True)] | None = None
    """The model's name; without it, the stem of the recipe's file."""
    description: (
        Annotated[str, Checked(lambda text: unprintable(IT, (), name=False) if is_unprintable(text) else None)] | None
    ) = None
    """Free text for the manifest."""
    extends: Annotated[Text | None, Settled()] = None
    """Another recipe, over which this file is merged."""
    trust: Annotated[Any, Lazy("mjcompose.language.variation:TrustKeys"), Settled()] = None
    """Files and references on this machine that others may use. It counts only in the recipe that you build."""
    angle: Literal["degree", "radian"] | None = None
    """The unit of angles without a unit in this file. Without it, such an angle is an error."""
    eulerseq: Annotated[str, Checked(_sequence_fault)] = "xyz"
    """The sequence of rotations of `euler` in this file: lower case for moving axes, upper case for fixed."""
    separator: Literal["/", ":", ".", "-", "_", "__"] = "/"
    """The character between a prefix and a name."""
    conflict: Literal["error", "base", "mujoco"] = "error"
    """The treatment of parts that disagree in `option`, `size`, `statistic` or `visual`."""
    params: Annotated[Any, Lazy("mjcompose.language.variation:Params"), Settled()] = None
    """Parameters by name: the values of `${name}`, which --set and `with` may set."""
    base: Annotated[Attachment | None, Start()] = None
    """The model to start from, which keeps its names; by default an empty model."""
    attach: Annotated[
        dict[str, Attachment], Prefixes, Expects("a mapping from prefix to part", "{PREFIX: {model: …}}")
    ] = Field(default_factory=dict)
    """The parts by prefix, each with a model and a place."""
    compiler: Annotated[RecipeElement | None, Singleton("compiler", SETTABLE)] = None
    """Compiler settings of the whole model. Each part keeps its own values of the others."""
    option: Annotated[RecipeElement | None, Singleton("option")] = None
    """Simulation options."""
    size: Annotated[RecipeElement | None, Singleton("size")] = None
    """Memory and array sizes."""
    visual: Annotated[RecipeElement | None, Singleton("visual")] = None
    """Rendering settings."""
    statistic: Annotated[RecipeElement | None, Singleton("statistic")] = None
    """Model statistics that override MuJoCo's own."""
    extension: Annotated[tuple[RecipeElement, ...], PluginForm("extension")] = ()
    """Plugins and their instances: `plugin: {NAME: {instance: {NAME: {config: {KEY: VALUE}}}}}`."""
    default: Annotated[tuple[RecipeClass, ...], Defaults("default")] = ()
    """Default classes by name, each with settings by tag; `main` is the top class."""
    asset: Annotated[tuple[RecipeElement, ...], Assets("asset")] = ()
    """Meshes, textures, materials and other assets, by tag and name; a height field can be a `terrain`, which mjcompose
    makes."""
    add: Annotated[tuple[Addition, ...], Items(), Expects("a list of entries", "[{to: NAME, TAG: {…}}]")] = ()
    """Elements under a body, a frame or the world."""
    deformable: Annotated[tuple[RecipeElement, ...], ByTag("deformable")] = ()
    """Flexes and skins, by tag and name."""
    contact: Contact = Field(default_factory=Contact)
    """Pairs of geoms that may touch and bodies that may not: lists by tag, or `exclude: touching`, `exclude` and
    `collide: {between: [ARM, TABLE]}`."""
    tendon: Annotated[tuple[RecipeElement, ...], Typed("tendon")] = ()
    """Tendons by name; `path` has their steps in order."""
    equality: Annotated[tuple[RecipeElement, ...], Typed("equality")] = ()
    """Equality constraints by name."""
    actuator: Annotated[tuple[RecipeElement, ...], Typed("actuator")] = ()
    """Actuators by name."""
    sensor: Annotated[tuple[RecipeElement, ...], Typed("sensor")] = ()
    """Sensors by name."""
    custom: Annotated[tuple[RecipeElement, ...], ByTag("custom")] = ()
    """Custom numbers, texts and tuples, by tag and name."""
    datasheets: Datasheets = Field(default_factory=dict)
    """Data sheets of motors for the verb `datasheet` of `edit`: a mapping from their names to torque, speed, gear,
    inertia and source."""
    edit: Edits = ()
    """Changes to selected elements, in order, after everything else is in place."""
    measured: Annotated[Any, Lazy("mjcompose.language.measured:UseMeasured")] = None
    """The file with the measured numbers of one robot, which the model gets after `edit`."""
    identify: Annotated[Any, Lazy("mjcompose.language.identify:Identify")] = None
    """The numbers that `mjcompose identify` fits to recordings of a robot."""
    keyframe: Annotated[
        dict[str, Keyframe],
        Keys(lambda name, _: name_fault(name, IT, (name,))),
        Expects("a mapping from names to keys", "{home: {qpos: {JOINT: 0.1}}}"),
    ] = Field({})
    """Keyframes by name, with values by joint, actuator and mocap body."""
    interface: Interface | None = None
    """Names of joints, actuators, sensors and keys in the order that programs rely on: a list by kind, with `…` at the
    end if there are more."""
    variants: Annotated[Any, Lazy("mjcompose.language.variation:Variants"), Settled()] = None
    """Pieces of recipe by axis and value. One piece of each axis is merged over the recipe."""
    matrix: Annotated[Any, Lazy("mjcompose.language.variation:Grid"), Settled()] = None
    """The combinations that `build --all` builds."""
    randomize: Annotated[Any, Lazy("mjcompose.language.randomize:Randomize")] = None
    """Seeded draws: samples of the model that `build --all` builds."""
    check: Annotated[dict[str, CheckEntry], Expects("a mapping from names to checks", "{whole: {unchanged: {}}}")] = (
        Field({})
    )
    """Conditions that the model must meet, by name."""
    allow: Codes = ()
    """The codes of warnings that you accept: they are not reported. Parts and edits can have it, too."""

    @classmethod
    def listed(cls) -> list[str]:
        return sorted(cls.key_names(), key=lambda name: name in SETTLED)


def sections_of(form: type[object]) -> tuple[str, ...]:
    """Return the keys of a recipe that are sections with a form, in the order of the language.

    >>> sections_of(Defaults)
    ('default',)
    """
    fields = Recipe.model_fields.items()
    return tuple(name for name, field in fields if any(isinstance(mark, form) for mark in field.metadata))


SETTLED = sections_of(Settled)


def _depth(info: FieldInfo) -> int:
    """Return the number of levels below a recipe at which a key has items that can have `when`; 0 if there are none."""
    section = next((mark for mark in info.metadata if isinstance(mark, Section)), None)
    if section is not None:
        return section.depth
    kind = inside(info.annotation, 0)
    depth = getattr(kind, "depth", None)
    if isinstance(depth, int):
        return depth
    return 1 if has_key(kind, "when") else 2 if has_key(inside(kind, 1), "when") else 0


DEPTHS = {name: depth for name, info in Recipe.model_fields.items() if (depth := _depth(info))}
"""The depth of the items that can have `when`: `sensor.NAME`, `asset.mesh.NAME`, `add[0]`."""

"""A recipe as a whole, with its sections `add` and `check`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.language.attach import Attachment, Prefixes, Start
from mjcompose.language.check import CheckEntry
from mjcompose.language.codes import Allowed
from mjcompose.language.datasheets import Datasheets
from mjcompose.language.edit import Edits
from mjcompose.language.element import FRAGMENT, Reader, label, path_of
from mjcompose.language.element_schema import mapping
from mjcompose.language.expand import SETTLED
from mjcompose.language.form import (
    EXCLUSIVE,
    Element,
    Form,
    Schema,
    Settings,
    definition,
    is_unprintable,
    kind_of,
    reference,
    unprintable,
)
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.rows import Lazy
from mjcompose.language.forms.scalars import Checked, Expects, Name
from mjcompose.language.fragment import missing_key
from mjcompose.language.keyframe import Keyframe, Keyframes
from mjcompose.language.sections import ByTag, DefaultClass, Defaults, Extension, Singleton, Typed
from mjcompose.language.select import Collisions, Contacts
from mjcompose.model.grammar import GRAMMAR, ElementType

TO = "to"
ID = "id"
WORLD = "world"
Target = tuple[Literal["world", "body", "frame"], str]


@dataclass(frozen=True, slots=True)
class Addition:
    """One entry of `add`: an element, and where it is added.

    `to` is the name of a body or frame, or `world`. The place of the name is `locate(node, (*at, "to"))`, and for a
    frame `locate(node, (*at, "to", "frame"))`.
    """

    to_kind: Literal["world", "body", "frame"]
    to: str
    element: Element
    at: Path = ()


@dataclass(frozen=True, slots=True)
class Additions(Form):
    """Form of the field `add`: a list of `{to: NAME, TAG: {…}}`, read as a tuple of `Addition`."""

    def schema(self) -> Schema:
        return {"type": "array", "items": reference("addition")}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Addition, ...]:
        reader = Reader(settings, faults)
        additions: list[Addition | None] = []
        if isinstance(value, list):
            additions = [_addition(reader, item, (index,)) for index, item in enumerate(value)]
        else:
            help = f"put `- ` in front of `{TO}`" if isinstance(value, dict) and TO in value else None
            message = f"`add` expects a list of entries, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message, help=help))
        return tuple(each for each in additions if each is not None)


def addable(place: str) -> Mapping[str, ElementType]:
    """Return the elements that can be added to the world, a body or a frame."""
    return GRAMMAR.element("worldbody" if place == WORLD else place).children


def _addition(reader: Reader, value: Any, at: Path) -> Addition | None:
    if not isinstance(value, dict):
        message = f"an entry of `add` is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help="write `{to: NAME, TAG: {…}}`"))
        return None
    target: Target | None = None
    if TO in value:
        target = _target(reader, value[TO], (*at, TO))
    else:
        fault = missing_key("an entry of `add`", TO, at)
        help = "write `to: world`, or the name of a body"
        reader.faults.append(replace(fault, key=False, help=help))
    kinds = addable(target[0] if target else "body")
    element = _element(reader, value, at, kinds=kinds, place="the world" if target and target[0] == WORLD else "`add`")
    if target is None or element is None:
        return None
    return Addition(target[0], target[1], element, at=path_of(value))


def _element(
    reader: Reader, value: dict[str, Any], at: Path, kinds: Mapping[str, ElementType], place: str
) -> Element | None:
    """Return the one element of an entry, or None after a reported fault."""
    found = [name for name in value if name in kinds or name == FRAGMENT]
    for name in value:
        if name != TO and name not in found:
            reader.faults.append(_unknown(name, (*at, name), kinds, place=place))
    if not found:
        if set(value) <= {TO}:
            help = "write the element as `TAG: {…}`, for instance `site: {name: tcp, pos: [0, 0, 0.1]}`"
            reader.faults.append(Fault("missing-key", "an entry of `add` has no element", at, help=help))
        return None
    first, *others = found
    for name in others:
        reader.faults.append(
            Fault(
                EXCLUSIVE,
                f"an entry of `add` has both `{first}` and `{name}`, of which only one may stand",
                (*at, name),
                key=True,
                related=((f"`{first}` is written here", (*at, first)),),
                help=f"write an entry of its own for `{name}`",
            )
        )
    if first == FRAGMENT:
        return reader.fragment(kinds, place, value, at=at, own=(TO, *others))
    item = value[first]
    if isinstance(item, list):
        help = f"write an entry of its own for each `{first}`"
        message = f"an entry of `add` has one `{first}`, got a list"
        reader.faults.append(Fault("wrong-type", message, (*at, first), help=help))
        return None
    return reader.element(kinds[first], item, (*at, first), label(first, item))


def _unknown(name: str, at: Path, kinds: Mapping[str, ElementType], place: str) -> Fault:
    if name in addable("body"):
        message = f"`{name}` cannot stand in {place}, only in a body"
        return Fault("unknown-element", message, at, key=True)
    help, fix = advised(name, [*kinds, TO])
    note = exists_note("element", kinds, name)
    if name in GRAMMAR.root.children:
        help, fix = f"write it in the section `{name}`", None
    return Fault(
        "unknown-element",
        f"`{name}` is not an element that can be added",
        at,
        key=True,
        notes=(note,),
        help=help,
        fix=fix,
    )


def _target(reader: Reader, value: Any, at: Path) -> Target | None:
    """Return where an element is added: a name, `world`, or `{frame: NAME}`."""
    kind: Literal["body", "frame"] = "body"
    if isinstance(value, dict) and list(value) == ["frame"]:
        kind, value, at = "frame", value["frame"], (*at, "frame")
    if not isinstance(value, str) or not value:
        help = "write the name of a body, `world`, or `{frame: NAME}`"
        message = f"`{TO}` expects a name, got {kind_of(value) if value != '' else 'empty text'}"
        reader.faults.append(Fault("wrong-type", message, at, help=help))
        return None
    if is_unprintable(value):
        reader.faults.append(unprintable(f"`{TO}`", at))
        return None
    if kind == "body" and value == WORLD:
        return "world", WORLD
    return kind, value


@definition("addition")
def _definition_of_addition(_: str) -> Schema:
    frame = {
        **mapping({"frame": {"type": "string", "minLength": 1, "description": "the name of a frame"}}),
        "required": ["frame"],
    }
    target: Schema = {
        "anyOf": [{"type": "string", "minLength": 1}, frame],
        "description": "the name of a body, `world`, or `{frame: NAME}`",
    }
    elements = {tag: reference(f"element:{kind.path}") for tag, kind in GRAMMAR.element("body").children.items()}
    schema = mapping({"to": target, **elements, FRAGMENT: reference("fragment")})
    return {**schema, "required": ["to"], "minProperties": 2, "maxProperties": 2}


VERSION = 1
SETTABLE = frozenset("discardvisual fusestatic boundmass boundinertia settotalmass lengthrange".split())


@dataclass(frozen=True, slots=True)
class Version(Form):
    """Form of the field `recipe`: the version of the language."""

    def schema(self) -> Schema:
        return {"const": VERSION}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> int:
        # In Python, `True == 1` and `1.0 == 1`.
        if type(value) is int and value == VERSION:
            return VERSION
        message = f"`recipe` expects the version of the language, the number {VERSION}, got {kind_of(value)}"
        help = f"write `recipe: {VERSION}`"
        if type(value) is int and value > VERSION:
            message = f"the recipe is written in version {value} of the language; this mjcompose knows {VERSION}"
            help = f"install a newer mjcompose, or write `recipe: {VERSION}`"
        faults.append(Fault("recipe-version", message, help=help))
        return VERSION


def _unprintable(text: str) -> Fault | None:
    return unprintable(IT, (), name=False) if is_unprintable(text) else None


def _sequence_fault(text: str) -> Fault | None:
    """Return the fault of a sequence of rotations, or None."""
    if len(text) == 3 and set(text.lower()) <= set("xyz"):
        return None
    message = f"`eulerseq` is three letters of `xyz` (about the moving axes) and `XYZ` (fixed axes), got `{text}`"
    return Fault("wrong-keyword", message, help="write for instance `eulerseq: xyz`")


class Recipe(Model):
    """A recipe: what a model is made of.

    The fields are in the order of the language: that in which `fmt` writes the keys, and in which sections of one
    form are carried out. Sections hold their elements in the order of the file. A section that is not written is None
    or empty.
    """

    instead: ClassVar = {"motors": "datasheets"}

    recipe: Annotated[Literal[1], Version()]
    """The version of the language: 1."""
    name: Annotated[str, Name(what="text")] | None = None
    """The model's name; without it, the stem of the recipe's file."""
    description: Annotated[str, Checked(_unprintable)] | None = None
    """Free text that reaches the manifest."""
    angle: Literal["degree", "radian"] | None = None
    """The unit of angles without a unit in this file. Without it, such an angle is an error."""
    eulerseq: Annotated[str, Checked(_sequence_fault)] = "xyz"
    """The sequence of rotations of `euler` in this file: lower case for moving axes, upper case for fixed."""
    separator: Literal["/", ":", ".", "-", "_", "__"] = "/"
    """What stands between a prefix and a name."""
    conflict: Literal["error", "base", "mujoco"] = "error"
    """What happens where parts disagree in `option`, `size`, `statistic` or `visual`."""
    base: Annotated[Attachment | None, Start()] = None
    """The model to start from: a part without a prefix, at the world; without it, an empty one."""
    attach: Annotated[
        Mapping[str, Attachment], Prefixes(), Expects("a mapping from prefix to part", "{PREFIX: {model: …}}")
    ] = Field(default_factory=dict)
    """The parts: a mapping from the prefix of their names to what they are and where they hang."""
    compiler: Annotated[Element | None, Singleton("compiler", SETTABLE)] = None
    """Compiler settings that a whole model has; each part keeps its own of the others."""
    option: Annotated[Element | None, Singleton("option")] = None
    """Simulation options."""
    size: Annotated[Element | None, Singleton("size")] = None
    """Memory and array sizes."""
    visual: Annotated[Element | None, Singleton("visual")] = None
    """Rendering settings."""
    statistic: Annotated[Element | None, Singleton("statistic")] = None
    """Model statistics that override what MuJoCo computes."""
    extension: Annotated[tuple[Element, ...], Extension("extension")] = ()
    """Plugins and their instances: `plugin: {NAME: {instance: {NAME: {config: {KEY: VALUE}}}}}`."""
    default: Annotated[tuple[DefaultClass, ...], Defaults("default")] = ()
    """Default classes: a mapping from class to its settings by tag; `main` is the top class."""
    asset: Annotated[tuple[Element, ...], ByTag("asset")] = ()
    """Meshes, textures, materials and other assets: by tag, a mapping from their names."""
    add: Annotated[tuple[Addition, ...], Additions()] = ()
    """Elements under a body, a frame or the world."""
    deformable: Annotated[tuple[Element, ...], ByTag("deformable")] = ()
    """Flexes and skins: by tag, a mapping from their names."""
    contact: Annotated[tuple[Element | Collisions, ...], Contacts("contact")] = ()
    """Pairs of geoms that may touch and bodies that may not: lists by tag, or `exclude: touching`, `exclude` and
    `collide: {between: [ARM, TABLE]}`."""
    tendon: Annotated[tuple[Element, ...], Typed("tendon")] = ()
    """Tendons: a mapping from their names; `path` has their steps in order."""
    equality: Annotated[tuple[Element, ...], Typed("equality")] = ()
    """Equality constraints: a mapping from their names."""
    actuator: Annotated[tuple[Element, ...], Typed("actuator")] = ()
    """Actuators: a mapping from their names."""
    sensor: Annotated[tuple[Element, ...], Typed("sensor")] = ()
    """Sensors: a mapping from their names."""
    custom: Annotated[tuple[Element, ...], ByTag("custom")] = ()
    """Custom numbers, texts and tuples: by tag, a mapping from their names."""
    datasheets: Datasheets = Field(default_factory=dict)
    """Data sheets of motors for the verb `datasheet` of `edit`: a mapping from their names to torque, speed, gear,
    inertia and source."""
    edit: Edits = ()
    """Ordered changes to the model, by selectors, when everything else is in place."""
    keyframe: Annotated[tuple[Keyframe, ...], Keyframes("keyframe")] = ()
    """Keys: a mapping from their names to entries by the names of joints, actuators and mocap bodies."""
    randomize: Annotated[Any, Lazy("mjcompose.language.randomize:Randomize")] = None
    """Seeded draws: samples of the model that `build --all` builds."""
    check: Annotated[dict[str, CheckEntry], Expects("a mapping from names to checks", "{whole: {unchanged: {}}}")] = (
        Field({})
    )
    """Conditions that the model must meet: a mapping from a name to a check."""
    allow: Annotated[tuple[str, ...], Allowed()] = ()
    """The codes of warnings that are meant to be there: they are not reported. Parts and edits can have it, too."""

    @classmethod
    def owner(cls, at: Path) -> str:
        return ""

    @classmethod
    def listed(cls) -> list[str]:
        return [*cls.key_names(), *SETTLED]


def sections_of(form: type[object]) -> tuple[str, ...]:
    """Return the keys of a recipe that are sections with a form, in the order of the language.

    >>> sections_of(Defaults)
    ('default',)
    """
    fields = Recipe.model_fields.items()
    return tuple(name for name, field in fields if any(isinstance(mark, form) for mark in field.metadata))

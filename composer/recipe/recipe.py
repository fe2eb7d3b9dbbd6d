"""A recipe as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from composer.dataclass import dataclass
from composer.recipe.add import Addition, Additions
from composer.recipe.allow import Allowed
from composer.recipe.attach import Attachment, Prefixes
from composer.recipe.base import Base
from composer.recipe.by_tag import ByTag
from composer.recipe.check import Checks
from composer.recipe.checks.kind import Check
from composer.recipe.contact import Collisions, Contacts
from composer.recipe.default_class import DefaultClass, Defaults
from composer.recipe.edit import Edit, Edits
from composer.recipe.element import Element
from composer.recipe.extension import Extension
from composer.recipe.fault import Fault
from composer.recipe.form import Form
from composer.recipe.keyframe import Keyframe, Keyframes
from composer.recipe.model import Model
from composer.recipe.motors import Motor, Motors
from composer.recipe.randomize import Randomize
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.singleton import Singleton
from composer.recipe.text import Choice, Text
from composer.recipe.typed import Typed

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
            message = (
                f"the recipe is written in version {value} of the language; this mjcompose knows {VERSION}"
            )
            help = f"install a newer mjcompose, or write `recipe: {VERSION}`"
        faults.append(Fault("recipe-version", message, help=help))
        return VERSION


def _sequence_fault(text: str) -> Fault | None:
    """Return the fault of a sequence of rotations, or None."""
    if len(text) == 3 and set(text.lower()) <= set("xyz"):
        return None
    message = (
        f"`eulerseq` is three letters of `xyz` (about the moving axes) and `XYZ` (fixed axes), got `{text}`"
    )
    return Fault("wrong-keyword", message, help="write for instance `eulerseq: xyz`")


class Recipe(Model):
    """A recipe: what a model is made of.

    The fields are in the order of the language: that in which `fmt` writes the keys, and in which sections of one
    form are carried out. Sections hold their elements in the order of the file. A section that is not written is None
    or empty.
    """

    recipe: Annotated[Literal[1], Version()]
    """The version of the language: 1."""
    name: Annotated[str | None, Text("name")] = None
    """The model's name; without it, the stem of the recipe's file."""
    description: Annotated[str | None, Text("description", empty=True)] = None
    """Free text that reaches the manifest."""
    angle: Annotated[Literal["degree", "radian"] | None, Choice("angle")] = None
    """The unit of angles without a unit in this file. Without it, such an angle is an error."""
    eulerseq: Annotated[str, Text("eulerseq", check=_sequence_fault)] = "xyz"
    """The sequence of rotations of `euler` in this file: lower case for moving axes, upper case for fixed."""
    separator: Annotated[Literal["/", ":", ".", "-", "_", "__"], Choice("separator")] = "/"
    """What stands between a prefix and a name."""
    conflict: Annotated[Literal["error", "warning", "merge"], Choice("conflict")] = "error"
    """What happens where parts disagree in `option`, `size`, `statistic` or `visual`."""
    base: Base | None = None
    """The model to start from, which keeps its own names; without it, an empty one."""
    attach: Annotated[Mapping[str, Attachment], Prefixes()] = Field(default_factory=dict)
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
    motors: Annotated[Mapping[str, Motor], Motors()] = Field(default_factory=dict)
    """Data sheets of motors for the verb `motor` of `edit`: a mapping from their names to torque, speed, gear,
    inertia and source."""
    edit: Annotated[tuple[Edit, ...], Edits()] = ()
    """Ordered changes to the model, by selectors, when everything else is in place."""
    keyframe: Annotated[tuple[Keyframe, ...], Keyframes("keyframe")] = ()
    """Keys: a mapping from their names to entries by the names of joints, actuators and mocap bodies."""
    randomize: Randomize | None = None
    """Seeded draws: samples of the model that `build --all` builds."""
    check: Annotated[tuple[Check, ...], Checks()] = ()
    """What must hold of the model: a mapping from a name to a check."""
    allow: Annotated[tuple[str, ...], Allowed()] = ()
    """The codes of warnings that are meant to be there: they are not reported. Parts and edits can have it, too."""


def sections_of(form: type[object]) -> tuple[str, ...]:
    """Return the keys of a recipe that are sections with a form, in the order of the language.

    >>> sections_of(Defaults)
    ('default',)
    """
    fields = Recipe.model_fields.items()
    return tuple(name for name, field in fields if any(isinstance(mark, form) for mark in field.metadata))

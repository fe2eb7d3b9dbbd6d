"""The keys that place a part, and recipes that are written in place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, SkipValidation, Tag, WithJsonSchema

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.rotation import cross
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.base.words import value_text
from mjcompose.language.element import Reader, label
from mjcompose.language.forms.context import ByGrammar, Schema, Settings, computable, reference
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import AttributeValue, Checked, Name
from mjcompose.language.fragment import missing_key
from mjcompose.language.value import RecipeElement, Single, is_unprintable, kind_of, unprintable
from mjcompose.text.expression import Angle
from mjcompose.text.key_order import WHOLE
from mjcompose.text.node import Key, Mapping as Located, Scalar, Sequence as List, find
from mjcompose.tree.grammar import GRAMMAR

INHERITED = ("recipe", "angle", "eulerseq", "separator", "conflict")
"""Settings that a model in place takes from its recipe unless it sets them."""
Judge = Callable[[Located], list[Fault]]
OF_A_FILE = {
    "extends": "write it into a file of its own: `model: ./NAME.yaml`",
    "trust": "write it in the recipe itself",
    "params": "declare them in `params` of the recipe: `${…}` has the same values here",
    "variants": "write them in `variants` of the recipe: a piece may change them",
    "matrix": "write it in the recipe itself",
    "randomize": "write it in the recipe itself; its fields can select elements of this model",
}


def advice_to_choose(models: Sequence[str]) -> str:
    """Return what to write to choose one of several models in each sample."""
    drawn = f"`randomize` with `fields: {{which: {{param: which, choice: [{', '.join(models)}]}}}}`"
    return f'one in each sample: `params: {{which: {models[0]}}}`, `model: "${{which}}"`, and {drawn}'


def _model_fault(value: Any) -> Fault | None:
    if isinstance(value, list):
        message = f"{IT} is a model reference, or a recipe as a mapping, got a list"
        one_of = bool(value) and all(isinstance(each, str) for each in value)
        return Fault("wrong-type", message, help=advice_to_choose(value) if one_of else "write `model: {add: […]}`")
    if isinstance(value, dict):
        return None
    if not isinstance(value, str):
        return Fault("wrong-type", f"{IT} expects text, got {kind_of(value)}", help=f"quote it: '{value_text(value)}'")
    if not value:
        return Fault("wrong-type", f"{IT} is empty")
    return unprintable(IT, ()) if is_unprintable(value) else None


ModelReference = Annotated[
    str | Mapping[str, Any],
    SkipValidation,
    Checked(_model_fault, first=True),
    WithJsonSchema({"anyOf": [{"type": "string", "minLength": 1}, reference("made:InPlace")]}),
]
"""A model reference, or a recipe as a mapping, which the planner reads."""


class Frame(Model):
    """A frame by its name."""

    instead: ClassVar = {
        "body": "write the name of the body alone",
        **dict.fromkeys(("site", "geom", "joint"), "write the name of a body, or `{frame: NAME}`"),
    }

    frame: Annotated[str, Name("frame", computed=True)] = Field(examples=["NAME"])
    """the name of a frame"""


_LETTERS = "xyz"


class Mirror(Model):
    """The pose of another part, reflected."""

    example: ClassVar = "{of: left, across: y}"

    of: Annotated[str, Name(what="the name of a part")] = Field(examples=["left"])
    """the other part"""
    across: Literal["x", "y", "z"] = Field(examples=["y"])
    """the axis of the recipe's world that points across the mirror"""
    symmetry: Literal["x", "y", "z"] | None = None
    """the part's own axis that points across its plane of symmetry; without it, the same letter as `across`"""
    keys: bool = False
    """also takes the keyframes of the other part, reflected joint by joint"""

    @property
    def axes(self) -> tuple[int, int]:
        return _LETTERS.index(self.across), _LETTERS.index(self.symmetry or self.across)


Place = Annotated[
    Annotated[str, Name("body", computed=True, what="a body, `world`, or `{frame: NAME}`"), Tag("<name>")]
    | Annotated[Frame, Tag("<mapping>")],
    Discriminator(lambda value: "<mapping>" if isinstance(value, dict | Frame) else "<name>"),
]


class Inline:
    """The rule that a recipe that is written as a part has `model` above it."""

    alone = True

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        """Yield the fault of a mapping with keys that only a recipe has."""
        strange = [key for key in value if key in WHOLE[()] and key not in model.key_names()]
        if "model" in value or not strange:
            return
        keys = ", ".join(f"`{key}`" for key in strange)
        message = f"{keys} of {IT} {'stands' if len(strange) == 1 else 'stand'} where a `model` is expected"
        help = f"write a model in place below `model`: `model: {{{strange[0]}: …}}`"
        yield Fault("missing-key", message, (strange[0],), key=True, help=help)

    def schema(self) -> Iterator[Schema]:
        """Yield nothing: a part has no such keys anyway."""
        return iter(())


def with_inherited(model: Located, around: Located) -> Located:
    """Return the recipe that is written in place, with the settings it inherits from the recipe around it."""
    inherited = {name: entry for name, entry in around.entries.items() if name in INHERITED}
    known = {name: entry for name, entry in model.entries.items() if name not in OF_A_FILE}
    version = Key("recipe", model.span), Scalar(1, model.span, "1", plain=True)
    return Located({"recipe": version, **inherited, **known}, model.span)


def faults_in_place(node: Located, judge: Judge) -> Iterator[Fault]:
    """Yield the faults of the recipes that are written in place. `judge` finds the faults of one recipe."""
    for at, model in _models(node):
        choice = _choice(model)
        if choice is not None:
            message = "`model` is a model reference or a recipe, and a choice among models is drawn"
            yield Fault("unknown-key", message, (*at, "choice"), key=True, help=advice_to_choose(choice))
            continue
        yield from (
            Fault("unknown-key", f"a model that is written in place has no `{name}`", (*at, name), key=True, help=help)
            for name, help in OF_A_FILE.items()
            if name in model.entries
        )
        for fault in judge(with_inherited(model, node)):
            if not fault.at or fault.at[0] in model.entries:
                related = tuple((message, (*at, *path)) for message, path in fault.related)
                yield replace(fault, at=(*at, *fault.at), related=related)


def _choice(model: Located) -> list[str] | None:
    choice = find(model, ("choice",))
    if len(model.entries) > 1 or not isinstance(choice, List) or not choice.items:
        return None
    return [each.text for each in choice.items if isinstance(each, Scalar)] or None


def _models(node: Located) -> Iterator[tuple[Path, Located]]:
    parts = find(node, ("attach",))
    names = list(parts.entries) if isinstance(parts, Located) else []
    for at in (("base", "model"), *(("attach", name, "model") for name in names)):
        model = find(node, at)
        if isinstance(model, Located):
            yield at, model


ORIENTATIONS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
WORDS = ("none", "free", "ball", "mocap")
JointWord = Literal["none", "free", "ball", "mocap"]
JointType = ("hinge", "slide", "ball")
TINY = 1e-10
"""MuJoCo treats axes shorter than this as zero."""
_NEUTRAL = {
    "quat": "`[1, 0, 0, 0]`",
    "axisangle": "an axis, such as `[0, 0, 1, 90deg]`",
    "zaxis": "`[0, 0, 1]`",
    "xyaxes": "`[1, 0, 0, 0, 1, 0]`",
}


class Offset(AttributeValue):
    """Form of `pos` or an orientation of the frame of a place: a tuple, with `Angle`s if it is an angle."""

    def __init__(self, name: str) -> None:
        super().__init__("frame", name)

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        read = super().read(value, faults, settings)
        if faults:
            return None
        fault = _no_pose(self.name, read)
        faults += [fault] if fault is not None else []
        return read


def _no_pose(name: str, read: tuple[Single, ...]) -> Fault | None:
    """Return the fault of numbers that are not a pose; MuJoCo would report a frame that the user has not written."""
    numbers = [float(item.value if isinstance(item, Angle) else item) for item in read]
    if not all(math.isfinite(number) for number in numbers):
        wrong = next(index for index, number in enumerate(numbers) if not math.isfinite(number))
        return Fault("out-of-range", f"{IT} expects finite numbers", (wrong,), help="write a number")
    axes = {"quat": [numbers], "axisangle": [numbers[:3]], "zaxis": [numbers], "xyaxes": [numbers[:3], numbers[3:]]}
    for axis in axes.get(name, ()):
        if math.hypot(*axis) < TINY:
            message = f"{IT} is not an orientation: all its numbers are zero"
            return Fault("out-of-range", message, help=f"leave `{name}` out, or write {_NEUTRAL[name]}")
    if name == "xyaxes" and math.hypot(*cross(numbers[:3], numbers[3:])) < TINY:
        message = f"{IT} is not an orientation: its two axes have the same direction"
        return Fault("out-of-range", message, help="write axes at a right angle, such as `[1, 0, 0, 0, 1, 0]`")
    return None


@dataclass(frozen=True, slots=True)
class JointField(ByGrammar):
    """Form of `joint`: a word, a mapping (a `RecipeElement` without a name), or a list of mappings with names."""

    def schema(self) -> Schema:
        kind = computable({"enum": [*JointType], "description": GRAMMAR.element("joint").attributes["type"].doc})
        one = {**reference("element:joint"), "properties": {"type": kind}}
        several = {"type": "array", "minItems": 1, "items": {**one, "required": ["name"]}}
        return {"anyOf": [computable({"enum": [*WORDS]}), {"type": "object", **one}, several]}

    def read(
        self, value: Any, faults: list[Fault], settings: Settings
    ) -> str | RecipeElement | tuple[RecipeElement, ...] | None:
        reader = Reader(settings, faults)
        if isinstance(value, str) and value in WORDS:
            return value
        if isinstance(value, dict):
            element = _joint(reader, value, ())
            named = element is not None and "name" in element.attributes
            return (element,) if element is not None and named else element
        if isinstance(value, list):
            return _joints(reader, value)
        faults.append(_no_joint(value))
        return None


def _joints(reader: Reader, value: list[Any]) -> tuple[RecipeElement, ...]:
    if not value:
        reader.faults.append(Fault("wrong-length", "`joint` is an empty list", help="leave `joint` out"))
    elements: list[RecipeElement] = []
    names: dict[object, Path] = {}
    for index, item in enumerate(value):
        element = _joint(reader, item, (index,))
        if isinstance(item, dict) and "name" not in item:
            fault = missing_key("a joint in a list", "name", at=(index,))
            help = "write `name: …`; the joint is called PREFIX/NAME"
            reader.faults.append(Fault(fault.code, fault.message, (index,), help=help))
        elif element is not None:
            name = element.attributes.get("name")
            if name in names:
                related = (("the first one is here", names[name]),)
                message = f"two joints of one part are called `{name}`"
                help = "choose another name"
                reader.faults.append(Fault("name-clash", message, (index, "name"), related=related, help=help))
            names.setdefault(name, (index, "name"))
            elements.append(element)
    return tuple(elements)


def _joint(reader: Reader, value: Any, at: Path) -> RecipeElement | None:
    kind = GRAMMAR.element("joint")
    written = value.get("type", "hinge") if isinstance(value, dict) else None
    if written == "free":
        message = "a free joint has no attributes and stands alone"
        reader.faults.append(Fault("wrong-keyword", message, (*at, "type"), help="write `joint: free`"))
        return None
    # A joint between a place and a part only has the class that it names, which may set another type.
    type = "hinge" if isinstance(value, Mapping) and "class" not in value else None
    element = reader.element(kind, value, at, label("joint", value), joint=type)
    if element is not None and element.attributes.get("name", "joint") == "":
        message = "the name of a joint is empty"
        reader.faults.append(Fault("bad-name", message, (*at, "name"), help="leave `name` out, or write one"))
    return element


def _no_joint(value: Any) -> Fault:
    help = "write one of `none`, `free`, `ball`, `mocap`, or `{type: hinge, axis: [0, 0, 1]}`"
    if not isinstance(value, str):
        return Fault("wrong-type", f"`joint` expects a word, a mapping or a list, got {kind_of(value)}", help=help)
    near = closest(value, WORDS)
    fix = None
    if value in JointType:
        help = f"write `joint: {{type: {value}, axis: [0, 0, 1]}}`"
    elif near:
        help = f"write `joint: {near[0]}`"
        fix = renaming(value, WORDS)
    note = exists_note("word", WORDS, value)
    return Fault("wrong-keyword", f"`joint` cannot be `{value}`", notes=(note,), help=help, fix=fix)

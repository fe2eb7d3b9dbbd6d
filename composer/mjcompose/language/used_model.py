"""Changes of a model that a recipe uses: `drop`, `edit`, `with`, `urdf`, `allow`."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, PrivateAttr

from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.extensions import check_rows
from mjcompose.base.suggest import advised
from mjcompose.language.forms.context import ByGrammar, Schema, Settings, definition, reference
from mjcompose.language.forms.model import IT, Model, Rest
from mjcompose.language.forms.scalars import Checked, Count, Expects, Items, Keywords, Text, Written
from mjcompose.language.select import GLOB, NARROWING, read_selector
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import EVERYTHING, Selector, known_tags, paths_of


class UrdfKeys(Model):
    """How to read elements that MuJoCo ignores. Omitted keys keep the behavior of the file or of MuJoCo."""

    visuals: Literal["keep", "drop"] | None = None
    """`keep` makes geoms of the visuals, which touch nothing, and puts collision geoms into group 3, which viewers
    hide. By default `discardvisual` of the file decides."""
    fixed: Literal["keep", "fuse"] | None = None
    """`keep` makes bodies of fixed links, `fuse` frames of the link above. By default `fusestatic` of the file
    decides."""
    actuators: Literal["declared", "all", "none"] = "declared"
    """The joints that get an actuator: joints that `<ros2_control>` and `<transmission>` command, every joint that can
    move by itself, or none."""
    inertia: Annotated[Literal["repair", "keep"], Keywords({"mend": "repair"})] | None = None
    """`repair` changes impossible inertias, which MuJoCo refuses, as little as possible. Each is a warning."""


Given = Annotated[dict[str, Written], Expects("a mapping from names to values", "{reach: 0.5}")]
"""The values of `with`. The nested recipe checks them."""

# Without these, nothing else in a model can be read.
_KEPT = ("worldbody", "compiler")


_COUNT = ("expect", "optional")


def _word_fault(word: str) -> Fault | None:
    if word in _KEPT:
        message = f"`{word}` cannot be left out of a model"
        return Fault("not-supported", message, help="name what in it is to be left out")
    if word in GRAMMAR.root.children or paths_of(word):
        return None
    help, fix = advised(word, known_tags())
    notes = () if help else (Note("a section (`contact`), a tag (`light`) or a selector (`{geom: visual_*}`)"),)
    message = f"MJCF has no section and no element `{word}`"
    return Fault("unknown-element", message, notes=notes, help=help, fix=fix)


class _Selected(ByGrammar):
    def schema(self) -> Schema:
        return selector("")

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Selector | None:
        return read_selector(value, (), IT, faults=faults, beside=_COUNT)


class Drop(Model):
    """What to remove from a part: a selector, or the word for a section or for all elements with a tag."""

    short: ClassVar = "<word>"
    example: ClassVar = '{geom: "visual_*"}'

    word: Annotated[Text, Checked(_word_fault)] | None = Field(None, alias="<word>")
    selected: Annotated[Selector | None, _Selected(), Rest()] = Field(None, alias="<select>")
    expect: Count | None = None
    """how many elements must be selected"""
    optional: bool = False
    """allows an empty selection"""
    _index: int = PrivateAttr(0)

    @property
    def index(self) -> int:
        """Its place in the list."""
        return self._index

    @property
    def section(self) -> str | None:
        """The whole section that it removes, or None."""
        return self.word if self.word in GRAMMAR.root.children else None

    @property
    def select(self) -> Selector | None:
        """The elements that it removes; None for a section."""
        return self.selected if self.word is None or self.section else Selector(self.word, EVERYTHING)

    def __str__(self) -> str:
        return self.word or str(self.select)

    @property
    def leaves_keys(self) -> bool:
        """Whether it leaves out all keys. Keyframes of the recipe may read them nevertheless."""
        return self.expect is None and (self.section == "keyframe" or self.select in _ALL_KEYS)


_ALL_KEYS = (Selector("key", EVERYTHING), Selector("keyframe/key", EVERYTHING))


def _numbered(entries: tuple[Drop, ...]) -> tuple[Drop, ...]:
    for index, each in enumerate(entries):
        each._index = index
    return entries


Drops = Annotated[
    tuple[Drop, ...], Items(), AfterValidator(_numbered), Expects("a list", '[light, contact, {geom: "visual_*"}]')
]

_NARROWING: dict[str, Schema] = {
    "parent": {**reference("selector"), "description": "the body, or other element, that contains it"},
    "in": {**reference("selector"), "description": "an element that contains it, at any depth"},
    "part": {**GLOB, "description": "the part that it came from"},
    "class": {**GLOB, "description": "the default class in effect, or one that it descends from"},
    "where": {
        "type": ["object", "string"],
        "minProperties": 1,
        "additionalProperties": {"type": ["number", "boolean", "string", "array"]},
        "description": "attributes and their values in effect, or one boolean `${…}`",
    },
}
check_rows("the JSON Schema of selectors in composer/mjcompose/language/used_model.py", _NARROWING, NARROWING)


@definition("selector")
def selector(_: str) -> Schema:
    """Return the schema of a mapping from a tag to a glob, with the keys that narrow it down."""
    return {
        "type": "object",
        "properties": dict(_NARROWING),
        "propertyNames": {"enum": [*NARROWING, *known_tags(), *_paths()]},
        "additionalProperties": GLOB,
        "minProperties": 1,
        "if": {"propertyNames": {"enum": [*NARROWING, *_COUNT]}},
        "then": {"required": ["body"], "errorMessage": "write a tag, such as `body: NAME`"},
    }


def _paths() -> list[str]:
    known = set(known_tags())
    return [path for path in GRAMMAR.paths if "/" in path and path not in known and path != "mujoco/include"]

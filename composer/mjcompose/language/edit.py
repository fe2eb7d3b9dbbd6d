"""Changes of a model: the section `edit`, by verbs, and `drop`, `with` and `urdf` of a model that a recipe uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, PrivateAttr

from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.extensions import ExtensionTable, check_rows
from mjcompose.base.suggest import advised, closest
from mjcompose.base.words import value_text
from mjcompose.language.assign import TAGS, Changed
from mjcompose.language.forms.context import ByGrammar, Rows, Schema, Settings, definition, first_line, reference
from mjcompose.language.forms.model import IT, Model, Rest
from mjcompose.language.forms.scalars import Checked, Codes, Count, Expects, Hints, Items, Selects, Text, Turns, When
from mjcompose.language.forms.source_text import text_of
from mjcompose.language.select import GLOB, NARROWED, NARROWING, kinds_of, read_selector
from mjcompose.language.value import exclusive
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import EVERYTHING, Selector, known_tags, paths_of


class For:
    """The elements that a verb is for, by path or beginning of a path; `what` describes them, with `{tag}`."""

    alone = True

    def __init__(self, *paths: str, what: str, help: str | None = None) -> None:
        self.paths = paths
        self.what = what
        self.help = help

    def fits(self, path: str) -> bool:
        return any(path == each or (each.endswith("/") and path.startswith(each)) for each in self.paths)

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        kinds = kinds_of(context.selected.tag) if context.selected is not None else ()
        if kinds and context.selected is not None and not any(self.fits(kind.path) for kind in kinds):
            yield Fault("wrong-type", f"{IT} is {self.what.format(tag=context.selected.tag)}", help=self.help)

    def schema(self) -> Iterator[Schema]:
        yield from ()  # `_ByTag` says it of the whole entry


class Verb(Model):
    """The form of a change that an entry of `edit` makes to each selected element. `compose/verbs` has the effect.

    A verb that `reshapes` makes, removes or moves elements, after which a part cannot be compared with its source. A
    verb that is `alone` cannot be combined with other verbs. `values` is the kind of definition of its values in the
    JSON Schema, by the selector's tag.
    """

    reshapes: ClassVar[bool] = False
    alone: ClassVar[bool] = False
    values: ClassVar[str | None] = None

    def words(self) -> str:
        """Return the change as a plan says it."""
        raise NotImplementedError

    def changes(self, tag: str | None) -> Changed:
        """Return the attributes that change, with the tags of their elements; the selector has this tag."""
        return ()


def listed(values: Mapping[str, Any]) -> str:
    """Return the values that are written, as the end of a line.

    >>> listed({"gear": [2], "group": None}), listed({})
    (' with gear = [2]', '')
    """
    given = [f"{name} = {value_text(each)}" for name, each in values.items() if each is not None]
    return f" with {', '.join(given)}" if given else ""


def with_settings(method: str, settings: Any) -> str:
    """Return the method and its settings as in plans and manifests.

    >>> with_settings("decompose", {"parts": 8, "threshold": 0.05, "vertices": None, "seed": 1})
    'decompose (parts 8, threshold 0.05, seed 1)'
    """
    if isinstance(settings, str):
        return f"{method} {settings}"
    written = [f"{name} {value_text(value)}" for name, value in settings.items() if value is not None]
    return f"{method} ({', '.join(written)})" if written else method


_OWN = (
    "set",
    "scale",
    "simplify",
    "collision",
    "inertia",
    "convert",
    "datasheet",
    "calibrate",
    "move",
    "rename",
    "remove",
)
VERBS: ExtensionTable[type[Verb]] = ExtensionTable(
    "verbs",
    {},
    "VERB",
    kind=Verb,
    modules={word: f"mjcompose.language.verbs.{word}" for word in _OWN},
    effects=("carry_out",),
)
"""All verbs, in the order in which an entry carries them out and `fmt` writes them: the form of each value.

One of ours is imported when a recipe writes it, like one of another package. `mjcompose.homes` has the effects.
"""


class _DoesSomething:
    """An entry has a verb; some verbs allow no other in the same entry."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        verbs = [name for name in VERBS if name in value]
        known = model.key_names()
        select = value.get("select")
        misplaced = isinstance(select, dict) and any(key in VERBS for key in select)  # which is said there
        misspelt = any(key in model.instead or closest(key, VERBS) for key in value if key not in known)
        if not verbs and not misplaced and not misspelt:
            help = f"write one of {', '.join(f'`{name}`' for name in VERBS)}"
            yield Fault("missing-key", f"{IT} says nothing to be done", help=help)
        alone = next((name for name in verbs if VERBS[name].alone), None)
        if alone is not None and len(verbs) > 1:
            other = next(name for name in verbs if name != alone)
            message = f"`{alone}` excludes other keys, and there is `{other}` as well"
            yield exclusive(message, (other, alone), help=f"leave `{alone}` or `{other}` out")

    def schema(self) -> Iterator[Schema]:
        for verb in VERBS.own:
            if VERBS[verb].alone:
                others: Schema = {**dict.fromkeys((name for name in VERBS.own if name != verb), False)}
                then = {"properties": others, "errorMessage": f"`{verb}` stands alone"}
                yield {"if": {"required": [verb]}, "then": then}
        none: Schema = {**dict.fromkeys(VERBS.own, False)}
        message = f"write one of {', '.join(VERBS.own)}"
        yield {"if": {"properties": none}, "then": {"required": ["set"], "errorMessage": message}}


class _ByTag:
    """The verbs and the attributes that they may name, by the tag of the selector. The verbs read it."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        yield from ()

    def schema(self) -> Iterator[Schema]:
        forms = {name: VERBS[name] for name in VERBS.own}
        for tag in TAGS:
            values = {name: reference(f"{form.values}:{tag}") for name, form in forms.items() if form.values}
            refused: dict[str, Schema] = {
                name: {"not": {}, "errorMessage": f"it is {rule.what.format(tag=tag)}"}
                for name, form in forms.items()
                for rule in form.rules
                if isinstance(rule, For) and not any(rule.fits(kind.path) for kind in kinds_of(tag))
            }
            yield _where_selected(tag, {**values, **refused}, forms)
        values = {name: reference(f"of-{form.values}") for name, form in forms.items() if form.values}
        yield _where_selected("default", values, forms)


def _where_selected(tag: str, values: Mapping[str, Schema], forms: Mapping[str, Any]) -> Schema:
    selected: Schema = {"properties": {"select": {"required": [tag]}}, "required": ["select"]}
    verbs = {name: {**each, "description": first_line(text_of(forms[name]))} for name, each in values.items()}
    return {"if": selected, "then": {"properties": verbs}}


class Edit(Model):
    """One entry of `edit`: a selector, and the changes to its elements."""

    rules: ClassVar = (_DoesSomething(), _ByTag())
    example: ClassVar = "{select: {TAG: NAME}, set: {ATTRIBUTE: VALUE}}"
    instead: ClassVar = {
        **NARROWED,
        "unset": "write `set: {ATTRIBUTE: null}`",
        "offset": 'write `set: {ATTRIBUTE: "${value + 0.1}"}`',
        "motor": "datasheet",
    }

    id: Text | None = None
    """a name for the entry, so a recipe that extends this one can replace it"""
    select: Annotated[Selector, Selects()] = Field(examples=["{TAG: NAME}"])
    """the selected elements"""
    expect: Count | None = None
    """how many elements must be selected"""
    optional: bool = False
    """allows an empty selection"""
    verbs: Annotated[Mapping[str, Verb], Rows(lambda: VERBS, selects="select")] = Field({}, alias="<verbs>")
    """the changes, in the order in which they are carried out"""
    allow: Codes = ()
    """the codes of warnings about this entry that you accept"""
    repeats: Turns = Field(None, alias="for")
    when: When = None

    @classmethod
    def listed(cls) -> list[str]:
        # Messages list the first few: keys that do something come first.
        return ["select", *VERBS.own, "expect", "optional", "id", "allow", "for", "when"]

    @property
    def words(self) -> str:
        return f"edit {self.select}: {'; '.join(each.words() for each in self.verbs.values())}"


Edits = Annotated[tuple[Edit, ...], Items(), Expects("a list of entries")]


class UrdfKeys(Model):
    """How to read elements that MuJoCo ignores. Omitted keys keep the behavior of the file or of MuJoCo."""

    visuals: Literal["keep", "drop"] | None = None
    """`keep` turns visuals into geoms that touch nothing, and puts collision geoms into group 3, which viewers hide. By
    default `discardvisual` of the file decides."""
    fixed: Literal["keep", "fuse"] | None = None
    """`keep` turns fixed links into bodies, `fuse` into frames of the link above. By default `fusestatic` of the file
    decides."""
    actuators: Literal["declared", "all", "none"] = "declared"
    """The joints that get an actuator: joints that `<ros2_control>` and `<transmission>` command, every joint that can
    move by itself, or none."""
    inertia: Annotated[Literal["repair", "keep"], Hints({"mend": "repair"})] | None = None
    """`repair` changes impossible inertias, which MuJoCo refuses, as little as possible. Each is a warning."""


Given = Annotated[dict[str, Any], Expects("a mapping from names to values", "{reach: 0.5}")]
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
    """The elements to remove from a part: a selector, a section, or a tag for all elements with it."""

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
        return self._index

    @property
    def section(self) -> str | None:
        return self.word if self.word in GRAMMAR.root.children else None

    @property
    def select(self) -> Selector | None:
        return self.selected if self.word is None or self.section else Selector(self.word, EVERYTHING)

    def __str__(self) -> str:
        return self.word or str(self.select)

    @property
    def leaves_keys(self) -> bool:
        """Whether it drops all keys. Keyframes of the recipe may read them nevertheless."""
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
check_rows("the JSON Schema of selectors in composer/mjcompose/language/edit.py", _NARROWING, NARROWING)


@definition("selector")
def selector(_: str) -> Schema:
    """Return the schema of a mapping from a tag to a glob, with the keys that narrow it down."""
    known = {*known_tags(), "mujoco/include"}
    paths = [path for path in GRAMMAR.paths if "/" in path and path not in known]
    return {
        "type": "object",
        "properties": dict(_NARROWING),
        "propertyNames": {"enum": [*NARROWING, *known_tags(), *paths]},
        "additionalProperties": GLOB,
        "minProperties": 1,
        "if": {"propertyNames": {"enum": [*NARROWING, *_COUNT]}},
        "then": {"required": ["body"], "errorMessage": "write a tag, such as `body: NAME`"},
    }

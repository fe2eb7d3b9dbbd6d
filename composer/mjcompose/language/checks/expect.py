"""The form of the check `expect`: the number of elements in the compiled model, and their values."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache, cached_property
from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic_core import PydanticKnownError

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.base.words import value_text, with_article
from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.context import Rows, Schema, Settings, reference
from mjcompose.language.forms.model import IT, OWNER, Belongs, Exclusive, OneOf
from mjcompose.language.forms.scalars import Checked, Count, Expects, Items, Measure, Name, Text, in_order
from mjcompose.language.select import pattern_fault
from mjcompose.language.value import kind_of
from mjcompose.mujoco.attributes import ENUMERATED, HOLDERS, TAGS as WITH_NUMBERS, attributes
from mjcompose.text.expression import Angle
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import paths_of

Number = tuple[float, str | None]
"""A number and the unit that is written after it, `deg` or `rad`."""
SUBTREE_MASS = "subtree_mass"
"""An attribute of bodies that MJCF does not have: the mass of a body and all below it."""

_NAMING = (
    "geom",
    "site",
    "camera",
    "light",
    "skin",
    "material",
    "pair",
    "exclude",
    "equality",
    "tendon",
    "actuator",
    "sensor",
)
_NOT_COMPILED = ("default", "instance")


@cache
def keywords(tag: str) -> Mapping[str, tuple[str, ...]]:
    """Return the keywords of a tag's attributes. The keywords of a family's `type` are its tags."""
    paths = paths_of(tag)
    found: dict[str, tuple[str, ...]] = {}
    for name in sorted(ENUMERATED.get(tag, ())):
        attributes = [GRAMMAR.element(path).attributes.get(name) for path in paths]
        words = {word for each in attributes if each is not None for word in each.keywords}
        found[name] = tuple(sorted(words or {GRAMMAR.element(path).tag for path in paths}))
    return found


@cache
def naming(tag: str) -> Mapping[str, str | None]:
    """Return the attributes of a tag that name another element, with its kind; None if another attribute gives it."""
    if tag not in _NAMING:
        return {}
    return {
        name: attribute.refers
        for path in sorted(paths_of(tag))
        for name, attribute in GRAMMAR.element(path).attributes.items()
        if (attribute.is_reference or attribute.refers_by) and attribute.refers not in _NOT_COMPILED
    }


TAGS = (
    "body",
    "joint",
    "geom",
    "site",
    "camera",
    "light",
    "flex",
    "skin",
    "mesh",
    "hfield",
    "texture",
    "material",
    "pair",
    "exclude",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "numeric",
    "text",
    "tuple",
    "plugin",
    "key",
)
"""Elements that have names in a compiled model; a family stands for all of its tags."""
MASS = "mass"
COUNTS: Mapping[str, str] = {
    "nq": "entries of `qpos`",
    "nv": "degrees of freedom",
    "nu": "controls",
    "na": "activation states",
    "nbody": "bodies, the world included",
    "njnt": "joints",
    "ngeom": "geoms",
    "nsite": "sites",
    "ncam": "cameras",
    "nlight": "lights",
    "nflex": "flexes",
    "nskin": "skins",
    "nmesh": "meshes",
    "nhfield": "height fields",
    "ntex": "textures",
    "nmat": "materials",
    "npair": "contact pairs",
    "nexclude": "contact excludes",
    "neq": "equality constraints",
    "ntendon": "tendons",
    "nactuator": "actuators",
    "nsensor": "sensors",
    "nsensordata": "entries of `sensordata`",
    "nnumeric": "custom numbers",
    "ntext": "custom texts",
    "ntuple": "custom tuples",
    "nplugin": "plugin instances",
    "nmocap": "mocap bodies",
    "nkey": "keyframes",
}
"""The sizes of mjModel that a check can name, and the elements that they count."""
OF_THE_MODEL = (MASS, *COUNTS)
WHERE = "where"
_INDEXED = re.compile(r"([A-Za-z]\w*)(?:\[(\d{1,3})\])?")
_GLOBS = {tag: Annotated[str, Name(tag, glob=True), Field(description=f"a glob over names: {tag}")] for tag in TAGS}
_BY_TAG: ExtensionTable[Any] = ExtensionTable("tags", _GLOBS, "")


class Figure(Measure):
    """A number, an angle, or a boolean."""

    def read(self, value: Any) -> float | Angle:
        return value if isinstance(value, bool) else super().read(value)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> Schema:
        return {"anyOf": [reference("number"), {"type": "boolean"}]}


_EXPECTED = Expects("a number, an angle, a boolean, or a list of these", "0.5")
_FIGURES = Annotated[tuple[Annotated[float | Angle, Figure()], ...], Items(1, single=True), _EXPECTED]


def with_unit(value: float | Angle) -> Number:
    return (value.value, value.unit) if isinstance(value, Angle) else (value, None)


class ExpectedValue(Struct):
    """A key of `where`: a `word`, which may be a glob over names, or the numbers of an attribute."""

    key: str
    attr: str = ""
    subscript: int | None = None
    word: str | None = None
    numbers: tuple[Number, ...] = ()


class Around(CheckPart):
    """A body around the elements."""

    example: ClassVar = '{body: "**/pad"}'

    body: Annotated[str, Name("body", glob=True)] = Field(examples=['"**/pad"'])
    """a glob over names of bodies"""


_CONDITIONS = Expects("a mapping from attributes to values", '{"size[0]": 0.1}')
_BESIDE = "write `{0}` beside `select`, behind the `}}` of the selector: `{0}: …`"


class ElementSelector(CheckPart):
    """A tag with a name or a glob, and conditions."""

    rules: ClassVar = (OneOf(*TAGS, lacks="lacks a tag", advice="write for instance `site: NAME`", noun="tag"),)
    example: ClassVar = "{site: tcp}"
    noun: ClassVar = "key"
    instead: ClassVar = {
        **{key: _BESIDE.format(key) for key in ("count", "attr", "equals", "tol", "range")},
        "expect": _BESIDE.format("count"),
        "part": "write the prefix of the part in the name: `arm/**`",
        "class": "a compiled model has no classes: write `where: {ATTRIBUTE: VALUE}`",
    }

    tags: Annotated[Mapping[str, Any], Rows(lambda: _BY_TAG)] = Field({}, alias="<tags>")
    parent: Around | None = None
    """only elements directly inside a body with this name"""
    inside: Around | None = Field(None, alias="in")
    """only elements at any depth inside a body with this name"""
    where: Annotated[dict[str, Any], Field(min_length=1), _CONDITIONS] | None = None
    """only elements with these values in the compiled model: `type: mesh`, `joint: elbow`"""

    @property
    def tag(self) -> str:
        return next(iter(self.tags))

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        tag = self.tag
        for key, around in (("parent", self.parent), ("in", self.inside)):
            if around is not None and tag not in HOLDERS:
                message = f"{IT} cannot say `{key}` of a {tag}, which is in no body"
                yield Fault("unknown-key", message, (key,), key=True, help=f"remove `{key}`")
        if self.where is None:
            return
        if tag not in (*WITH_NUMBERS, *ENUMERATED) and not naming(tag):
            message = f"{IT} cannot say `{WHERE}`: a compiled model has no attributes of a {tag}"
            yield Fault("unknown-key", message, (WHERE,), key=True, help=f"remove `{WHERE}`")
            return
        for key, value in self.where.items():
            condition = _condition(tag, key, value)
            if isinstance(condition, Fault):
                yield replace(condition, at=(WHERE, key, *condition.at))

    @property
    def glob(self) -> str:
        return str(self.tags[self.tag])

    @cached_property
    def conditions(self) -> list[ExpectedValue]:
        """The conditions of `where`, attribute by attribute."""
        read = [_condition(self.tag, key, value) for key, value in (self.where or {}).items()]
        return [condition for condition in read if isinstance(condition, ExpectedValue)]


_OF_WHAT = "write for instance `select: {joint: NAME}`, or `attr: mass`"
_COUNT = Expects("a count, or the minimum and the maximum", "[6, 8]")
_RANGE = Expects("a list of 2 numbers", "[18, 22]")
_Bound = Annotated[float | Angle, Measure()]


class Expect(Check):
    """The compiled model has this number of elements, with these values."""

    word: ClassVar = "expect"
    example: ClassVar = "{select: {site: NAME}, count: 1}"
    rules: ClassVar = (
        OneOf("select", lacks="does not say of what", advice=_OF_WHAT, unless="attr"),
        Exclusive("equals", "range"),
        Belongs("count", "select", help="write `select: {TAG: NAME}` next to it"),
        Belongs("equals", "attr", help="write `attr: NAME` next to it"),
        Belongs("range", "attr", help="write `attr: NAME` next to it"),
        Belongs("tol", "equals", help="remove `tol`, or write `equals: VALUE`"),
    )
    instead: ClassVar = {"value": "equals", "expect": "count"}

    select: ElementSelector | None = None
    """the elements; if omitted, `attr` is a number of the whole model"""
    count: Annotated[tuple[Count, ...], Items(1, 2, single=True), Checked(in_order), _COUNT] | None = None
    """the number of elements, or `[LOW, HIGH]`; by default at least one"""
    attr: Annotated[Text, Expects("an attribute of MJCF", "damping")] | None = None
    """an MJCF attribute, or one of its numbers: `range[1]`. Bodies also have `subtree_mass`. Without `select`: `mass`,
    or a size of mjModel such as `nu`"""
    equals: _FIGURES | None = None
    """the expected value: a number, an angle, a boolean, or a list"""
    tol: Annotated[float | Angle, Measure(ge=0)] | None = None
    """the allowed difference of each number; by default only rounding"""
    range: Annotated[tuple[_Bound, ...], Items(2, 2), Checked(in_order), _RANGE] | None = None
    """the smallest and largest allowed value of each number"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if self.attr is None:
            return
        tag = None if self.select is None else self.select.tag
        attr = _attribute(tag, self.attr)
        if isinstance(attr, Fault):
            yield replace(attr, at=("attr",))
        elif self.equals is None and self.range is None:
            message = f"`attr` of {OWNER} has no expected value"
            help = "write `equals: VALUE`, or `range: [LOW, HIGH]`"
            yield Fault("missing-key", message, ("attr",), key=True, help=help)
        elif self.equals is not None and len(self.equals) > 1 and (tag is None or attr[1] is not None):
            note = None if tag is None else "without an index, the attribute means all of its numbers"
            yield Fault("wrong-type", f"`equals` of {OWNER} expects one number, got a list", ("equals",), help=note)

    @cached_property
    def attribute(self) -> tuple[str, int | None] | None:
        """The attribute and the subscript of the number that it selects; None if only elements are counted."""
        if self.attr is None:
            return None
        attribute = _attribute(None if self.select is None else self.select.tag, self.attr)
        assert not isinstance(attribute, Fault)
        return attribute

    @property
    def counts(self) -> tuple[int, int] | None:
        """The least and the greatest count, if one is written."""
        return None if self.count is None else (self.count[0], self.count[-1])

    @property
    def numbers(self) -> list[Number]:
        """The numbers of `equals`, or else the two of `range`."""
        return [with_unit(each) for each in (self.equals or self.range or ())]


def _selectable(tag: str) -> list[str]:
    """Return the attributes of a tag that have numbers in a compiled model."""
    more = [SUBTREE_MASS] if tag == "body" else []
    return [*attributes(tag), *more] if tag in WITH_NUMBERS else more


def _attribute(tag: str | None, written: str, others: Collection[str] = ()) -> tuple[str, int | None] | Fault:
    """Return an attribute and its index, or its fault. `others` are attributes without numbers."""
    if (match := _INDEXED.fullmatch(written)) is None:
        message = f"{IT} is `{written}`, which is not an attribute"
        return Fault("wrong-type", message, help='write for instance `damping`, or `"range[1]"`')
    name, index = match.groups()
    known = [*(OF_THE_MODEL if tag is None else _selectable(tag)), *others]
    if name in known and name not in others and not (tag is None and index):
        return name, None if index is None else int(index)
    help, fix = advised(name, known)
    message = f"`{name}` of a {tag} is not an attribute that {OWNER} can read"
    if tag is None:
        message = f"`{written}` is not a number of the model that {OWNER} can read"
        owners = [each for each in WITH_NUMBERS if name in _selectable(each)]
        if owners and not closest(name, known):
            help = f"write `select: {{{owners[0]}: NAME}}` next to it, for the elements that have it"
            fix = None
    note = exists_note("number" if tag is None else "attribute", known, name)
    return Fault("unknown-attribute", message, notes=(note,), help=help, fix=fix)


def _condition(tag: str, key: str, value: Any) -> ExpectedValue | Fault:
    """Return a condition on an attribute of the compiled model, or its fault."""
    words = [*keywords(tag), *naming(tag)]
    if key in words:
        word = _word(tag, key, value)
        return word if isinstance(word, Fault) else ExpectedValue(key, word=word)
    attr = _attribute(tag, key, words)
    if isinstance(attr, Fault):
        return attr
    numbers: list[Number] = []
    items = value if isinstance(value, list) else [value]
    for each in items:
        try:
            numbers.append(with_unit(Figure().read(each)))
        except PydanticKnownError:
            return Fault("wrong-type", f"`{key}` of {OWNER} expects a number, got {kind_of(each)}")
    if not numbers or (attr[1] is not None and isinstance(value, list)):
        got = "a list" if numbers else "an empty list"
        return Fault("wrong-type", f"`{key}` of {OWNER} expects a number, got {got}")
    return ExpectedValue(key, attr[0], attr[1], numbers=tuple(numbers))


def _word(tag: str, attr: str, value: Any) -> str | Fault:
    """Return the value that an attribute must have: one of its keywords, or a glob over names."""
    if attr not in keywords(tag):
        if not isinstance(value, str) or not value:
            return Fault("wrong-type", f"`{attr}` of {OWNER} expects a name or a glob, got {kind_of(value)}")
        return pattern_fault(value, OWNER, ()) or value
    word = str(value)
    known = keywords(tag)[attr]
    if word in known:
        return word
    help, fix = advised(word, known)
    note = exists_note("value", known, word)
    message = f"`{attr}` of {with_article(tag)} is never `{value_text(value)}`"
    return Fault("wrong-keyword", message, notes=(note,), help=help, fix=fix)


KIND = Expect

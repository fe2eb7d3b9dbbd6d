"""The check `expect`: the number of elements in the compiled model, and their values."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic_core import PydanticKnownError

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.report import with_rest
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.base.words import value_text, with_article
from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.context import Rows, Schema, Settings, reference
from mjcompose.language.forms.model import IT, OWNER, Belongs, Exclusive, OneOf
from mjcompose.language.forms.scalars import Checked, Count, Expects, Items, Measure, Name, Text, in_order
from mjcompose.language.select import pattern_fault
from mjcompose.language.value import kind_of
from mjcompose.mujoco.attributes import ENUMERATED, HOLDERS, KINDS, TAGS as WITH_NUMBERS, attributes, holder
from mjcompose.text.expression import Angle
from mjcompose.verify.checks.check import (
    ROUNDING,
    SUBTREE_MASS,
    CheckEnds,
    Number,
    Scope,
    equal,
    failed,
    keywords,
    like,
    naming,
    plain,
    quantities_of,
    quantity,
    unit_of,
    unknown,
    values_of,
    words_of,
)

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


def _with_unit(value: float | Angle) -> Number:
    return (value.value, value.unit) if isinstance(value, Angle) else (value, None)


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

    def asked(self) -> dict[str, Any]:
        conditions = [_condition(self.tag, key, value) for key, value in (self.where or {}).items()]
        parent, inside = (None if each is None else each.body for each in (self.parent, self.inside))
        return {"tag": self.tag, "glob": self.tags[self.tag], "parent": parent, "inside": inside, WHERE: conditions}


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

    def asked(self) -> dict[str, Any]:
        tag = None if self.select is None else self.select.tag
        attr = (None, None) if self.attr is None else _attribute(tag, self.attr)
        assert not isinstance(attr, Fault)
        return {
            "select": None if self.select is None else self.select.asked(),
            "attr": attr[0],
            "index": attr[1],
            "count": None if self.count is None else (self.count[0], self.count[-1]),
            "equals": None if self.equals is None else [*map(_with_unit, self.equals)],
            "tol": None if self.tol is None else _with_unit(self.tol),
            "range": None if self.range is None else [*map(_with_unit, self.range)],
        }


KIND = Expect


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


def _condition(tag: str, key: str, value: Any) -> dict[str, Any] | Fault:
    """Return a condition on an attribute of the compiled model as plain data, or its fault."""
    words = [*keywords(tag), *naming(tag)]
    if key in words:
        word = _word(tag, key, value)
        return word if isinstance(word, Fault) else {"key": key, "word": word}
    attr = _attribute(tag, key, words)
    if isinstance(attr, Fault):
        return attr
    numbers: list[Number] = []
    for each in value if isinstance(value, list) else [value]:
        try:
            numbers.append(_with_unit(Figure().read(each)))
        except PydanticKnownError:
            return Fault("wrong-type", f"`{key}` of {OWNER} expects a number, got {kind_of(each)}")
    if not numbers or (attr[1] is not None and isinstance(value, list)):
        got = "a list" if numbers else "an empty list"
        return Fault("wrong-type", f"`{key}` of {OWNER} expects a number, got {got}")
    return {"key": key, "word": None, "attr": attr[0], "index": attr[1], "value": numbers}


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


_SHOWN = 8
_UNITS = {MASS: " kg", SUBTREE_MASS: " kg"}
_COUNTED = {kind.size: word for word, kind in KINDS.items() if word not in ("body", "key")}


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report another number of elements than expected, and elements with other values."""
    if (select := asked["select"]) is None:
        return _of_the_model(scope, asked)
    tag = select["tag"]
    glob = select["glob"]
    named = [0] if (tag, glob) == ("body", "world") else scope.matching(tag, glob)
    is_there = (index for index in named if _is_there(scope, index, select))
    elements = [index for index in is_there if _fits(scope, index, select, angle=asked["angle"])]
    scope.found(f"{tag} {glob}", len(elements))
    wrong = _miscounted(scope, asked, elements)
    return wrong + _differing(scope, asked, elements) if asked["attr"] else wrong


def _miscounted(scope: Scope, asked: dict[str, Any], elements: list[int]) -> list[Fault]:
    select = asked["select"]
    count = asked["count"]
    tag = select["tag"]
    glob = select["glob"]
    low, high = count or (1, math.inf)
    if low <= len(elements) <= high:
        return []
    expected = "at least one" if count is None else f"{low}" if low == high else f"{low} to {high}"
    seen = unknown(tag, glob, scope.names(tag), "select", tag)
    if elements:
        message = f"`{glob}` names {len(elements)} elements `{tag}`, not {expected}"
        names = ", ".join(scope.written(tag, each) for each in elements[:_SHOWN])
        more = [f"they are: {names}" + (", …" if len(elements) > _SHOWN else "")]
        return [failed(message, expected, str(len(elements)), "count", more=more)]
    if count is None and asked["attr"]:
        return [seen]
    more = [note.message for note in seen.notes]
    return [failed(f"{seen.message}{_there(select)}", expected, "0", *seen.at, more=more, help=seen.help)]


def _there(select: dict[str, Any]) -> str:
    words = (("parent", "right on"), ("inside", "in"))
    there = "".join(f" {word} a body `{select[key]}`" for key, word in words if select[key])
    keys = ", ".join(f"`{each['key']}`" for each in select["where"])
    return f"{there} with such {keys}" if keys else there


def _is_there(scope: Scope, index: int, select: dict[str, Any]) -> bool:
    """Return whether the bodies around an element are those that the selector names."""
    if not (select["parent"] or select["inside"]):
        return True
    around = [holder(scope.model, select["tag"], index)]
    while around[-1]:
        around.append(holder(scope.model, "body", around[-1]))
    asked = ((select["parent"], around[:1]), (select["inside"], around))
    return all(glob is None or set(bodies) & set(scope.matching("body", glob)) for glob, bodies in asked)


def _fits(scope: Scope, index: int, select: dict[str, Any], angle: str | None) -> bool:
    """Return whether an element has the values in `where`. Raises CheckEnds if they cannot be looked up."""
    tag = select["tag"]
    for each in select["where"]:
        if each["word"] is not None:
            if not scope.fitting(each["word"], set(words_of(scope, tag, index, attr=each["key"]))):
                return False
            continue
        try:
            actual = values_of(scope, tag, index, asked=each)
            written = {**each, "angle": angle}
            expected = quantities_of(scope, tag, index, asked=written, numbers=each["value"])
        except CheckEnds as end:
            if end.fault.code == "wrong-length":
                return False
            raise CheckEnds(replace(end.fault, at=("select", WHERE, each["key"]))) from None
        if len(expected) != actual.size or not equal(actual, expected, None):
            return False
    return True


def _differing(scope: Scope, asked: dict[str, Any], elements: list[int]) -> list[Fault]:
    tag = asked["select"]["tag"]
    wrong: list[tuple[str, str]] = []
    expected = ""
    key = "range" if asked["equals"] is None else "equals"
    for index in elements:
        try:
            actual = values_of(scope, tag, index, asked=asked)
            quantities = quantities_of(scope, tag, index, asked=asked, numbers=asked[key])
        except CheckEnds as end:
            return [replace(end.fault, at=end.fault.at or (key,))]
        scope.values[scope.written(tag, index)] = plain(actual)
        if key == "equals" and len(quantities) != actual.size:
            name = asked["select"]["glob"]
            message = f"`{asked['attr']}` of {tag} `{name}` has {actual.size} numbers, `equals` has {len(quantities)}"
            return [Fault("wrong-length", message, ("equals",))]
        unit = _UNITS.get(asked["attr"], "")
        have = _listed(like(quantities, actual.tolist())) + unit
        if key == "equals":
            number, written = asked["tol"] or (None, None)
            tol = None if number is None else quantity(number, written, unit_of(tag, asked["attr"]))
            holds = equal(actual, quantities, None if tol is None else tol.value)
            expected = _listed([str(each) for each in quantities]) + unit
            expected += "" if tol is None else f" ± {tol}{unit}"
        else:
            low, high = quantities
            holds = all(low.value <= each <= high.value for each in actual.tolist())
            expected = f"{low} to {high}{unit}"
        if not holds:
            wrong.append((scope.called(tag, index), have))
    if not wrong:
        return []
    name, have = wrong[0]
    attr = asked["attr"] + ("" if asked["index"] is None else f"[{asked['index']}]")
    _, *more = with_rest([f"{other}: {value}" for other, value in wrong], _SHOWN)
    return [failed(f"`{attr}` of {name} is {have}, not {expected}", expected, have, key, more=more)]


def _of_the_model(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report a number of the model that is not the expected one. Merged keyframes belong to no single recipe."""
    attr = asked["attr"]
    key = "range" if asked["equals"] is None else "equals"
    masses = (float(scope.model.body_mass[index]) for index in scope.own("body"))
    actual = sum(masses, 0.0) if attr == MASS else _size(scope, attr)
    if actual is None:
        return []
    scope.found(attr, actual)
    numbers = [number for number, _ in asked[key]]
    unit = _UNITS.get(attr, "")
    if key == "equals":
        (number,) = numbers if len(numbers) == 1 else (math.nan,)
        slack = ROUNDING[8] * max(1.0, abs(number)) if asked["tol"] is None else asked["tol"][0]
        low = number - slack
        high = number + slack
        expected = f"{number:.9g}{unit}" + ("" if asked["tol"] is None else f" ± {slack:g}{unit}")
    else:
        low, high = numbers
        expected = f"{low:.9g} to {high:.9g}{unit}"
    if low <= actual <= high:
        return []
    owner = "the model" if scope.whole else "this recipe's model"
    have = f"{actual:.9g}{unit}"
    return [failed(f"`{attr}` of {owner} is {have}, not {expected}", expected, have, key)]


def _size(scope: Scope, size: str) -> int | None:
    """Return a size of mjModel, counting the recipe's own elements; None if that is impossible."""
    from mjcompose.mujoco.addresses import VECTORS, span

    model = scope.model
    if scope.whole:
        value = getattr(model, size, None)
        return scope.roster.count("actuator") if value is None and size == "nactuator" else value
    if size in _COUNTED:
        return len(list(scope.own(_COUNTED[size])))
    if size == "nbody":
        return 1 + len(list(scope.own("body")))  # every model has the world
    for vector, (kind, summed) in VECTORS.items():
        if summed == size:
            return sum(len(span(model, vector, index)) for index in scope.own(kind))
    return None


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"[{', '.join(words)}]"

"""The check `expect`: how many elements the compiled model has, and their values."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.build.checks.check import Scope, failed, unknown, words_of
from mjcompose.language.checks import form
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, keywords, naming
from mjcompose.language.form import Schema, kind_of, reference, shown
from mjcompose.language.select import GLOB, NARROWING
from mjcompose.model.values import is_in_degrees
from mjcompose.mujoco.arrays import JOINT_TYPES
from mjcompose.mujoco.attributes import ANGLES, ENUMERATED, HOLDERS, KINDS, array_of, attributes, holder
from mjcompose.mujoco.attributes import TAGS as WITH_NUMBERS
from mjcompose.text.expression_values import Angle

TAGS = (
    "body", "joint", "geom", "site", "camera", "light", "flex", "skin", "mesh", "hfield", "texture", "material",
    "pair", "exclude", "equality", "tendon", "actuator", "sensor", "numeric", "text", "tuple", "plugin", "key",
)  # fmt: skip
"""What a compiled model has names for; families stand for all of their tags."""
MASS, SUBTREE_MASS = "mass", "subtree_mass"
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
"""The sizes of mjModel that can be asked for, and what they count."""
OF_THE_MODEL = (MASS, *COUNTS)
AROUND, WHERE = ("parent", "in"), "where"
_BESIDE = ("count", "attr", "equals", "tol", "range")
_INDEXED = re.compile(r"([A-Za-z]\w*)(?:\[(\d{1,3})\])?")

Number = tuple[float, str | None]
"""A number and the unit that is written behind it, `deg` or `rad`."""


@dataclass(frozen=True, slots=True)
class Where:
    """A condition on an attribute, or on one of its numbers. `key` is how the recipe writes it.

    `word` is the value of an attribute that is not a number. For a name, it may be a glob.
    """

    key: str
    attr: str
    index: int | None
    value: tuple[Number, ...] = ()
    word: str | None = None


@dataclass(frozen=True, slots=True)
class Selected:
    """Elements whose names match a glob.

    `parent` is a glob for the body that directly contains them, `inside` one for any body around them.
    """

    tag: str
    glob: str
    parent: str | None = None
    inside: str | None = None
    where: tuple[Where, ...] = ()


@dataclass(frozen=True, slots=True)
class Expect:
    """The elements that `select` matches are as many as `count` says, and their `attr` has a value.

    Without `select`, `attr` is a number of the model. The value is `equals` within `tol`, or between the two ends of
    `range`. With `index`, only that number counts. A number without a unit is in the unit of the compiled model.
    """

    word: ClassVar[str] = "expect"
    name: str
    select: Selected | None
    count: tuple[int, int] | None
    attr: str | None
    index: int | None
    equals: tuple[Number, ...] | None
    tol: Number | None
    range: tuple[Number, ...] | None
    at: Path


def _selectable(tag: str) -> list[str]:
    """Return the attributes of a tag that have numbers in a compiled model."""
    more = [SUBTREE_MASS] if tag == "body" else []
    return [*attributes(tag), *more] if tag in WITH_NUMBERS else more


def _attribute(
    keys: Keys, tag: str | None, written: str, *at: str | int, others: Collection[str] = ()
) -> tuple[str | None, int | None]:
    """Return the attribute that is written at a place, and its index, each None if there is none.

    An attribute that no model has is reported. `others` are attributes without numbers, which the message offers too.
    """
    match = _INDEXED.fullmatch(written)
    if match is None:
        message = f"`{at[-1]}` of {keys.owner} is `{written}`, which is not an attribute"
        keys.add("wrong-type", message, *at, help='write for instance `damping`, or `"range[1]"`')
        return None, None
    name, index = match.groups()
    known = [*(OF_THE_MODEL if tag is None else _selectable(tag)), *others]
    if name in known and name not in others and not (tag is None and index):
        return name, None if index is None else int(index)
    help, fix = advised(name, known)
    note = exists_note("number of the model" if tag is None else "attribute", known, name)
    message = f"`{name}` of a {tag} is nothing that {keys.owner} could ask for"
    if tag is None:
        message = f"`{written}` is not a number of the model that {keys.owner} could ask for"
        owners = [each for each in WITH_NUMBERS if name in _selectable(each)]
        if owners and not closest(name, known):
            help, fix = (
                f"write `select: {{{owners[0]}: NAME}}` beside it, for the elements that have it",
                None,
            )
        note = exists_note("number", known, name)
    keys.add("unknown-attribute", message, *at, notes=(note,), help=help, fix=fix)
    return None, None


def _numbers(keys: Keys, value: Any, *at: str | int) -> tuple[Number, ...] | None:
    """Return the numbers that are written at a place, or None after a reported fault."""
    if not isinstance(value, list):
        number = _number(keys, value, *at)
        return None if number is None else (number,)
    if not value:
        keys.add("wrong-length", f"`{at[-1]}` of {keys.owner} is an empty list", *at)
        return None
    found = [_number(keys, each, *at, place) for place, each in enumerate(value)]
    return None if None in found else tuple(each for each in found if each is not None)


def _number(keys: Keys, value: Any, *at: str | int) -> Number | None:
    if isinstance(value, bool):
        return value, None
    angle = Angle.read(value) if isinstance(value, str) else None
    if angle is not None:
        return angle.value, angle.unit
    number = keys.number_of(value, *at)
    return None if number is None else (number, None)


def _check_one(keys: Keys, value: Any, index: int | None, *at: str | int) -> None:
    """Report a list if the attribute has an index, which means one number."""
    if index is not None and isinstance(value, list) and value:
        message = f"`{at[-1]}` of {keys.owner} expects one number, got a list"
        help = "without an index, the attribute means all of its numbers"
        keys.add("wrong-type", message, *at, help=help)


_ANGLE = r"^[-+.0-9eE]+(?:deg|rad)$|\$\{"


class Values:
    """Form of a number, an angle, a boolean, or a list of these, read as a tuple of numbers with their units."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[Number, ...] | None:
        return _numbers(keys, value, *at)

    def schema(self) -> Schema:
        return {
            "type": ["number", "boolean", "string", "array"],
            "items": {"anyOf": [reference("number"), {"type": "boolean"}]},
            "minItems": 1,
            "pattern": _ANGLE,
            "patternErrorMessage": "expected a number, an angle such as 90deg, a boolean, a list of these, or ${…}",
        }


class Ends:
    """Form of the least and the most value: two numbers or angles."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[Number, ...] | None:
        if not isinstance(value, list) or len(value) != 2:
            got = f"{len(value)}" if isinstance(value, list) else kind_of(value)
            code = "wrong-length" if isinstance(value, list) else "wrong-type"
            message = f"`{at[-1]}` of {keys.owner} expects a list of 2 numbers, got {got}"
            keys.add(code, message, *at, help=f"write for instance `{at[-1]}: [18, 22]`")
            return None
        if any(isinstance(each, bool) for each in value):
            keys.add(
                "wrong-type", f"`{at[-1]}` of {keys.owner} expects a list of 2 numbers, got a boolean", *at
            )
            return None
        found = _numbers(keys, value, *at)
        if found is not None and found[0][1] == found[1][1] and found[0][0] > found[1][0]:
            low, high = value
            message = f"`{at[-1]}` of {keys.owner} starts with {shown(low)}, which is more than {shown(high)}"
            keys.add("out-of-range", message, *at, help=f"write `{at[-1]}: [{shown(high)}, {shown(low)}]`")
        return found

    def schema(self) -> Schema:
        return {"type": "array", "items": reference("number"), "minItems": 2, "maxItems": 2}


class Tolerance:
    """Form of a tolerance: a number, or an angle with its unit."""

    number = form.Number(least=0)

    def read(self, keys: Keys, value: Any, *at: str | int) -> Number | None:
        angle = Angle.read(value) if isinstance(value, str) else None
        if angle is not None and angle.value >= 0:
            return angle.value, angle.unit
        number = self.number.read(keys, value, *at)
        return None if number is None else (number, None)

    def schema(self) -> Schema:
        return self.number.schema()


class HowMany:
    """Form of a count, or of the least and the most of a count, read as a pair."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[int, int] | None:
        pair = value if isinstance(value, list) and len(value) == 2 else [value, value]
        if not all(isinstance(each, int) and not isinstance(each, bool) and each >= 0 for each in pair):
            message = (
                f"`{at[-1]}` of {keys.owner} expects a count, or the least and the most, got {kind_of(value)}"
            )
            keys.add("wrong-type", message, *at, help=f"write for instance `{at[-1]}: 7`, or `[6, 8]`")
            return None
        low, high = pair
        if low > high:
            message = f"`{at[-1]}` of {keys.owner} starts with {low}, which is more than {high}"
            keys.add("out-of-range", message, *at, help=f"write `{at[-1]}: [{high}, {low}]`")
        return low, high

    def schema(self) -> Schema:
        count = {**reference("integer"), "minimum": 0}
        return {"anyOf": [count, {"type": "array", "items": count, "minItems": 2, "maxItems": 2}]}


class Selector:
    """Form of a selector: a tag with a name or a glob, and what narrows it down."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> Selected | None:
        if not isinstance(value, dict):
            message = f"`{at[-1]}` of {keys.owner} is a mapping from a tag to a name, got {kind_of(value)}"
            listed = isinstance(value, list)
            help = (
                "write a check for each selector"
                if listed
                else f"write for instance `{at[-1]}: {{site: tcp}}`"
            )
            keys.add("wrong-type", message, *at, help=help)
            return None
        tags = [key for key in value if key not in (*AROUND, WHERE)]
        for tag in tags:
            if tag not in TAGS:
                self._unknown(keys, tag, *at)
                return None
        if len(tags) != 1:
            message = f"`{at[-1]}` of {keys.owner} has {len(tags)} tags, and needs one"
            keys.add(
                "wrong-type", message, *at, help="write a check for each: `{site: NAME}`, `{body: NAME}`"
            )
            return None
        (tag,) = tags
        glob = keys.glob_of(value[tag], "a name or a glob", *at, tag)
        parent, inside = (
            _around(keys, tag, value[key], *at, key) if key in value else None for key in AROUND
        )
        where = _where(keys, tag, value[WHERE], *at, WHERE) if WHERE in value else ()
        return None if glob is None else Selected(tag, glob, parent, inside=inside, where=where)

    def _unknown(self, keys: Keys, tag: str, *at: str | int) -> None:
        help, fix = advised(tag, (*TAGS, *AROUND, WHERE))
        note = exists_note("tag", TAGS, tag)
        message = f"`{tag}` in {keys.owner} is not a tag whose names a compiled model has"
        if tag in _BESIDE or tag == "expect":
            word = "count" if tag == "expect" else tag
            help, fix = (
                f"write `{word}` beside `{at[-1]}`, behind the `}}` of the selector: `{word}: …`",
                None,
            )
        elif tag in NARROWING:
            message = f"`{tag}` in {keys.owner} is nothing that a compiled model knows"
            note = Note("it knows `parent`, `in` and `where`, and names with the prefixes of parts")
            help = fix = None
        keys.add("unknown-key", message, *at, tag, key=True, notes=(note,), help=help, fix=fix)

    def schema(self) -> Schema:
        body = {
            "type": "object",
            "properties": {"body": {**GLOB, "description": "a glob over the names of bodies"}},
            "required": ["body"],
            "additionalProperties": False,
        }
        around = zip(AROUND, ("right around", "somewhere around"), strict=True)
        return {
            "type": "object",
            "minProperties": 1,
            "maxProperties": 4,
            "additionalProperties": False,
            "properties": {
                **{tag: {**GLOB, "description": f"a glob over the names: {tag}"} for tag in TAGS},
                WHERE: {
                    "type": "object",
                    "minProperties": 1,
                    "description": "only what has these values in the compiled model: `type: mesh`, `joint: elbow`",
                },
                **{
                    key: {**body, "description": f"only what has a body of that name {where} it"}
                    for key, where in around
                },
            },
        }


def _where(keys: Keys, tag: str, value: object, *at: str | int) -> tuple[Where, ...]:
    """Return the conditions on attributes of the compiled model."""
    if tag not in (*WITH_NUMBERS, *ENUMERATED) and not naming(tag):
        message = f"`{WHERE}` in {keys.owner}: a compiled model has no attributes of a {tag} that could be asked for"
        keys.add("unknown-key", message, *at, key=True, help=f"leave `{WHERE}` out")
        return ()
    if not isinstance(value, dict) or not value:
        message = f"`{WHERE}` in {keys.owner} is a mapping from attributes to values, got {kind_of(value)}"
        keys.add("wrong-type", message, *at, help=f'write for instance `{WHERE}: {{"size[0]": 0.1}}`')
        return ()
    conditions: list[Where] = []
    words = [*keywords(tag), *naming(tag)]
    for key, asked in value.items():
        if key in words:
            word = _word(keys, tag, key, asked, *at, key)
            conditions += [Where(key, key, None, word=word)] if word is not None else []
            continue
        attr, place = _attribute(keys, tag, key, *at, key, others=words)
        numbers = _numbers(keys, asked, *at, key) if attr is not None else None
        _check_one(keys, asked, place, *at, key)
        if attr is not None and numbers is not None:
            conditions.append(Where(key, attr, place, value=numbers))
    return tuple(conditions)


def _word(keys: Keys, tag: str, attr: str, value: object, *at: str | int) -> str | None:
    """Return the value that an attribute must have: one of its keywords, or a glob over names."""
    if attr not in keywords(tag):
        return keys.glob_of(value, "a name or a glob", *at)
    word, known = str(value), keywords(tag)[attr]
    if word in known:
        return word
    help, fix = advised(word, known)
    note = exists_note("value", known, word)
    message = f"`{attr}` of a {tag} is never `{shown(value)}`"
    keys.add("wrong-keyword", message, *at, notes=(note,), help=help, fix=fix)
    return None


def _around(keys: Keys, tag: str, value: object, *at: str | int) -> str | None:
    """Return the glob for a body around the selected elements."""
    key = at[-1]
    body = value.get("body") if isinstance(value, dict) and len(value) == 1 else None
    if tag not in HOLDERS:
        message = f"`{tag}` in {keys.owner} is in no body"
        keys.add("unknown-key", message, *at, key=True, help=f"leave `{key}` out")
    elif isinstance(body, str) and body:
        return keys.glob_of(body, "a name or a glob", *at, "body")
    else:
        message = f"`{key}` in {keys.owner} is a body by its name or a glob, got {kind_of(value)}"
        keys.add("wrong-type", message, *at, help=f'write for instance `{key}: {{body: "**/pad"}}`')
    return None


FORM = Keyed(
    "How many elements the compiled model has, and the values of their attributes.",
    Key("select", Selector(), "which elements; without it, `attr` is a number of the whole model"),
    Key("count", HowMany(), "how many there are, or the least and the most; without it, at least one"),
    Key(
        "attr",
        form.Name("an attribute of MJCF"),
        "an attribute of MJCF, with an index for one of its numbers: `range[1]`; of a body also `subtree_mass`;"
        f" without `select` one of {', '.join(OF_THE_MODEL)}",
    ),
    Key("equals", Values(), "the value: a number, an angle, a boolean, or a list"),
    Key("tol", Tolerance(), "how far each number may be from `equals`; without it, rounding"),
    Key("range", Ends(), "the least and the most that each number may be"),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Expect | None:
    before = len(keys.faults)
    _check_keys(keys)
    select: Selected | None = found["select"]
    if "select" in keys.value and select is None:
        return None
    attr, index = None, None
    if found["attr"] is not None:
        attr, index = _attribute(keys, None if select is None else select.tag, found["attr"], "attr")
        _check_one(keys, keys.value.get("equals"), index, "equals")
    if len(keys.faults) > before:
        return None
    return Expect(
        keys.name, select, found["count"], attr=attr, index=index, equals=found["equals"], tol=found["tol"],
        range=found["range"], at=at,
    )  # fmt: skip


def _check_keys(keys: Keys) -> None:
    """Report keys that miss another key, or exclude it."""
    if any(each.code == "unknown-key" and each.at[:2] == (keys.name, keys.word) for each in keys.faults):
        return  # the key with this fault may be the one that is missing
    given = keys.value
    if "select" not in given and "attr" not in given:
        message = f"`{keys.word}` of {keys.owner} does not say of what"
        help = "write for instance `select: {joint: NAME}`, or `attr: mass`"
        keys.add("missing-key", message, key=True, help=help)
    elif "count" in given and "select" not in given:
        message = f"`count` of {keys.owner} belongs to `select`"
        keys.add("unknown-key", message, "count", key=True, help="write `select: {TAG: NAME}` beside it")
    keys.one_of("equals", "range")
    value = next((key for key in ("equals", "range") if key in given), None)
    if "attr" in given and value is None:
        message = f"`attr` of {keys.owner} does not say which value it has"
        keys.add(
            "missing-key", message, "attr", key=True, help="write `equals: VALUE`, or `range: [LOW, HIGH]`"
        )
    elif value is not None and "attr" not in given and "select" in given:
        message = f"`{value}` of {keys.owner} belongs to `attr`"
        keys.add("unknown-key", message, value, key=True, help="write `attr: NAME` beside it")
    if "tol" in given and "equals" not in given:
        message = f"`tol` of {keys.owner} belongs to `equals`"
        keys.add("unknown-key", message, "tol", key=True, help="remove `tol`, or write `equals: VALUE`")


KIND = Kind("expect", FORM, make, example="{select: {site: NAME}, count: 1}")

_ROUNDING = {4: 1e-6, 8: 1e-9}
"""Rounding tolerance by the bytes of a number, relative to the larger of 1 and the value."""
_SHOWN = 8
_UNITS = {MASS: " kg", SUBTREE_MASS: " kg"}
_COUNTED = {kind.size: word for word, kind in KINDS.items() if word not in ("body", "key")}


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with its unit as written; `per_unit` is one such unit in the unit of the compiled model."""

    number: float
    unit: str | None
    per_unit: float

    @property
    def value(self) -> float:
        """The number in the compiled model's unit."""
        return self.number * self.per_unit

    def __str__(self) -> str:
        if isinstance(self.number, bool):
            return str(self.number).lower()
        return f"{self.number:.9g}{self.unit or ''}"

    def like(self, value: float) -> str:
        """Return a value of the compiled model as text, in the unit of this quantity."""
        if isinstance(value, bool):
            return str(value).lower()
        return str(Quantity(value / self.per_unit, self.unit, self.per_unit))


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report another number of elements than expected, and elements with other values."""
    select = asked["select"]
    if select is None:
        return _of_the_model(scope, asked)
    elements = _elements(scope, select, asked["angle"])
    if isinstance(elements, Fault):
        return [elements]
    scope.found(f"{select['tag']} {select['glob']}", len(elements))
    wrong = _miscounted(scope, asked, elements)
    return wrong + _differing(scope, asked, elements) if asked["attr"] else wrong


def _elements(scope: Scope, select: dict[str, Any], angle: str | None) -> list[int] | Fault:
    """Return the elements that a selector matches, or a finding if its values cannot be looked up."""
    tag, glob = select["tag"], select["glob"]
    named = [0] if (tag, glob) == ("body", "world") else scope.matching(tag, glob)
    elements = []
    for index in named:
        fits = _is_there(scope, index, select) and _fits(scope, index, select, angle)
        if isinstance(fits, Fault):
            return fits
        elements += [index] if fits else []
    return elements


def _miscounted(scope: Scope, asked: dict[str, Any], elements: list[int]) -> list[Fault]:
    select, count = asked["select"], asked["count"]
    tag, glob = select["tag"], select["glob"]
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
    around = list(_bodies_around(scope, select["tag"], index))
    asked = ((select["parent"], around[:1]), (select["inside"], around))
    return all(glob is None or set(bodies) & set(scope.matching("body", glob)) for glob, bodies in asked)


def _bodies_around(scope: Scope, kind: str, index: int) -> Iterator[int]:
    """Yield the bodies around an element, from the nearest to the world."""
    body = holder(scope.model, kind, index)
    while body:
        yield body
        body = holder(scope.model, "body", body)
    yield 0


def _fits(scope: Scope, index: int, select: dict[str, Any], angle: str | None) -> bool | Fault:
    """Return whether an element has the values in `where`, or a finding if they cannot be looked up."""
    tag = select["tag"]
    for each in select["where"]:
        if each["word"] is not None:
            words = set(words_of(scope, tag, index, attr=each["attr"]))
            if not scope.fitting(each["word"], words):
                return False
            continue
        pair = _pair(scope, tag, index, {**each, "angle": angle}, each["value"])
        if isinstance(pair, Fault):
            return False if pair.code == "wrong-length" else replace(pair, at=("select", WHERE, each["key"]))
        actual, expected = pair
        if len(expected) != actual.size or not _equal(actual, expected, None):
            return False
    return True


def _differing(scope: Scope, asked: dict[str, Any], elements: list[int]) -> list[Fault]:
    """Report elements with another value."""
    tag = asked["select"]["tag"]
    wrong: list[tuple[str, str]] = []
    expected = ""
    key = "range" if asked["equals"] is None else "equals"
    for index in elements:
        pair = _pair(scope, tag, index, asked, asked[key])
        if isinstance(pair, Fault):
            return [replace(pair, at=pair.at or (key,))]
        actual, quantities = pair
        scope.values[scope.written(tag, index)] = _plain(actual)
        if key == "equals" and len(quantities) != actual.size:
            name = asked["select"]["glob"]
            message = f"`{asked['attr']}` of {tag} `{name}` has {actual.size} numbers, `equals` has {len(quantities)}"
            return [Fault("wrong-length", message, ("equals",))]
        unit = _UNITS.get(asked["attr"], "")
        have = _listed(_like(quantities, actual.tolist())) + unit
        if key == "equals":
            own = _unit_of(tag, asked["attr"])
            tol = None if asked["tol"] is None else _quantity(asked["tol"][0], asked["tol"][1], own)
            holds = _equal(actual, quantities, None if tol is None else tol.value)
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
    more = [f"{other}: {value}" for other, value in wrong[1:_SHOWN]]
    more += [f"and {len(wrong) - _SHOWN} more"] if len(wrong) > _SHOWN else []
    return [failed(f"`{attr}` of {name} is {have}, not {expected}", expected, have, key, more=more)]


def _of_the_model(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report a number of the model that is not the expected one. Merged keyframes belong to no single recipe."""
    attr, key = asked["attr"], "range" if asked["equals"] is None else "equals"
    actual = _mass(scope) if attr == MASS else _size(scope, attr)
    if actual is None:
        return []
    scope.found(attr, actual)
    numbers = [number for number, _ in asked[key]]
    unit = _UNITS.get(attr, "")
    if key == "equals":
        (number,) = numbers if len(numbers) == 1 else (math.nan,)
        slack = _ROUNDING[8] * max(1.0, abs(number)) if asked["tol"] is None else asked["tol"][0]
        low, high = number - slack, number + slack
        expected = f"{number:.9g}{unit}" + ("" if asked["tol"] is None else f" ± {slack:g}{unit}")
    else:
        low, high = numbers
        expected = f"{low:.9g} to {high:.9g}{unit}"
    if low <= actual <= high:
        return []
    owner = "the model" if scope.whole else "this recipe's model"
    have = f"{actual:.9g}{unit}"
    return [failed(f"`{attr}` of {owner} is {have}, not {expected}", expected, have, key)]


def _mass(scope: Scope) -> float:
    return float(sum(scope.model.body_mass[index] for index in scope.own("body")))


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


def _pair(
    scope: Scope, tag: str, index: int, asked: Mapping[str, Any], numbers: Sequence[Number]
) -> tuple[Any, list[Quantity]] | Fault:
    """Return the numbers that an element has, as a flat array, and those that are written."""
    actual = _values(scope, tag, index, asked)
    if isinstance(actual, Fault):
        return actual
    quantities = _quantities(scope, tag, index, asked, numbers)
    return quantities if isinstance(quantities, Fault) else (actual, quantities)


def _values(scope: Scope, tag: str, index: int, asked: Mapping[str, Any]) -> Any | Fault:
    """Return the numbers of an attribute as a flat array, or the one of its `index`."""
    import numpy as np

    from mjcompose.mujoco.addresses import rows_of

    attr = asked["attr"]
    name = "body_subtreemass" if attr == SUBTREE_MASS else array_of(tag, attr)
    array = getattr(scope.model, name, None)
    if array is None:
        return Fault("unknown-attribute", f"this MuJoCo has no `{attr}` of a {tag}", ("attr",))
    row = rows_of(
        scope.model, tag, name, index=index
    ).start  # a joint has one value; for an actuator the first counts
    numbers = np.atleast_1d(array[row]).ravel()
    if asked["index"] is None:
        return numbers
    if asked["index"] >= numbers.size:
        message = f"`{attr}` of {scope.called(tag, index)} has {numbers.size} numbers"
        return Fault("wrong-length", message, ("attr",), notes=(Note(f"the first is `{attr}[0]`"),))
    return numbers[asked["index"]][None]


def _quantities(
    scope: Scope, tag: str, index: int, asked: Mapping[str, Any], numbers: Sequence[Number]
) -> list[Quantity] | Fault:
    """Return the expected numbers in the unit of the compiled model."""
    attr = asked["attr"]
    joint = JOINT_TYPES[int(scope.model.jnt_type[index])].word if tag == "joint" else ""
    angular = attr in ANGLES.get(joint, ())
    quantities: list[Quantity] = []
    for number, unit in numbers:
        if unit is None and angular and number != 0:
            unit = {"degree": "deg", "radian": "rad", None: None}[asked["angle"]]
            if unit is None:
                help = f"write `{number:.9g}deg` or `{number:.9g}rad`, or `angle: degree` at the top of the recipe"
                message = f"`{attr}` of {joint} {scope.called(tag, index)} is an angle, and `{number:.9g}` has no unit"
                return Fault("bare-angle", message, help=help)
        quantities.append(_quantity(number, unit, _unit_of(tag, attr)))
    return quantities


def _unit_of(tag: str, attr: str) -> str:
    return "deg" if is_in_degrees(tag, attr) else "rad"


def _quantity(number: float, unit: str | None, own: str) -> Quantity:
    if unit in (None, own):
        return Quantity(number, unit, 1.0)
    return Quantity(number, unit, math.radians(1) if own == "rad" else math.degrees(1))


def _equal(actual: Any, expected: Sequence[Quantity], tol: float | None) -> bool:
    import numpy as np

    meant = np.array([each.value for each in expected], dtype=np.float64)
    apart = np.abs(actual.astype(np.float64) - meant)
    if tol is None:
        part = _ROUNDING[4 if actual.dtype == np.float32 else 8]
        return bool(np.all(apart <= part * np.maximum(1.0, np.abs(meant))))
    return bool(np.all(apart <= tol))


def _plain(numbers: Any) -> Any:
    """Return one number or a list of numbers for JSON; single-precision numbers are rounded to six digits."""
    plain = [float(f"{each:.6g}") if numbers.dtype.itemsize == 4 and numbers.dtype.kind == "f" else each
             for each in numbers.tolist()]  # fmt: skip
    return plain[0] if len(plain) == 1 else plain


def _like(quantities: Sequence[Quantity], numbers: Sequence[float]) -> list[str]:
    """Return numbers as text, each in the unit of its quantity, or all in that of the first."""
    if len(quantities) != len(numbers):
        quantities = [quantities[0]] * len(numbers)
    return [each.like(number) for each, number in zip(quantities, numbers, strict=True)]


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"[{', '.join(words)}]"

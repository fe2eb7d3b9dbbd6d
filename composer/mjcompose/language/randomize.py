"""The section `randomize`: seeded draws of fields."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Any, Literal

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.limits import advice, in_force
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.language.distribution import (
    BELLS,
    CHOICE,
    EXAMPLES,
    INTERVALS,
    KINDS,
    DistributionReader,
    FieldDistribution,
    Operation,
    inner_kinds,
)
from mjcompose.language.element import path_of
from mjcompose.language.form import (
    COUNT,
    EXCLUSIVE,
    Form,
    Schema,
    Settings,
    check_rows,
    definition,
    kind_of,
    read_count,
    reference,
    shown,
    unknown_key,
)
from mjcompose.language.form import SCHEMAS as COUNTS
from mjcompose.language.select import advice_on_narrowing, kinds_of, read_selector
from mjcompose.language.used_model import Model
from mjcompose.language.value import attribute_and_index
from mjcompose.language.verbs.values import MASS, Checker
from mjcompose.model.selector import Selector

OPERATIONS = ("scale", "offset")
PER = ("element", "body", "part", "sample")
_SELECTING = ("select", "attr", "per", *COUNT)
KEYS = ("select", "attr", "param", *KINDS, *OPERATIONS, "per", "group", *COUNT)
NOT_NEGATIVE = frozenset(
    "mass density diaginertia armature damping frictionloss stiffness friction size".split()
)
"""Attributes of which a draw must not make a negative number: of the first number, if they are polynomials."""
_POLYNOMIALS = ("damping", "stiffness")
_SIGNS = {"set": "=", "scale": "×", "offset": "+"}


@dataclass(frozen=True, slots=True)
class DrawField:
    """A field with its name. Either `select` and `attr` are set, or `param`. `at` is its path in the recipe.

    `operation` says how a draw is used: as the value, as a factor, or as an offset.
    """

    name: str
    distribution: FieldDistribution
    operation: Operation
    select: Selector | None = None
    attr: str = ""
    param: str | None = None
    per: Literal["element", "body", "part", "sample"] = "element"
    expect: int | None = None
    optional: bool = False
    at: Path = ()
    group: str | None = None

    @property
    def stream(self) -> str:
        """Return the name of its random numbers: the field itself, or its group, in which all fields share them."""
        return self.name if self.group is None else f"group {self.group}"

    @property
    def drawn_at(self) -> Path:
        """Return the path to the distribution."""
        between = () if self.operation == "set" else (self.operation,)
        return (*self.at, *between, self.distribution.kind)

    @property
    def words(self) -> str:
        """Return in one line what is drawn, for what, and from which distribution, as `plan` prints it."""
        what = f"the parameter {self.param}" if self.param is not None else f"{self.attr} of {self.select}"
        shared = {"sample": ", one for all", "body": ", one a body", "part": ", one a part"}.get(self.per, "")
        grouped = f", with the others of {self.group}" if self.group is not None else ""
        return f"draw {self.name}: {what} {_SIGNS[self.operation]} {self.distribution}{shared}{grouped}"


def must_not_be_negative(attribute: str, component: int) -> bool:
    """Return whether a negative number has no meaning there.

    >>> must_not_be_negative("damping", 0), must_not_be_negative("damping", 1), must_not_be_negative("pos", 0)
    (True, False, False)
    """
    return attribute in NOT_NEGATIVE and (component == 0 or attribute not in _POLYNOMIALS)


def read_field(name: str, value: Any, bare_angles: bool, faults: list[Fault]) -> DrawField | None:
    """Return the field, or None after a reported fault. The paths of faults start with the field's name."""
    owner, before = f"field `{name}`", len(faults)
    if not isinstance(value, dict):
        example = f'{name}: {{select: {{geom: "**"}}, attr: friction, uniform: [0.5, 1]}}'
        message = f"{owner} of `randomize` is a mapping, got {kind_of(value)}"
        faults.append(Fault("wrong-type", message, (name,), help=f"write for instance `{example}`"))
        return None
    faults += _unknown(name, value)
    meant = {near for key in value if key not in KEYS for near in closest(key, KEYS)}
    faults += _subject(name, value, meant)
    operation, kind, inner, at = _written(name, value, meant, faults=faults)
    reader = DistributionReader(owner, operation, faults)
    distribution = None if kind is None else reader.read(kind, inner[kind], (*at, kind))
    selector = None
    if "select" in value:
        selector = read_selector(value["select"], (name, "select"), f"`select` of {owner}", faults=faults)
    per = value.get("per", PER[0])
    if per not in PER:
        near = closest(str(per), PER)
        faults.append(Fault("wrong-keyword", f"`per` of {owner} cannot be {kind_of(per)}", (name, "per"),
                            notes=(exists_note("keyword", PER),),
                            help=f"write `per: {near[0] if near else PER[0]}`",
                            fix=renaming(str(per), PER)))  # fmt: skip
    group = value.get("group")
    if group is not None and (not isinstance(group, str) or not group):
        message = f"`group` of {owner} is the name of a group, got {kind_of(group)}"
        faults.append(Fault("wrong-type", message, (name, "group"), help="write for instance `group: wear`"))
    expect, optional = read_count(value, (name,), faults, owner=owner)
    for key in ("attr", "param"):
        if key in value and (not isinstance(value[key], str) or not value[key]):
            what = "an attribute of MJCF" if key == "attr" else "the name of a parameter"
            faults.append(
                Fault("wrong-type", f"`{key}` of {owner} is {what}, got {kind_of(value[key])}", (name, key))
            )
    if len(faults) > before or distribution is None:
        return None
    field = DrawField(
        name,
        distribution,
        operation,
        select=selector,
        attr=value.get("attr", ""),
        param=value.get("param"),
        per=per,
        expect=expect,
        optional=optional,
        at=path_of(value),
        group=group,
    )
    if selector is not None:
        _check_attribute(field, selector, (*at, distribution.kind), bare_angles=bare_angles, faults=faults)
    return field if len(faults) == before else None


def _unknown(name: str, value: dict[str, Any]) -> Iterator[Fault]:
    for key in value:
        if key not in KEYS:
            message = f"field `{name}` of `randomize` has no key `{key}`"
            fault = unknown_key(message, key, KEYS, at=(name, key))
            elsewhere = advice_on_narrowing(key)
            yield replace(fault, help=elsewhere, fix=None) if elsewhere else fault


def _subject(name: str, value: dict[str, Any], meant: set[str]) -> Iterator[Fault]:
    """Yield the faults in `select`, `attr` and `param`, which say what is drawn. `meant` are misspelled keys."""
    if "param" in meant:
        return
    if "param" in value:
        for key in _SELECTING:
            if key in value:
                message = f"field `{name}` draws a parameter, and has `{key}` as well"
                related = (("the parameter is named here", (name, "param")),)
                yield Fault(EXCLUSIVE, message, (name, key), key=True, related=related,
                            help=f"leave `param` or `{key}` out")  # fmt: skip
        return
    for key, example in (("select", '{geom: "**"}'), ("attr", "friction")):
        if key not in value and key not in meant:
            other = "; a parameter is drawn by `param: NAME`" if "select" not in value else ""
            yield Fault("missing-key", f"field `{name}` of `randomize` lacks `{key}`", (name,), key=True,
                        help=f"write for instance `{key}: {example}`{other}")  # fmt: skip


def _written(
    name: str, value: dict[str, Any], meant: set[str], faults: list[Fault]
) -> tuple[Operation, str | None, dict[str, Any], Path]:
    """Return the operation, the kind of the distribution or None, and the mapping that contains it with its path."""
    given = [key for key in (*KINDS, *OPERATIONS) if key in value]
    if not given and meant.isdisjoint((*KINDS, *OPERATIONS)) and all(key in KEYS for key in value):
        help = f"write for instance `uniform: {EXAMPLES['uniform']}`, or `scale: {{uniform: …}}` for a factor"
        message = f"field `{name}` of `randomize` has no distribution"
        faults.append(Fault("missing-key", message, (name,), key=True, help=help,
                            notes=(exists_note("distribution", KINDS),)))  # fmt: skip
    for other in given[1:]:
        message = f"field `{name}` has both `{given[0]}` and `{other}`, of which only one may stand"
        faults.append(
            Fault(EXCLUSIVE, message, (name, other), key=True, help="give the other a field of its own")
        )
    if len(given) != 1:
        return "set", None, {}, (name,)
    if given[0] in KINDS:
        return "set", given[0], value, (name,)
    operation: Operation = "scale" if given[0] == "scale" else "offset"
    inner, at = value[operation], (name, operation)
    kinds = list(inner_kinds(inner)) if isinstance(inner, dict) else []
    help = f"write `{operation}: {{uniform: {EXAMPLES['uniform']}}}`"
    if not isinstance(inner, dict) or len(inner) != 1 or not kinds:
        wrong = [key for key in inner if key not in KINDS] if isinstance(inner, dict) else []
        near = closest(wrong[0], KINDS) if wrong else []
        faults.append(
            Fault("wrong-type", f"`{operation}` of field `{name}` is a mapping with one distribution, "
                  f"got {_keys_of(inner)}",
                  at, notes=(exists_note("distribution", KINDS),),
                  help=f"write `{near[0]}`" if near else help)
        )  # fmt: skip
        return operation, None, {}, at
    return operation, kinds[0], inner, at


def _keys_of(value: Any) -> str:
    if isinstance(value, dict) and value:
        return ", ".join(f"`{key}`" for key in value)
    return kind_of(value)


def _check_attribute(
    field: DrawField, selector: Selector, at: Path, bare_angles: bool, faults: list[Fault]
) -> None:
    """Report an attribute, or numbers drawn for it, that the grammar does not allow."""
    name, index = attribute_and_index(field.attr)
    kinds = kinds_of(selector.tag)
    is_mass = name == MASS and any(kind.path == "body" for kind in kinds)
    fitting = [kind.attributes[name] for kind in kinds if name in kind.attributes]
    found: list[Fault] = []
    checker = Checker(bare_angles, found)
    distribution = field.distribution
    for value in distribution.values if distribution.kind == CHOICE else (_like(field),):
        if isinstance(value, list) and field.operation == "set" and index is None:
            checker.attributes("set", {field.attr: value}, selector, at=at)
        elif distribution.is_whole or field.operation != "set" or index is not None or is_mass:
            checker.attributes(field.operation, {field.attr: value}, selector, at=at)
        elif fitting and not any(each.is_number for each in fitting):
            checker.attributes("set", {field.attr: value}, selector, at=at)
        else:  # a number for each component of however many there are
            checker.attributes("offset", {field.attr: value}, selector, at=at)
        if found:
            break
    if found:
        fault = found[0]
        attribute_at = (field.name, "attr")
        wrong_name = fault.code in ("unknown-attribute", "unknown-key", "unknown-element") or fault.key
        faults.append(Fault(fault.code, fault.message, attribute_at if wrong_name else at,
                            notes=fault.notes, help=fault.help,
                            fix=fault.fix if wrong_name else None))  # fmt: skip
        return
    whole = [each for each in fitting if each.type == "int"]
    if fitting and len(whole) == len(fitting) and distribution.kind not in ("integers", CHOICE):
        message = f"`{name}` of `{selector.tag}` is a whole number, which `{distribution.kind}` does not draw"
        faults.append(
            Fault("wrong-type", message, at, help="write `integers: [FIRST, LAST]` or `choice: […]`")
        )
    if field.operation != "offset":
        _check_range(field, name, index, at=at, faults=faults)


def _like(field: DrawField) -> Any:
    """Return a value of the same form as the draws."""
    distribution = field.distribution
    number: Any = 1 if distribution.kind == "integers" else 0.5
    if distribution.unit is not None:
        number = f"{number}{distribution.unit}"
    elif field.operation != "scale" and all(
        each == 0 for items in distribution.parameters.values() for each in items
    ):
        number = 0
    return number if distribution.components is None else [number] * distribution.components


def _check_range(field: DrawField, name: str, index: int | None, at: Path, faults: list[Fault]) -> None:
    """Report a bounded distribution with numbers that have no meaning. The draws of others are checked one by one."""
    distribution = field.distribution
    for component in range(distribution.components or 1):
        lowest = min(
            (each for each in distribution.extremes(component) if abs(each) != float("inf")), default=0.0
        )
        place = index if index is not None else component
        if lowest < 0 and must_not_be_negative(name, place):
            what = "factors" if field.operation == "scale" else "values"
            message = f"`{field.attr}` cannot be negative, and field `{field.name}` draws {what} from {shown(lowest)}"
            faults.append(Fault("out-of-range", message, at, help="let it begin at 0 or above"))
            return


_TEXT: Schema = {"type": "string", "minLength": 1}
_BOUND: Schema = {
    "anyOf": [reference("number"), {"type": "array", "items": reference("number"), "minItems": 1}]
}
_ABOUT = {
    "uniform": "between two bounds, all numbers as likely: `[0.4, 1.2]`",
    "loguniform": "between two positive bounds, all orders of magnitude as likely: `[0.1, 10]`",
    "integers": "whole numbers from the first to the last: `[1, 6]`",
    "normal": "a bell about `mean` with the standard deviation `std`",
    "truncnormal": "the part of a normal distribution that is between `min` and `max`",
    "lognormal": "numbers whose logarithm is normal, with this mean and standard deviation",
    CHOICE: "one of these values, all as likely",
}
_KEYS = {
    "mean": "the middle; of `lognormal` that of the logarithm. Without it: what changes nothing",
    "std": "the standard deviation; of `lognormal` that of the logarithm",
    "min": "the least that is drawn",
    "max": "the greatest that is drawn",
}


def fields() -> Schema:
    """Return the schema of the mapping `fields`."""
    return {"type": "object", "minProperties": 1, "additionalProperties": reference("draw")}


_DISTRIBUTIONS = {kind: {**reference(f"distribution:{kind}"), "description": _ABOUT[kind]} for kind in KINDS}
_ONE: Schema = {
    "type": "object",
    "properties": _DISTRIBUTIONS,
    "additionalProperties": False,
    "minProperties": 1,
    "maxProperties": 1,
}
_FIELD: dict[str, Schema] = {
    "select": {**reference("selector"), "description": "whose attribute is drawn"},
    "attr": {
        **_TEXT,
        "description": "an attribute of MJCF, with an index for one number: `friction[0]`",
    },
    "param": {**_TEXT, "description": "a parameter that is drawn, in place of `select` and `attr`"},
    **_DISTRIBUTIONS,
    "scale": {**_ONE, "description": "what is drawn is a factor"},
    "offset": {**_ONE, "description": "what is drawn is added"},
    "per": {
        "enum": [*PER],
        "description": "a draw for each element, for each body, for each part, or one for all in a sample",
    },
    "group": {
        **_TEXT,
        "description": "fields of one group are drawn together: where one is high in its distribution, all are",
    },
    **COUNTS,
}
check_rows("the JSON Schema of `fields` in composer/mjcompose/language/randomize.py", _FIELD, KEYS)


@definition("draw")
def field(_: str) -> Schema:
    """Return the schema of one field."""
    return {
        "type": "object",
        "properties": dict(_FIELD),
        "additionalProperties": False,
        "minProperties": 2,
        "if": {"required": ["param"]},
        "then": {"properties": {"select": False, "attr": False, "per": False}},
        "else": {"required": ["select", "attr"]},
    }


@definition("distribution")
def distribution(kind: str) -> Schema:
    """Return the schema of the value behind the name of a distribution."""
    if kind == CHOICE:
        return {"type": "array", "minItems": 1}
    if kind in INTERVALS:
        return {"type": "array", "items": _BOUND, "minItems": 2, "maxItems": 2}
    keys = BELLS[kind][1]
    return {
        "type": "object",
        "properties": {key: {**_BOUND, "description": _KEYS[key]} for key in keys},
        "required": [key for key in keys if key != "mean"],
        "additionalProperties": False,
    }


MAX_SEED = 2**64 - 1


@dataclass(frozen=True, slots=True)
class Whole(Form):
    """Form of a whole number from `least` to `most`, or to the limit with the name `most`.

    `key` is its name in messages.
    """

    key: str
    least: int
    most: int | str

    def schema(self) -> Schema:
        number: dict[str, Any] = {"type": "integer", "minimum": self.least}
        if isinstance(self.most, int):
            number["maximum"] = self.most
        return {"anyOf": [number, {"type": "string", "pattern": r"\$\{"}]}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> int | None:
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # what an expression makes
        if isinstance(value, bool) or not isinstance(value, int):
            message = f"`{self.key}` expects a whole number, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message))
            return None
        most = self.most if isinstance(self.most, int) else getattr(in_force(), self.most)
        if not self.least <= value <= most:
            message = f"`{self.key}` is from {self.least} to {most}, got {value}"
            limited = isinstance(self.most, str) and value > most
            code, help = ("limit-exceeded", advice(self.key, value)) if limited else ("out-of-range", None)
            faults.append(Fault(code, message, help=help))
        return value


@dataclass(frozen=True, slots=True)
class Fields(Form):
    """Form of the field `fields`: a mapping from names to what is drawn, read as a tuple of `DrawField`."""

    def schema(self) -> Schema:
        return fields()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[DrawField, ...]:
        found: list[DrawField | None] = []
        if isinstance(value, dict) and value:
            found = [
                read_field(name, item, settings.bare_angles, faults=faults) for name, item in value.items()
            ]
        else:
            got = "an empty one" if value == {} else kind_of(value)
            message = f"`fields` is a mapping from names to what is drawn, got {got}"
            help = (
                'write `fields: {friction: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.5, 1]}}`'
            )
            faults.append(Fault("wrong-type", message, help=help))
        return tuple(each for each in found if each is not None)


class Randomize(Model):
    """Seeded draws of parameters, and of attributes of the finished model."""

    seed: Annotated[int, Whole("seed", 0, MAX_SEED)]
    """What makes these draws differ from those of another seed: a whole number below 2**64."""
    samples: Annotated[int, Whole("samples", 1, "samples")]
    """How many samples there are, besides sample 0, the model without any draw."""
    fields: Annotated[tuple[DrawField, ...], Fields()]
    """What is drawn: a mapping from a name, which is part of the seed, to a distribution and what it is for."""

    @property
    def of_parameters(self) -> tuple[DrawField, ...]:
        """Return the fields that draw parameters."""
        return tuple(each for each in self.fields if each.param is not None)

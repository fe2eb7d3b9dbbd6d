"""Values that `edit` gives to attributes: their checks, and their JSON Schema by the selector's tag."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import closest
from mjcompose.base.words import value_text
from mjcompose.language.element_schema import TEMPLATE_PATTERN, attribute_schema
from mjcompose.language.forms.context import REFERENCE, ByGrammar, Schema, Settings, define, definition, reference
from mjcompose.language.forms.model import IT
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.language.select import check_template, kinds_of, unknown_attribute
from mjcompose.language.value import EXCLUSIVE, attribute_and_index, bare_angle, kind_of, no_angle, read_value
from mjcompose.text.expression import Angle
from mjcompose.text.node import is_template
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.pattern import paths_of
from mjcompose.tree.values import may_be_angle

MASS = "mass"
Fitting: TypeAlias = Sequence[tuple[str, Attribute]]
"""The attributes that a value may be for, each with the tag of its element."""


class Checker(Struct, frozen=False):
    """Checks the values of `set` and `scale`, and drawn values; with `bare_angles`, angles need no unit."""

    bare_angles: bool
    faults: list[Fault]

    def attributes(
        self, verb: str, value: Mapping[str, Any], tag: str, at: Path, kinds: tuple[ElementType, ...] | None = None
    ) -> None:
        """Check the values of a verb for elements with a tag, if known; with `offset`, draws add these numbers."""
        if kinds is None:
            kinds = kinds_of(tag) if tag else ()
        if verb == "set":
            self._one_orientation(value, tag, at=at)
        for name, item in value.items():
            path = (*at, name)
            if item is None:
                self._nothing(verb, name, kinds, tag=tag, at=path)
                continue
            below = tuple(kind.children[name] for kind in kinds if name in kind.children)
            if isinstance(item, dict) and (below or not kinds):
                if not item:
                    message = f"`{name}` of `{verb}` is empty"
                    self.faults.append(Fault("wrong-type", message, path, help="write an attribute and its value"))
                self.attributes(verb, item, name, at=path, kinds=below)
            else:
                self._attribute(verb, name, item, kinds, tag=tag, at=path)

    def _one_orientation(self, value: Mapping[str, Any], tag: str, at: Path) -> None:
        turned = [name for name in value if name in ORIENTATIONS and value[name] is not None]
        if len(turned) > 1:
            message = f"`{tag}` can have one orientation, and there are `{turned[0]}` and `{turned[1]}`"
            help = f"leave `{turned[0]}` or `{turned[1]}` out"
            self.faults.append(Fault(EXCLUSIVE, message, (*at, turned[1]), key=True, help=help))

    def _attribute(self, verb: str, name: str, item: Any, kinds: tuple[ElementType, ...], tag: str, at: Path) -> None:
        """Check the value of one attribute, which `name` may give with an index."""
        attribute, index = attribute_and_index(name)
        if any(kind.path == "body" for kind in kinds) and name == MASS:
            self._number(item, f"`{MASS}` of `body`", at)
            return
        if attribute == "name" and kinds and kinds[0].path != "default":
            help = "write `rename: …`, which every reference follows"
            self.faults.append(Fault("unknown-key", f"`{verb}` cannot change a name", at, key=True, help=help))
            return
        fitting = [(kind.tag, kind.attributes[attribute]) for kind in kinds if attribute in kind.attributes]
        if kinds and not fitting:
            self.faults.append(unknown_target(attribute, tag, kinds, at=at))
        else:
            self.value(verb, fitting, index, value=item, tag=tag, at=at)

    def _nothing(self, verb: str, name: str, kinds: tuple[ElementType, ...], tag: str, at: Path) -> None:
        fitting = [kind.attributes[name] for kind in kinds if name in kind.attributes]
        if verb != "set":
            self.faults.append(Fault("wrong-type", f"`{name}` has no value", at))
        elif name == "name" and fitting:
            help = "write `rename: …` for another name"
            self.faults.append(Fault("unknown-key", "`set` cannot remove a name", at, key=True, help=help))
        elif attribute_and_index(name)[1] is not None:
            message = f"one number of `{attribute_and_index(name)[0]}` cannot be removed"
            help = "write the numbers that stay"
            self.faults.append(Fault("wrong-type", message, at, help=help))
        elif kinds and not fitting and any(name in kind.children for kind in kinds):
            self.faults.append(unknown_target(name, tag, kinds, at=at))
        elif fitting and all(attribute.required for attribute in fitting):
            message = f"`{name}` of `{tag}` is required"
            self.faults.append(Fault("missing-key", message, at, help="write another value"))

    def value(self, verb: str, fitting: Fitting, index: int | None, value: Any, tag: str, at: Path) -> None:
        """Check one value for the attributes that it may set, with the tags of their elements."""
        subject = f"`{tag}`"
        if not self._templates(value, at):
            return
        if index is not None or verb != "set":
            self._arithmetic(verb, fitting, index, value=value, tag=tag, at=at)
            return
        if isinstance(value, dict):
            self.faults.append(Fault("wrong-type", f"`{at[-1]}` of {subject} expects a value, got a mapping", at))
            return
        tried: list[list[Fault]] = []
        for own_tag, attribute in fitting:
            sample = _sample(attribute, value)
            if sample is None:
                return
            found: list[Fault] = []
            read = read_value(attribute, sample, at, owner=subject, faults=found, tag=own_tag)
            if read is not None and not found and sample == value and not self.bare_angles:
                bare = bare_angle(attribute, read, None, at=at, owner=subject)
                found += [bare] if bare is not None else []
            if not found:
                return
            tried.append(found)
        self.faults += tried[0] if tried else []

    def _arithmetic(self, verb: str, fitting: Fitting, index: int | None, value: Any, tag: str, at: Path) -> None:
        subject = f"`{at[-1]}` of `{tag}`"
        numeric = [attribute for _, attribute in fitting if attribute.is_number]
        takes_angles = not fitting or any(may_be_angle(own_tag, attribute) for own_tag, attribute in fitting)
        if fitting and not numeric:
            message = f"{subject} is not a number, which `{verb}` needs"
            if index is not None:
                message = f"`{fitting[0][1].name}` of `{tag}` has no numbers that could be counted"
            self.faults.append(Fault("wrong-type", message, at, key=True))
            return
        most = _most_numbers(numeric)
        if index is not None and most is not None and index >= most:
            message = f"{subject} does not exist: `{numeric[0].name}` has {most} number{'s' * (most != 1)}"
            self.faults.append(Fault("wrong-length", message, at, key=True, help="the first number is `[0]`"))
            return
        if not isinstance(value, list) or index is not None:
            self._amount(verb, value, subject, at, takes_angles=takes_angles)
            return
        if most is not None and len(value) > most:
            self.faults.append(Fault("wrong-length", f"{subject} has {most} numbers, got {len(value)}", at))
        for position, item in enumerate(value):
            self._amount(verb, item, subject, (*at, position), takes_angles=takes_angles)

    def _amount(self, verb: str, value: Any, subject: str, at: Path, takes_angles: bool) -> None:
        angle = Angle.read(value) if isinstance(value, str) and verb != "scale" else None
        if angle is None:
            self._number(value, subject, at)
        elif not takes_angles:
            self.faults.append(no_angle(subject, angle, at))

    def _number(self, value: Any, subject: str, at: Path) -> None:
        if isinstance(value, str) and is_template(value):
            check_template(value, at, self.faults)
            return
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.faults.append(Fault("wrong-type", f"{subject} expects a number, got {kind_of(value)}", at))

    def _templates(self, value: Any, at: Path) -> bool:
        if isinstance(value, list):
            sound = [self._templates(item, (*at, index)) for index, item in enumerate(value)]
            return all(sound)
        if isinstance(value, str) and is_template(value):
            return check_template(value, at, self.faults) is not None
        return True


def unknown_target(name: str, tag: str, kinds: Sequence[ElementType], at: Path) -> Fault:
    """Return the fault of a name that is not an attribute of the selected elements."""
    if all(kind.path == "default" or kind.tag == "default" for kind in kinds):
        known = [child for child in kinds[0].children if child != "default"]
        near = closest(name, known)
        help = f"write the tag first: `{{{near[0] if near and name in known else 'geom'}: {{…}}}}`"
        message = f"`{name}` is not a tag that a class can have settings for"
        return Fault("unknown-element", message, at, key=True, help=help)
    return unknown_attribute(name, tag, tuple(kinds), at=at)


def _most_numbers(attributes: Sequence[Attribute]) -> int | None:
    """Return how many numbers the longest of these attributes has at most; None if one has no limit."""
    lengths = [attribute.max_length for attribute in attributes]
    bounded = [length for length in lengths if length is not None]
    return max(bounded, default=None) if len(bounded) == len(lengths) else None


def _sample(attribute: Attribute, value: Any) -> Any:
    """Return a value of the same form without `${…}`, or None if only the model determines whether it fits."""
    if isinstance(value, list):
        items = [1 if _computed(item) and attribute.is_number else item for item in value]
        return None if any(map(_computed, items)) else items
    return None if _computed(value) else value


def _computed(value: Any) -> bool:
    return isinstance(value, str) and is_template(value)


Changed: TypeAlias = Iterable[tuple[str | None, str]]
"""Attributes, each with its tag, or None if the selector has no tag."""


class Values(ByGrammar):
    """The values that `set` or `scale` gives to attributes; for a class or a section, they are in mappings."""

    def __init__(self, verb: str) -> None:
        self.verb = verb

    def schema(self) -> Schema:
        return {"type": "object", "minProperties": 1}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> dict[str, Any]:
        if isinstance(value, dict) and value:
            tag = settings.selected.tag if settings.selected is not None else ""
            Checker(settings.bare_angles, faults).attributes(self.verb, value, tag, at=())
            return dict(value)
        message = f"{IT} expects a mapping, got {kind_of(value) if value != {} else 'an empty one'}"
        faults.append(Fault("wrong-type", message, help=f"write `{self.verb}: {{ATTRIBUTE: VALUE}}`"))
        return {}


def flat(written: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Yield the values of a mapping and of mappings inside it, by their paths."""
    for name, value in written.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{above}{name}.")
        else:
            yield above + name, "null" if value is None else value_text(value)


_CLASSES = "default"


def changes_of(tag: str | None, value: Mapping[str, Any]) -> Changed:
    """Yield the attributes to which values are given, if the selector has that tag."""
    for name, each in value.items():
        if isinstance(each, Mapping):  # of a class or of a section
            yield from ((name, attribute_and_index(inner)[0]) for inner in each)
        else:
            yield tag, attribute_and_index(name)[0]


# The tags that people edit. Each further one makes the schema longer.
TAGS = (
    "body",
    "frame",
    "geom",
    "site",
    "joint",
    "freejoint",
    "camera",
    "light",
    "inertial",
    "mesh",
    "material",
    "texture",
    "hfield",
    "skin",
    "exclude",
    "pair",
    "actuator",
    "equality",
    "tendon",
    "sensor",
)


_REMOVED: Schema = {
    "type": "null",
    "errorMessage": "not an attribute of these elements; only `null` is allowed, which removes it from a source",
}
"""The value of an attribute that MJCF does not have: an edit may remove it from a file that has it."""


@definition("of")
def _definition_of_classes(kind: str) -> Schema:
    rows = {
        tag: {**reference(f"{kind}:{tag}"), "description": f"the class's value of `{tag}`"}
        for tag in GRAMMAR.section(_CLASSES).children
        if tag != _CLASSES
    }
    return {"properties": rows, "additionalProperties": _REMOVED if kind == "settable" else False}


@definition("settable")
def settable(tag: str) -> Schema:
    """Return the schema of a mapping from a tag's attributes, or numbers of them, to values; null removes one."""
    found: dict[str, Schema] = {}
    for name, attributes in attributes_of(tag).items():
        schemas = [attribute_schema(each, own_tag) for own_tag, each in attributes]
        same = all({**each, "description": ""} == {**schemas[0], "description": ""} for each in schemas)
        found[name] = schemas[0] if same else {"description": schemas[0].get("description", "")}
        if not all(each.required for _, each in attributes):
            found[name] = _or_null(found[name])
    return {**_numbered(tag, found, reference("number")), "additionalProperties": _REMOVED}


def _or_null(schema: Schema) -> Schema:
    """Return the schema that also allows null, as one more type instead of an alternative if possible."""
    if REFERENCE in schema:
        return {**schema, **reference(f"null:{schema[REFERENCE]}")}
    if "type" in schema:
        return {**schema, "type": [*(schema["type"] if isinstance(schema["type"], list) else [schema["type"]]), "null"]}
    # Not one alternative more: an editor can explain only few.
    inner = {key: each for key, each in schema.items() if key != "description"}
    about = {key: each for key, each in schema.items() if key == "description"}
    return {"if": {"type": "null"}, "else": inner, **about} if inner else schema


definition("null")(lambda name: _or_null(define(name)))


@definition("scalable")
def scalable(tag: str) -> Schema:
    """Return the schema of a mapping from attributes that are numbers to factors or offsets."""
    found = {
        name: {**reference("amount"), "description": attributes[0][1].doc}
        for name, attributes in attributes_of(tag).items()
        if any(each.is_number for _, each in attributes)
    }
    return _numbered(tag, found, reference("amount"))


def _numbered(tag: str, properties: dict[str, Schema], number: Schema) -> Schema:
    if tag == "body":
        properties[MASS] = {**reference("number"), "description": "the body's whole inertia, in proportion"}
    several = [
        name
        for name, attributes in attributes_of(tag).items()
        if any(each.is_number and each.max_length != 1 for _, each in attributes)
    ]
    schema: Schema = {"type": "object", "properties": properties, "additionalProperties": False, "minProperties": 1}
    if several:
        schema["patternProperties"] = {rf"^({'|'.join(several)})\[[0-9]+\]$": number}
    return schema


def attributes_of(tag: str) -> dict[str, list[tuple[str, Attribute]]]:
    """Return the attributes of all elements that a tag covers, except for names, which `rename` changes."""
    found: dict[str, list[tuple[str, Attribute]]] = {}
    for path in sorted(paths_of(tag)):
        kind = GRAMMAR.element(path)
        for each in kind.attributes.values():
            if each.name != "name":
                found.setdefault(each.name, []).append((kind.tag, each))
    return found


@definition("amount")
def amount(_: str) -> Schema:
    """Return the schema of a number, a list of them, or an expression of `${value}`."""
    return {
        "type": ["number", "string", "array"],
        "pattern": TEMPLATE_PATTERN,
        "items": reference("number"),
        "patternErrorMessage": "expected a number, a list of numbers, or ${…}",
    }

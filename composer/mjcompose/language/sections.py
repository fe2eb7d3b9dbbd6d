"""Sections of MJCF in a recipe, which the grammar reads inside a pydantic model.

Each form of section annotates a field of the recipe: `sensor: Annotated[tuple[Element, ...], Typed("sensor")]`.
Therefore 170 kinds of elements have types without 170 models.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema, core_schema

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import advised, closest, exists_note, renaming
from mjcompose.language.element import FRAGMENT, NAME, Reader, path_of
from mjcompose.language.element_schema import by_name, described, element, mapping, nameless, unless_fragment
from mjcompose.language.forms.context import (
    ELSEWHERE,
    ByGrammar,
    Lazy,
    Schema,
    Settings,
    computable,
    definition,
    reference,
    validated,
)
from mjcompose.language.forms.translate import faults
from mjcompose.language.fragment import missing_key
from mjcompose.language.value import EXCLUSIVE, RecipeElement, exclusive, kind_of, read_value
from mjcompose.tree.grammar import GRAMMAR, ElementType


@dataclass(frozen=True, slots=True)
class Section(ByGrammar):
    """The base class of all forms of sections."""

    tag: str
    first: ClassVar[tuple[str, ...]] = ()
    """The keys of an entry that `fmt` writes first."""
    depth: ClassVar[int] = 1
    """How far below the recipe its entries are, each of which can have `when`."""

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        return self.content(Reader(settings, faults), value)

    @abstractmethod
    def content(self, reader: Reader, value: Any) -> Any:
        """Return the content of the section. Faults are added to the reader."""

    @property
    def kind(self) -> ElementType:
        return GRAMMAR.section(self.tag)

    def tags(self, reader: Reader, value: Any) -> list[tuple[ElementType, Any, Path]]:
        """Return the entries of a mapping from tags to elements."""
        if not isinstance(value, dict):
            message = f"`{self.tag}` expects a mapping from tags to elements, got {kind_of(value)}"
            help = "write the tag as a key: `TAG: …`, not as an item of a list" if isinstance(value, list) else None
            reader.faults.append(Fault("wrong-type", message, help=help))
            return []
        known: list[tuple[ElementType, Any, Path]] = []
        for tag, item in value.items():
            if tag in self.kind.children:
                known.append((self.kind.children[tag], item, (tag,)))
            else:
                reader.faults.append(self.unknown(tag, (tag,), f"`{self.tag}` has no element `{tag}`", key=True))
        return known

    def unknown(self, tag: str, at: Path, message: str, key: bool) -> Fault:
        """Return the fault of a tag that the section does not have."""
        help, fix = advised(tag, self.kind.children)
        note = exists_note(f"{self.tag} element", self.kind.children, tag)
        return Fault("unknown-element", message, at, key=key, notes=(note,), help=help, fix=fix)


@dataclass(frozen=True, slots=True)
class Elements(Section):
    """Base class of sections that are read as a tuple of `RecipeElement`, each appended to the section of the model."""


@dataclass(frozen=True, slots=True)
class ByTag(Elements):
    """Form of a mapping from tags to names to elements, a tuple of `RecipeElement`: `asset`, `custom`, `deformable`."""

    depth = 3

    def content(self, reader: Reader, value: Any) -> tuple[RecipeElement, ...]:
        read = (
            self.element(reader, kind, name, value=item, at=(*at, name))
            for kind, items, at in self.tags(reader, value)
            for name, item in reader.names(items, at, f"`{kind.tag}` in `{self.tag}`")
        )
        return tuple(filter(None, read))

    def schema(self) -> Schema:
        kinds = self.kind.children.values()
        return mapping({kind.tag: described(by_name(reference(f"named:{kind.path}")), kind.doc) for kind in kinds})

    def element(self, reader: Reader, kind: ElementType, name: str, value: Any, at: Path) -> RecipeElement | None:
        owner = f"{kind.tag} `{name}`"
        keyed = reader.keyed([kind], name, value, at=at, owner=owner)
        return reader.element(kind, value, at, owner, keyed=keyed, own=() if keyed else (NAME,))


TERRAIN = "terrain"


@dataclass(frozen=True, slots=True)
class Assets(ByTag):
    """Form of `asset`, in which a height field can be a terrain: `hfield: {ground: {terrain: {kind: stairs}}}`."""

    form: ClassVar = Lazy("mjcompose.language.terrain:Terrain")

    def element(self, reader: Reader, kind: ElementType, name: str, value: Any, at: Path) -> RecipeElement | None:
        if kind.tag != "hfield" or not isinstance(value, dict):
            return ByTag.element(self, reader, kind, name, value, at=at)
        if TERRAIN in value:
            return self._terrain(reader, kind, name, value, at)
        known = (*kind.attributes, FRAGMENT)
        meant = next((key for key in value if key not in known and closest(key, [TERRAIN])), None)
        if meant is None:
            return ByTag.element(self, reader, kind, name, value, at=at)
        message = f"hfield `{name}` has no key `{meant}`"
        fix = renaming(meant, [TERRAIN])
        fault = Fault("unknown-key", message, (*at, meant), key=True, help=f"write `{TERRAIN}`", fix=fix)
        reader.faults.append(fault)
        return None

    def _terrain(
        self, reader: Reader, kind: ElementType, name: str, value: dict[str, Any], at: Path
    ) -> RecipeElement | None:
        for key in value:
            if key != TERRAIN:
                message = f"`{key}` is next to `{TERRAIN}`, which is the whole height field"
                reader.faults.append(exclusive(message, (TERRAIN, key), at, help=f"remove `{key}` or `{TERRAIN}`"))
        written = value[TERRAIN]
        try:
            terrain = validated(self.form.form, written, reader.settings)
        except ValidationError as error:
            reader.faults += faults(error, self.form.form, written, start=(*at, TERRAIN))
            return None
        return RecipeElement(kind.tag, {NAME: name}, at=path_of(value), terrain=terrain)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate, metadata={ELSEWHERE: self.form})

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        found = self.schema()
        kind = self.kind.children["hfield"]
        usual = element(kind, (NAME,), {**nameless(), TERRAIN: handler(schema)})
        rules = {key: usual.pop(key) for key in ("if", "then", "else") if key in usual}
        alone = {"if": {"required": [TERRAIN]}, "then": {"maxProperties": 1}, "else": rules}
        found["properties"][kind.tag] = described(by_name({**usual, **alone}), kind.doc)
        return found


@dataclass(frozen=True, slots=True)
class Singleton(Section):
    """Form of a section that is one `RecipeElement` with attributes and children, or with only the `settable` ones."""

    settable: frozenset[str] = frozenset()

    def content(self, reader: Reader, value: Any) -> RecipeElement | None:
        if self.settable and isinstance(value, dict):
            kind = self.kind
            value = dict(value)
            for name in [n for n in value if n not in self.settable and (n in kind.attributes or n == FRAGMENT)]:
                reader.faults.append(self._unsettable(name))
                del value[name]
        return reader.element(self.kind, value, (), f"`{self.tag}`")

    def schema(self) -> Schema:
        schema = element(self.kind)
        if self.settable:
            schema["properties"] = {name: each for name, each in schema["properties"].items() if name in self.settable}
        return schema

    def _unsettable(self, name: str) -> Fault:
        message = f"`{name}` cannot be set in `{self.tag}`: each part keeps its own"
        notes = (Note(f"settings: {', '.join(sorted(self.settable))}"),)
        help = f"leave `{name}` out"
        if name in ("angle", "eulerseq"):
            help = f"for the recipe's own elements, write `{name}` at the top of the recipe"
        return Fault("compiler-setting", message, (name,), key=True, notes=notes, help=help)


@dataclass(frozen=True, slots=True)
class PluginForm(ByTag):
    """Form of plugins and instances: `plugin: {mujoco.sdf.torus: {instance: {small: {config: {radius1: 0.3}}}}}`."""

    def schema(self) -> Schema:
        kind = self.kind.children["plugin"]
        instance = kind.children["instance"]
        instances = {"instance": described(by_name(reference(f"named:{instance.path}")), instance.doc)}
        return mapping({"plugin": described(by_name(element(kind, keyed=("plugin",), properties=instances)), kind.doc)})

    def element(self, reader: Reader, kind: ElementType, name: str, value: Any, at: Path) -> RecipeElement | None:
        instances: list[RecipeElement] = []
        if isinstance(value, dict) and "instance" in value:
            below = (*at, "instance")
            for each, item in reader.names(value["instance"], below, f"`instance` of plugin `{name}`"):
                instance = reader.element(
                    kind.children["instance"], item, (*below, each), f"instance `{each}`", keyed={"name": each}
                )
                instances += [instance] if instance is not None else []
        owner = f"{kind.tag} `{name}`"
        keyed = {"plugin": name}
        return reader.element(kind, value, at, owner, keyed=keyed, own=("instance",), children=tuple(instances))


PARENT = "parent"


class RecipeClass(Struct):
    """A default class: `element` is its `<default>`, at `locate(node, element.at, key=True)`; `parent` as written."""

    name: str
    parent: str | None
    element: RecipeElement


@dataclass(frozen=True, slots=True)
class Defaults(Section):
    """Form of a mapping from classes to settings by tag: `finger: {parent: collision, geom: {friction: 1}}`."""

    first = ("parent",)
    depth = 2

    def content(self, reader: Reader, value: Any) -> tuple[RecipeClass, ...]:
        entries = reader.names(value, (), "`default`")
        return tuple(filter(None, (self._class(reader, name, item) for name, item in entries)))

    def schema(self) -> Schema:
        return by_name(reference("class"))

    def _class(self, reader: Reader, name: str, value: Any) -> RecipeClass | None:
        owner = f"class `{name}`"
        if not isinstance(value, dict):
            message = f"{owner} expects a mapping from tags to settings, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, (name,)))
            return None
        parent: str | None = None
        rows: list[RecipeElement] = []
        for tag, item in value.items():
            at = (name, tag)
            if tag == PARENT:
                parent = self._parent(reader, name, item, at=at)
            elif tag == self.tag:
                help = "write the class next to this one, with `parent`"
                message = f"a class cannot stand in {owner}"
                reader.faults.append(Fault("unknown-element", message, at, key=True, help=help))
            elif tag in self.kind.children:
                row = reader.element(self.kind.children[tag], item, at, f"`{tag}` of {owner}")
                rows += [row] if row is not None else []
            else:
                reader.faults.append(self._unknown_row(tag, name, at))
        return RecipeClass(name, parent, RecipeElement(self.tag, children=tuple(rows), at=path_of(value)))

    def _parent(self, reader: Reader, name: str, value: Any, at: Path) -> str | None:
        if not isinstance(value, str) or not value:
            message = f"`parent` of class `{name}` expects the name of a class, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, at))
            return None
        if name == "main":
            message = "`main` is the top class and has no parent"
            reader.faults.append(Fault("class-clash", message, at, key=True, help="leave `parent` out"))
        elif name == value:
            message = f"class `{name}` is its own parent"
            reader.faults.append(Fault("class-clash", message, at, help="write the name of another class"))
        return value

    def _unknown_row(self, tag: str, name: str, at: Path) -> Fault:
        tags = [each for each in self.kind.children if each != self.tag]
        help, fix = advised(tag, [*tags, "parent"])
        note = exists_note("element", tags, tag)
        if name in tags and help is None:
            help = f"the key is the name of a class; for all elements write `main: {{{name}: {{{tag}: …}}}}`"
        message = f"`{tag}` has no defaults in class `{name}`"
        return Fault("unknown-element", message, at, key=True, notes=(note,), help=help, fix=fix)


@definition("class")
def _definition_of_class(_: str) -> Schema:
    rows = {
        tag: reference(f"element:{row.path}")
        for tag, row in GRAMMAR.section("default").children.items()
        if tag != "default"
    }
    parent = {
        "type": "string",
        "minLength": 1,
        "description": "the class that it descends from; without it, the top class",
    }
    return mapping({PARENT: parent, **rows})


PATH = "path"
# By tag, the key that decides which element a step is, and the attribute that the key gives.
MARKS: dict[str, str] = {"site": "site", "geom": "geom", "pulley": "divisor", "joint": "joint"}


def read_path(reader: Reader, kind: ElementType, value: Any, at: Path, owner: str) -> tuple[RecipeElement, ...]:
    """Return the steps of a tendon.

    They are written as `[{site: a}, {geom: g, sidesite: s}, {pulley: 2}, {site: b}]`, or for a fixed tendon as
    `[{joint: j, coef: 1}]`. `{divisor: 2}` is a pulley too.
    """
    if not isinstance(value, list):
        message = f"`{PATH}` of {owner} expects a list of steps, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=f"write `{PATH}: [{_example(kind)}, …]`"))
        return ()
    if not value:
        reader.faults.append(Fault("wrong-length", f"`{PATH}` of {owner} has no steps", at))
    steps = (_step(reader, kind, item, at=(*at, index), owner=owner) for index, item in enumerate(value))
    return tuple(filter(None, steps))


def _step(reader: Reader, kind: ElementType, value: Any, at: Path, owner: str) -> RecipeElement | None:
    place = f"the `{PATH}` of {owner}"
    if not isinstance(value, dict):
        message = f"a step in {place} is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=f"write for instance `{_example(kind)}`"))
        return None
    if FRAGMENT in value:
        return reader.fragment(kind.children, place, value, at=at)
    if "geom" in value and "site" in value:
        message = f"a step in {place} has both `geom` and `site`, of which only one is allowed"
        help = "write `sidesite` for a site at the side of the geom, or a step of its own for the site"
        reader.faults.append(Fault(EXCLUSIVE, message, (*at, "site"), key=True, help=help))
        return None
    tag = next((tag for tag in kind.children if tag in value), None)
    if tag is None:
        tag = next((tag for tag in kind.children if MARKS[tag] in value), None)
    if tag is None:
        known = ", ".join(f"`{each}`" for each in kind.children)
        message = f"a step in {place} has none of {known}"
        reader.faults.append(Fault("missing-key", message, at, help=f"write for instance `{_example(kind)}`"))
        return None
    if isinstance(value.get(tag), dict):
        nested = value[tag]
        message = f"`{tag}` of a step in {place} expects a name, got {kind_of(nested)}"
        keys = ", ".join(f"{name}: {each}" for name, each in nested.items())
        flat = f"write the step's keys next to one another: `{{{keys}}}`" if nested else None
        reader.faults.append(Fault("wrong-type", message, (*at, tag), help=flat))
        return None
    step = kind.children[tag]
    label = f"the `{tag}` step of {owner}"
    if tag not in value or MARKS[tag] == tag:
        return reader.element(step, value, at, label)
    return _short(reader, step, tag, value=value, at=at, owner=label)


def _short(
    reader: Reader, step: ElementType, tag: str, value: dict[str, Any], at: Path, owner: str
) -> RecipeElement | None:
    """Return a step such as `{pulley: 2}`, in which a tag has the value of its only attribute, or None."""
    for name in value:
        if name != tag:
            fault = reader.unknown(step, name, value[name], at=(*at, name), owner=owner, own=(), taken=value)
            reader.faults.append(fault)
    read = read_value(
        step.attributes[MARKS[tag]], value[tag], (*at, tag), owner=owner, faults=reader.faults, tag=step.tag
    )
    return None if read is None else RecipeElement(tag, {MARKS[tag]: read}, at=path_of(value))


def _example(kind: ElementType) -> str:
    return "{site: NAME}" if "site" in kind.children else "{joint: NAME, coef: 1}"


TYPE = "type"


@dataclass(frozen=True, slots=True)
class Typed(Elements):
    """Form of a mapping from names to elements whose `type` is their tag; a tendon's `path` has its children."""

    first = ("type",)
    depth = 2

    def content(self, reader: Reader, value: Any) -> tuple[RecipeElement, ...]:
        entries = reader.names(value, (), f"`{self.tag}`")
        return tuple(filter(None, (self._element(reader, name, item) for name, item in entries)))

    def schema(self) -> Schema:
        return by_name(reference(f"typed:{self.tag}"))

    def _element(self, reader: Reader, name: str, value: Any) -> RecipeElement | None:
        owner = f"{self.tag} `{name}`"
        if not isinstance(value, dict):
            message = f"{owner} expects a mapping with its `{TYPE}`, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, (name,)))
            return None
        keyed = reader.keyed(self.kind.children.values(), name, value, at=(name,), owner=owner)
        own = () if keyed else (NAME,)
        if FRAGMENT in value:
            return reader.fragment(self.kind.children, f"`{self.tag}`", value, at=(name,), keyed=keyed, own=own)
        tag = value.get(TYPE)
        if TYPE not in value:
            reader.faults.append(self._without_type(name, value))
            return None
        if not isinstance(tag, str):
            message = f"`{TYPE}` of {owner} expects a tag, got {kind_of(tag)}"
            reader.faults.append(Fault("wrong-type", message, (name, TYPE)))
            return None
        kind = self.kind.children.get(tag)
        if kind is None:
            message = f"`{self.tag}` has no type `{tag}`"
            reader.faults.append(self.unknown(tag, (name, TYPE), message, key=False))
            return None
        owner = f"{tag} {owner}"
        if self.tag != "tendon":
            return reader.element(kind, value, (name,), owner, keyed=keyed, own=(TYPE, *own))
        return self._tendon(reader, kind, name, value=value, owner=owner, keyed=keyed)

    def _tendon(
        self, reader: Reader, kind: ElementType, name: str, value: dict[str, Any], owner: str, keyed: Mapping[str, str]
    ) -> RecipeElement | None:
        steps: tuple[RecipeElement, ...] = ()
        if PATH in value:
            steps = read_path(reader, kind, value[PATH], at=(name, PATH), owner=owner)
        elif not any(tag in value for tag in kind.children):
            reader.faults.append(missing_key(owner, PATH, at=(name,)))
        for tag in kind.children:
            if tag in value:
                message = f"`{tag}` of {owner} belongs in its `{PATH}`"
                help = f"write `{PATH}: [{{{tag}: …}}, …]`, in the order of the tendon"
                reader.faults.append(Fault("unknown-key", message, (name, tag), key=True, help=help))
        own = (TYPE, PATH, *kind.children, *(() if keyed else (NAME,)))
        return reader.element(kind, value, (name,), owner, keyed=keyed, own=own, children=steps)

    def _without_type(self, name: str, value: dict[str, Any]) -> Fault:
        meant = next((key for key in value if closest(key, [TYPE])), None)
        if meant is not None:
            message = f"{self.tag} `{name}` has no key `{meant}`"
            return Fault(
                "unknown-key", message, (name, meant), key=True, help=f"write `{TYPE}`", fix=renaming(meant, [TYPE])
            )
        inner = next((tag for tag in value if tag in self.kind.children and isinstance(value[tag], dict)), None)
        return Fault(
            "missing-key",
            f"{self.tag} `{name}` lacks `{TYPE}`",
            (name,),
            key=True,
            notes=(exists_note("type", self.kind.children),),
            help=f"write `{name}: {{{TYPE}: {inner}, …}}`" if inner else f"write the MJCF tag as its `{TYPE}`",
            lacks=TYPE,
        )


@definition("typed")
def _definition_of_typed(tag: str) -> Schema:
    kinds = GRAMMAR.section(tag).children.values()
    variants: list[Schema] = [
        {
            "if": {"properties": {TYPE: {"const": each.tag}}, "required": [TYPE]},
            "then": reference(f"variant:{each.path}"),
        }
        for each in kinds
    ]
    types = computable(
        {
            "enum": [kind.tag for kind in kinds],
            "markdownEnumDescriptions": [kind.doc for kind in kinds],
            "description": f"which {tag} it is: the tag of MJCF",
        }
    )
    return {
        "type": "object",
        "properties": {TYPE: types, FRAGMENT: reference("fragment"), **nameless()},
        **unless_fragment({"required": [TYPE]}, nameless()),
        "allOf": variants,
    }


@definition("variant")
def _definition_of_variant(path: str) -> Schema:
    kind = GRAMMAR.element(path)
    properties: dict[str, Schema] = {TYPE: {"const": kind.tag, "description": kind.doc}, **nameless()}
    if kind.path.startswith("tendon/"):
        steps = {
            "type": "array",
            "minItems": 1,
            "items": reference(f"step:{kind.path}"),
            "description": "its elements, in order: " + ", ".join(f"`{{{tag}: …}}`" for tag in kind.children),
        }
        return element(kind, (NAME,), {**properties, PATH: steps}, required=(PATH,), fragment=False, children=False)
    return element(kind, (NAME,), properties, fragment=False)


@definition("step")
def _definition_of_step(path: str) -> Schema:
    kind = GRAMMAR.element(path)
    properties: dict[str, Schema] = {FRAGMENT: reference("fragment")}
    schema: Schema = {"required": [next(iter(kind.children))]}
    for tag, child in reversed(list(kind.children.items())):
        mark = MARKS[tag]
        step = element(child, fragment=False)
        properties |= step["properties"]
        schema = {"if": {"required": [mark]}, "then": step, "else": schema}
        if mark != tag:
            properties[tag] = step["properties"][mark]
            schema = {"if": {"required": [tag]}, "then": mapping({tag: properties[tag]}), "else": schema}
    schema = {"if": {"required": [FRAGMENT]}, "then": {"maxProperties": 1}, "else": schema}
    return {"type": "object", "properties": properties, **schema}

"""Sections whose elements have a `type`: `sensor`, `actuator`, `equality`, `tendon`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest, exists_note, renaming
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.recipe.element import Element
from composer.recipe.element_schema import by_name, element, mapping, nameless, unless_fragment
from composer.recipe.fault import Fault
from composer.recipe.presence import missing_key
from composer.recipe.reader import FRAGMENT, NAME, Reader
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.section import Elements
from composer.recipe.shown import kind_of
from composer.recipe.tendon import MARKS, PATH, read_path

TYPE = "type"


@dataclass(frozen=True, slots=True)
class Typed(Elements):
    """Form of a mapping from names to elements whose `type` is their tag: `sensor`, `actuator`, `equality`, `tendon`.

    It is read as a tuple of `Element`, each with its name as an attribute. The steps of a tendon's `path` are its
    children.
    """

    def content(self, reader: Reader, value: Any) -> tuple[Element, ...]:
        entries = reader.names(value, (), f"`{self.tag}`")
        read = [self._element(reader, name, item) for name, item in entries]
        return tuple(element for element in read if element is not None)

    def schema(self) -> Schema:
        return by_name(reference(f"typed:{self.tag}"))

    def _element(self, reader: Reader, name: str, value: Any) -> Element | None:
        owner = f"{self.tag} `{name}`"
        if not isinstance(value, dict):
            message = f"{owner} expects a mapping with its `{TYPE}`, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, (name,)))
            return None
        keyed = reader.keyed(self.kind.children.values(), name, value, at=(name,), owner=owner)
        own = () if keyed else (NAME,)
        if FRAGMENT in value:
            return reader.fragment(
                self.kind.children, f"`{self.tag}`", value, at=(name,), keyed=keyed, own=own
            )
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
        self,
        reader: Reader,
        kind: ElementType,
        name: str,
        value: dict[str, Any],
        owner: str,
        keyed: Mapping[str, str],
    ) -> Element | None:
        steps: tuple[Element, ...] = ()
        if PATH in value:
            steps = read_path(reader, kind, value[PATH], at=(name, PATH), owner=owner)
        elif not any(tag in value for tag in kind.children):
            reader.faults.append(missing_key(owner, PATH, (name,)))
        for tag in kind.children:
            if tag in value:
                message = f"`{tag}` of {owner} belongs into its `{PATH}`"
                help = f"write `{PATH}: [{{{tag}: …}}, …]`, in the order of the tendon"
                reader.faults.append(Fault("unknown-key", message, (name, tag), key=True, help=help))
        own = (TYPE, PATH, *kind.children, *(() if keyed else (NAME,)))
        return reader.element(kind, value, (name,), owner, keyed=keyed, own=own, children=steps)

    def _without_type(self, name: str, value: dict[str, Any]) -> Fault:
        meant = next((key for key in value if closest(key, [TYPE])), None)
        if meant is not None:
            message = f"{self.tag} `{name}` has no key `{meant}`"
            return Fault("unknown-key", message, (name, meant), key=True, help=f"write `{TYPE}`",
                         fix=renaming(meant, [TYPE]))  # fmt: skip
        inner = next(
            (tag for tag in value if tag in self.kind.children and isinstance(value[tag], dict)), None
        )
        return Fault(
            "missing-key",
            f"{self.tag} `{name}` lacks `{TYPE}`",
            (name,),
            key=True,
            notes=(exists_note("type", self.kind.children),),
            help=f"write `{name}: {{{TYPE}: {inner}, …}}`"
            if inner
            else f"write the MJCF tag as its `{TYPE}`",
            lacks=TYPE,
        )


@definition("typed")
def _definition_of_typed(tag: str) -> Schema:
    """Return the schema of an element whose `type` says what it is."""
    kinds = GRAMMAR.section(tag).children.values()
    variants: list[Schema] = [
        {
            "if": {"properties": {TYPE: {"const": kind.tag}}, "required": [TYPE]},
            "then": reference(f"variant:{kind.path}"),
        }
        for kind in kinds
    ]
    return {
        "type": "object",
        "properties": {TYPE: _types(tag, kinds), FRAGMENT: reference("fragment"), **nameless()},
        **unless_fragment({"required": [TYPE]}, nameless()),
        "allOf": variants,
    }


def _types(tag: str, kinds: Iterable[ElementType]) -> Schema:
    """Return the schema of the key `type`, with an explanation for each value."""
    return {
        "enum": [kind.tag for kind in kinds],
        "markdownEnumDescriptions": [kind.doc for kind in kinds],
        "description": f"which {tag} it is: the tag of MJCF",
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
            "description": "what it goes over, in order: "
            + ", ".join(f"`{{{tag}: …}}`" for tag in kind.children),
        }
        return element(
            kind, (NAME,), {**properties, PATH: steps}, required=(PATH,), fragment=False, children=False
        )
    return element(kind, (NAME,), properties, fragment=False)


@definition("step")
def _definition_of_step(path: str) -> Schema:
    """Return the schema of a step of a tendon's path, whose keys say which element it is."""
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
            short = mapping({tag: properties[tag]})
            schema = {"if": {"required": [tag]}, "then": short, "else": schema}
    schema = {"if": {"required": [FRAGMENT]}, "then": {"maxProperties": 1}, "else": schema}
    return {"type": "object", "properties": properties, **schema}

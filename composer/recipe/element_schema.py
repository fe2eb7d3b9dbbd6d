"""JSON Schema of MJCF's elements, from the grammar.

Schemas point at one another with `{REFERENCE: NAME}`, which `define` makes the schema of: `element:geom`,
`named:mesh`, `number`. Only what is asked for is made. Editors show errors best where there are few
alternatives, so choices are made with `if` and `then` wherever something in the value tells what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from composer.grammar import GRAMMAR
from composer.grammar.element import Constraint, ElementType
from composer.recipe.attribute_schema import attribute_schema, shared
from composer.recipe.edit_schema import dropped, edit, selector
from composer.recipe.keyframe import FROM, TIME, VECTORS, WIDTHS
from composer.recipe.randomize_schema import distribution
from composer.recipe.randomize_schema import field as draw_field
from composer.recipe.reader import CONFIG, FRAGMENT, NAME
from composer.recipe.recipe import SETTABLE
from composer.recipe.reference import Schema, reference
from composer.recipe.replicate import ATTRIBUTES, COUNT
from composer.recipe.settable_schema import AMOUNT, scalable, settable
from composer.recipe.tendon import MARKS, PATH
from composer.recipe.typed import TYPE


def define(name: str) -> Schema:
    """The schema that a reference leads to."""
    kind, _, rest = name.partition(":")
    return _DEFINITIONS[kind](rest) if kind in _DEFINITIONS else shared(kind)


def section(form: str, tag: str) -> Schema:
    """A section of the recipe, by the way in which it is written."""
    return _FORMS[form](tag)


def attribute(path: str, name: str) -> Schema:
    """One attribute of an element."""
    return attribute_schema(GRAMMAR.element(path).attributes[name])


def additions() -> Schema:
    """The list `add`."""
    return {"type": "array", "items": reference("addition")}


def axes() -> Schema:
    """The list `replicate`."""
    kind = GRAMMAR.element("replicate")
    axis = _object({name: attribute_schema(kind.attributes[name]) for name in ATTRIBUTES})
    return {"type": "array", "minItems": 1, "items": {**axis, "required": [COUNT]}}


def joint(words: Sequence[str], types: Sequence[str]) -> Schema:
    """What stands between a part and its place."""
    kind = {"enum": [*types], "description": GRAMMAR.element("joint").attributes[TYPE].doc}
    one = {**reference("element:joint"), "properties": {TYPE: kind}}
    return {
        "anyOf": [
            {"enum": [*words]},
            {"type": "object", **one},
            {"type": "array", "minItems": 1, "items": {**one, "required": ["name"]}},
        ]
    }


def at_most_one(names: Iterable[str]) -> list[Schema]:
    """That of some keys only one may stand."""
    return _rule(Constraint("exclusive", tuple((name,) for name in names)))


def _typed(tag: str) -> Schema:
    return _named_map(reference(f"typed:{tag}"))


def _named(tag: str) -> Schema:
    kinds = GRAMMAR.section(tag).children.values()
    return _object({kind.tag: _told(_named_map(reference(f"named:{kind.path}")), kind.doc) for kind in kinds})


def _lists(tag: str) -> Schema:
    kinds = GRAMMAR.section(tag).children.values()
    return _object(
        {
            kind.tag: _told({"type": "array", "items": reference(f"element:{kind.path}")}, kind.doc)
            for kind in kinds
        }
    )


def _extension(tag: str) -> Schema:
    kind = GRAMMAR.section(tag).children["plugin"]
    instance = kind.children["instance"]
    instances = {"instance": _told(_named_map(reference(f"named:{instance.path}")), instance.doc)}
    plugins = _named_map(_element(kind, keyed=("plugin",), properties=instances))
    return _object({"plugin": _told(plugins, kind.doc)})


def _keyframes(tag: str) -> Schema:
    key = GRAMMAR.section(tag).children["key"]
    sources = {
        **_named_map({"type": "string", "minLength": 1}),
        "description": "a key of each part to start from, by the path of the part: `base`, `left`, `left/gripper`",
    }
    entries = {
        vector: {
            **_named_map(reference(f"number-{WIDTHS[vector]}" if vector in WIDTHS else "number-1-")),
            "description": f"{key.attributes[vector].doc}: a mapping by {named}",
        }
        for vector, named in VECTORS.items()
    }
    return _named_map(_object({FROM: sources, TIME: attribute_schema(key.attributes[TIME]), **entries}))


def _singleton(tag: str) -> Schema:
    schema = _element(GRAMMAR.section(tag))
    if tag == "compiler":
        schema["properties"] = {name: each for name, each in schema["properties"].items() if name in SETTABLE}
    return schema


def _definition_of_element(path: str) -> Schema:
    return _element(GRAMMAR.element(path))


def _definition_of_named(path: str) -> Schema:
    kind = GRAMMAR.element(path)
    return _element(kind, (NAME,), {} if kind.attributes[NAME].required else _nameless())


def _definition_of_typed(tag: str) -> Schema:
    """An element whose `type` tells which one it is."""
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
        "properties": {TYPE: _types(tag, kinds), FRAGMENT: reference("fragment"), **_nameless()},
        **_unless_fragment({"required": [TYPE]}, _nameless()),
        "allOf": variants,
    }


def _types(tag: str, kinds: Iterable[ElementType]) -> Schema:
    """The key `type`, each of whose values is explained."""
    return {
        "enum": [kind.tag for kind in kinds],
        "markdownEnumDescriptions": [kind.doc for kind in kinds],
        "description": f"which {tag} it is: the tag of MJCF",
    }


def _definition_of_variant(path: str) -> Schema:
    kind = GRAMMAR.element(path)
    properties: dict[str, Schema] = {TYPE: {"const": kind.tag, "description": kind.doc}, **_nameless()}
    if kind.path.startswith("tendon/"):
        steps = {
            "type": "array",
            "minItems": 1,
            "items": reference(f"step:{kind.path}"),
            "description": "what it goes over, in order: "
            + ", ".join(f"`{{{tag}: …}}`" for tag in kind.children),
        }
        return _element(kind, (NAME,), {**properties, PATH: steps}, (PATH,), fragment=False, children=False)
    return _element(kind, (NAME,), properties, fragment=False)


def _nameless() -> dict[str, Schema]:
    """What says that the key of an entry is not the name of the element."""
    return {NAME: reference("nameless")}


def _definition_of_step(path: str) -> Schema:
    """A step of a tendon's path; its keys tell which element it is."""
    kind = GRAMMAR.element(path)
    properties: dict[str, Schema] = {FRAGMENT: reference("fragment")}
    schema: Schema = {"required": [next(iter(kind.children))]}
    for tag, child in reversed(list(kind.children.items())):
        mark = MARKS[tag]
        step = _element(child, fragment=False)
        properties |= step["properties"]
        schema = {"if": {"required": [mark]}, "then": step, "else": schema}
        if mark != tag:
            properties[tag] = step["properties"][mark]
            short = _object({tag: properties[tag]})
            schema = {"if": {"required": [tag]}, "then": short, "else": schema}
    schema = {"if": {"required": [FRAGMENT]}, "then": {"maxProperties": 1}, "else": schema}
    return {"type": "object", "properties": properties, **schema}


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
    return _object({"parent": parent, **rows})


def _definition_of_addition(_: str) -> Schema:
    frame = {
        **_object({"frame": {"type": "string", "minLength": 1, "description": "the name of a frame"}}),
        "required": ["frame"],
    }
    target: Schema = {
        "anyOf": [{"type": "string", "minLength": 1}, frame],
        "description": "the name of a body, `world`, or `{frame: NAME}`",
    }
    elements = {
        tag: reference(f"element:{kind.path}") for tag, kind in GRAMMAR.element("body").children.items()
    }
    schema = _object({"to": target, **elements, FRAGMENT: reference("fragment")})
    return {**schema, "required": ["to"], "minProperties": 2, "maxProperties": 2}


_DEFINITIONS: dict[str, Callable[[str], Schema]] = {
    "element": _definition_of_element,
    "named": _definition_of_named,
    "typed": _definition_of_typed,
    "variant": _definition_of_variant,
    "step": _definition_of_step,
    "class": _definition_of_class,
    "addition": _definition_of_addition,
    "nameless": lambda _: {
        "const": "",
        "description": '`""`: the element has no name; the key is not its name',
    },
    "edit": lambda _: edit(),
    "settable": settable,
    "scalable": scalable,
    "amount": lambda _: dict(AMOUNT),
    "selector": lambda _: selector(),
    "dropped": lambda _: dropped(),
    "draw": lambda _: draw_field(),
    "distribution": distribution,
}
_FORMS: dict[str, Callable[[str], Schema]] = {
    "typed": _typed,
    "named": _named,
    "lists": _lists,
    "extension": _extension,
    "singleton": _singleton,
    "keyframes": _keyframes,
    "defaults": lambda _: _named_map(reference("class")),
}


def _element(
    kind: ElementType,
    keyed: Sequence[str] = (),
    properties: dict[str, Schema] | None = None,
    required: Sequence[str] = (),
    fragment: bool = True,
    children: bool = True,
) -> Schema:
    """An element: its attributes, its children and the rules about them; or, where it may, a fragment."""
    known: dict[str, Schema] = dict(properties or {})
    for name, each in kind.attributes.items():
        if name not in keyed:
            known.setdefault(name, attribute_schema(each))
    for tag, child in kind.children.items() if children else ():
        known.setdefault(tag, _settings() if tag == CONFIG else _children(child))
    rules: Schema = {}
    needed = [name for name, each in kind.attributes.items() if each.required and name not in keyed]
    if needed or required:
        rules["required"] = [*required, *needed]
    conditions = [condition for rule in kind.constraints for condition in _rule(rule)]
    if conditions:
        rules["allOf"] = conditions
    description = {"description": kind.doc} if kind.doc else {}
    if not fragment:
        if "required" in rules:
            # Editors offer what has `required` at its top as a whole, under the name of its definition.
            rules["allOf"] = [{"required": rules.pop("required")}, *conditions]
        return {**_object(known), **description, **rules}
    known.setdefault(FRAGMENT, reference("fragment"))
    return {**_object(known), **description, **_unless_fragment(rules, properties or {})}


def _unless_fragment(rules: Schema, beside: Iterable[str] = ()) -> Schema:
    """That a fragment stands alone, but for the keys `beside` it, and that the rules hold where there is none."""
    beside = [name for name in beside if name == NAME]
    then: Schema = {"propertyNames": {"enum": [FRAGMENT, *beside]}} if beside else {"maxProperties": 1}
    alone: Schema = {"if": {"required": [FRAGMENT]}, "then": then}
    return {**alone, "else": rules} if rules else alone


def _children(kind: ElementType) -> Schema:
    """Elements of one tag: one as a mapping, several as a list."""
    one = reference(f"element:{kind.path}")
    several: Schema = {"items": one}
    if kind.max_count is not None:
        several["maxItems"] = kind.max_count
    return _told(
        {"type": ["object", "array"], "if": {"type": "array"}, "then": several, "else": one}, kind.doc
    )


def _settings() -> Schema:
    single: Schema = {"type": ["string", "number", "boolean"]}
    return _told(
        _named_map({"type": [*single["type"], "array"], "items": single}),
        "the settings of the plugin, by its own keys",
    )


def _rule(rule: Constraint) -> list[Schema]:
    """A rule over the presence of attributes."""
    bundles = [list(bundle) for bundle in rule.bundles]
    if rule.kind == "exclusive":
        # Not as `not`, of which an editor could only say that it does not hold.
        return [
            {
                "if": {"required": [name]},
                "then": {
                    "properties": {other: False for others in bundles[index + 1 :] for other in others},
                    "errorMessage": f"`{name}` is there already, and only one of the two may stand",
                },
            }
            for index, bundle in enumerate(bundles[:-1])
            for name in bundle
        ]
    if rule.kind == "oneof":
        return [{"anyOf": [{"required": bundle} for bundle in bundles]}]
    if rule.kind == "together":
        names = [name for bundle in bundles for name in bundle]
        anyone: Schema = {"anyOf": [{"required": [name]} for name in names]}
        return [{"if": anyone, "then": {"required": names}}]
    asking, asked = bundles
    return [{"if": {"required": asking}, "then": {"required": asked}}]


def _object(properties: dict[str, Schema]) -> Schema:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _told(schema: Schema, description: str) -> Schema:
    return {**schema, "description": description} if description else schema


def _named_map(value: Schema) -> Schema:
    """A mapping from names."""
    return {"type": "object", "additionalProperties": value}

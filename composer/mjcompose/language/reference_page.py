"""The pages in docs/reference/keys, from the JSON Schema and MJCF's grammar, and the order of a recipe's keys.

`python -m mjcompose.language.reference_page docs/reference/keys` writes the pages; without a folder, it prints the
order for `composer/mjcompose/text/key_order.json`. `fmt` runs at every save, and importing the models takes longer.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from mjcompose.language.forms.context import Schema
from mjcompose.language.forms.translate import first_keys, key_order as key_order_of
from mjcompose.language.recipe import Recipe
from mjcompose.language.schema import recipe_schema
from mjcompose.sources.kinds import KINDS
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.grammar import GRAMMAR, ElementType


def key_order() -> dict[str, dict[str, list[str]]]:
    """Return keys by the path of their mapping, in which `*` stands for any name or index.

    In the mappings of `whole`, each key has a place. In the mappings of `first`, only some keys have a place, and they
    come first; the author orders the others.
    """
    tables = {"whole": key_order_of(Recipe), "first": first_keys(Recipe)}
    return {name: {".".join(map(str, at)): keys for at, keys in table.items()} for name, table in tables.items()}


def text() -> str:
    tables = [
        f'  "{name}": {{\n'
        + ",\n".join(f"    {json.dumps(path)}: {json.dumps(keys)}" for path, keys in table.items())
        + "\n  }"
        for name, table in key_order().items()
    ]
    return "{\n" + ",\n".join(tables) + "\n}\n"


MANUAL = "https://mujoco.readthedocs.io/en/stable/XMLreference.html"
_HEAD = f"""# Recipe reference

Every key of a recipe, a page for each section. [Recipes](../recipe.md), [variants](../variants.md),
[randomization](../../how-to/randomize.md) and [checks](../checks.md) explain how to use them together. Each page begins
with examples that use all of its keys; the tests build them. Elements and attributes are those of MJCF, with the same
meaning as in MuJoCo's [XML reference]({MANUAL}).

You choose the words that `PREFIX`, `NAME` and the like stand for. `[]` stands for each item of a list. Keys in **bold**
are required unless `extends` or a variant gives them. Any value can be a `${{…}}`, and any number can have the unit
`deg` or `rad`. Parts, edits, checks and elements can have `when`, which includes them in some builds only, and `for`,
which [repeats](../variants.md#for) them. A fragment of MJCF can take the place of an element: `xml: <geom …/>`.
"""
_CHAPTERS = {
    "selector": (
        "Selectors",
        "edit.md#selectors",
        "One key is a tag, a family, a path of tags or `default`, with a glob over names; others narrow it.",
    ),
    "Edit": ("Entries", "edit.md", "A selector, and the changes to the elements that it selects."),
    "DrawField": ("Fields", "randomize.md#fields", "An attribute of the selected elements, or a parameter."),
}
"""Definitions that have a table of their own: the title, the place, and the sentence above the keys."""
_ON = {"edit": ("Edit", "selector"), "randomize": ("DrawField",)}
"""The pages of these tables."""
_SAME = ("scale", "offset")
"""Keys of a field of `randomize` with the distributions that the field itself may have."""
_EVERYWHERE = ("when", "for", "xml")
"""Keys of many mappings, which the first page explains."""
_PLACES = {
    "attach": "PREFIX",
    "with": "PARAMETER",
    "packages": "PACKAGE",
    "params": "PARAMETER",
    "variants": "AXIS",
    "axes": "AXIS",
    "default": "CLASS",
    "fields": "FIELD",
    "from": "PART",
}
_BY_NAME = {"default": "settings by tag; `parent` is the class above", "randomize.fields": "one draw"}
_TYPES = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "array": "list",
    "object": "mapping",
}
_PLURALS = ("text", "number", "whole number", "mapping")
_OWN = {"exclude"}
"""Elements of MJCF that can have other forms in a recipe."""
_SETTINGS = ("option", "size", "statistic", "compiler")
_VALUES = re.compile(r"(number|plain|integer)(?:-(\d+)(-(\d*))?)?")
_TEMPLATE = r"\$\{"
_SAID = " (default: "
_ELEMENTS = ("element.", "named.", "typed.", "variant.", "step.", "class")
_TABLE = ("| key | type | default | meaning |", "|---|---|---|---|")
_ELEMENTS_HEAD = """Names in bold are required. Each element links to the XML reference, which has types and units.
A class has the same attributes, except the name."""
_NO_PAGE = (
    "recipe",
    "name",
    "description",
    "angle",
    "eulerseq",
    "separator",
    "conflict",
    "allow",
    "base",
    "extends",
    "variants",
)
"""Top-level keys that a row explains."""


def pages() -> dict[str, str]:
    """Return the text of each page of the reference, by its file name. They are the same every time."""
    schema = recipe_schema()
    whole = {**schema["else"], "required": schema["required"]}  # a recipe that extends no other
    keys = _Keys(schema["$defs"])
    found = {"index.md": _index(whole, keys)}
    for name, each in whole["properties"].items():
        if name not in _NO_PAGE:
            found[f"{name}.md"] = "\n".join(_section(name, each, keys)) + "\n"
    found["model_references.md"] = "\n".join(_references()) + "\n"
    return found


def page() -> str:
    return "\n".join(pages().values())


def write(folder: Path) -> None:
    texts = pages()
    for path in folder.glob("*.md"):
        if path.name not in texts:
            path.unlink()
    for name, each in texts.items():
        (folder / name).write_text(each, encoding="utf-8")


def _index(whole: Schema, keys: _Keys) -> str:
    rows = dict(zip(whole["properties"], keys.rows(whole, "", deep=False), strict=True))
    linked = {
        name: row if name in _NO_PAGE else row.replace(f"`{name}`", f"[`{name}`]({name}.md)", 1)
        for name, row in rows.items()
    }
    sections = GRAMMAR.root.children
    own = [row for name, row in linked.items() if name not in sections]
    lines = [_HEAD, "## Top-level keys", *_examples("top"), "", *_TABLE, *own]
    lines += ["", "## Sections of MJCF", "", *_TABLE, *(row for name, row in linked.items() if name in sections)]
    lines += ["", "[Model references](model_references.md) are the values of `base`, `model` and `extends`."]
    return "\n".join(lines) + "\n"


def _section(name: str, schema: Schema, keys: _Keys) -> Iterator[str]:
    yield f"# `{name}`"
    yield f"\n{keys.about(schema)}"
    yield from _examples(name)
    own: list[tuple[str, str]] = []
    mjcf: list[tuple[str, str]] = []
    for place, row in keys.placed(schema, name):
        (mjcf if _is_of_mjcf(name, place) else own).append((place, row))
    if own:
        yield from ("", *_titled(own))
    for chapter in _ON.get(name, ()):
        title, _, about = _CHAPTERS[chapter]
        yield f"\n## {title}\n\n{about}"
        yield from _examples(title.lower())
        yield from ("", *_TABLE, *keys.rows(keys.definitions[chapter], ""))
    section = GRAMMAR.root.children.get("worldbody" if name == "add" else name)
    if name in _SETTINGS:
        yield from ("", f"## Attributes of `{name}` in MJCF", "", *_titled(mjcf))
    if section is not None and (rows := list(_elements(section))):
        yield f"\n## Elements of MJCF\n\n{_ELEMENTS_HEAD}\n\n| element | meaning | attributes |\n|---|---|---|"
        yield from rows


def _is_of_mjcf(section: str, place: str) -> bool:
    """Return whether a key is an element or an attribute of MJCF, without forms of the language in it."""
    kind = GRAMMAR.element("body") if section == "add" else GRAMMAR.root.children.get(section)
    below = place.partition(".")[2]
    if kind is not None and (named := re.fullmatch(r"(\w+)\.NAME\.(\w+)", below)):
        return named[1] in kind.children and named[2] in kind.children[named[1]].attributes
    return kind is not None and below in {*kind.attributes, *kind.children} - _OWN


def _titled(rows: Sequence[tuple[str, str]]) -> Iterator[str]:
    steps = re.match(r"(\w+(?:\.[A-Z]+)?(?:\[\])?)\.", rows[0][0])
    start = steps[1] if steps and all(place.startswith(steps[0]) for place, _ in rows) else ""
    if start:
        yield from (f"Keys of `{start}`:", "")
    yield from (*_TABLE, *(row.replace(f"`{start}.", "`", 1) if start else row for _, row in rows))


def examples(name: str) -> list[str]:
    """Return the recipes that show a chapter's keys, from the package or from the docs of a clone."""
    here = Path(__file__).resolve()
    for folder in (here.parent / "examples", here.parents[3] / "docs" / "examples" / "keys"):
        if os.path.isfile(folder / f"{name}.yaml"):
            return (folder / f"{name}.yaml").read_text(encoding="utf-8").split("---\n")
    return []


def _examples(name: str) -> Iterator[str]:
    for text in examples(name):
        yield from ("", "```yaml", text.rstrip(), "```")


def _references() -> Iterator[str]:
    yield "# Model references\n"
    yield "`base`, `model` of a part and `extends` take these. [Sources](../sources.md) explains each form.\n"
    yield "| form | meaning |\n|---|---|"
    yield from (f"| `{form.example}` | {form.meaning} |" for kind in KINDS for form in kind.forms)


class _Keys:
    def __init__(self, definitions: dict[str, Schema]) -> None:
        self.definitions = definitions

    def rows(self, schema: Schema, path: str, deep: bool = True) -> Iterator[str]:
        """Yield a row for each key that the schema describes, and for the keys inside, at any depth."""
        yield from (row for _, row in self.placed(schema, path, deep))

    def placed(self, schema: Schema, path: str, deep: bool = True) -> Iterator[tuple[str, str]]:
        """Yield the same rows, each with its path. A key for one value or several values has one row."""
        seen = set()
        for place, row in self._placed(schema, path, deep):
            plain = place.replace("[]", "")
            if plain not in seen:
                seen.add(plain)
                yield place, row

    def _placed(self, schema: Schema, path: str, deep: bool) -> Iterator[tuple[str, str]]:
        for kind in self._kinds(schema):
            yield from self._rows_of_keys(kind, path, deep)
            yield from self._rows_of_names(kind, path, deep)
            if isinstance(kind.get("items"), dict):
                yield from self._placed(kind["items"], f"{path}[]", deep)

    def _rows_of_keys(self, kind: Schema, path: str, deep: bool) -> Iterator[tuple[str, str]]:
        """Yield the rows of a mapping whose keys are known."""
        required = {*kind.get("required", ())}
        for rule in (*kind.get("allOf", ()), kind.get("else", {})):
            required |= {*rule.get("required", ())}
        alike = self._alike(kind.get("properties", {}))
        for name, schema in kind.get("properties", {}).items():
            place = f"{path}.{name}" if path else name
            if name not in alike or (name in _EVERYWHERE and path):
                continue
            about, others = alike[name]
            row = self._row(place, {**schema, "description": about}, name in required)
            if others:
                row = row.replace(f"`{place}`", ", ".join(f"`{key}`" for key in (place, *others)), 1)
            yield place, row
            if deep and name not in _SAME:
                yield from self._placed(schema, place, deep)

    def _rows_of_names(self, kind: Schema, path: str, deep: bool) -> Iterator[tuple[str, str]]:
        """Yield the rows of a mapping whose keys are names that the user chooses."""
        below = kind.get("additionalProperties")
        if not isinstance(below, dict):
            return
        word = _PLACES.get(path.rpartition(".")[2], "NAME")
        place = f"{path}.{word}" if path else word
        pointer = below.get("$ref", "").rpartition("/")[2]
        if pointer in _CHAPTERS or pointer.startswith(("typed.", "class")):
            described = {"description": _BY_NAME.get(path, "`type` is the tag of MJCF"), **below}
            yield place, self._row(place, described, False)
        yield from self._placed(below, place, deep)

    def _alike(self, properties: dict[str, Schema]) -> dict[str, tuple[str, list[str]]]:
        """Return the keys that have a row, each with its meaning and with the other keys of that row.

        The orientations share one row, and so do three or more keys of one type whose meanings differ only after a
        colon.
        """
        meant = {name: self.about(each) for name, each in properties.items()}
        groups: dict[object, list[str]] = {}
        for name, each in properties.items():
            head, colon, _ = meant[name].partition(": ")
            is_said = _SAID in meant[name]  # a row for several has no default
            groups.setdefault((self._type(each), head) if colon and not is_said else name, []).append(name)
        turns = [name for name in properties if name in ORIENTATIONS]
        found = {name: (meant[name], turns[1:] if name == turns[0] else []) for name in turns[:1]}
        for names in groups.values():
            together = len(names) > 2
            row_names = names[:1] if together else names
            for name in row_names:
                if name not in turns:
                    about = meant[name].partition(": ")[0] if together else meant[name]
                    found[name] = about, names[1:] if together else []
        return found

    def about(self, schema: Schema) -> str:
        """Return the description of a schema, or of the definition that it refers to."""
        target = self.definitions.get(schema.get("$ref", "").rpartition("/")[2], {})
        return " ".join((schema.get("description") or target.get("description", "")).split())

    def _kinds(self, schema: Schema) -> Iterator[Schema]:
        """Yield the kinds of values. References are followed, except for elements and keys with a chapter."""
        pointer = schema.get("$ref", "").rpartition("/")[2]
        if pointer:
            if not self._apart(pointer):
                yield from self._kinds(self.definitions[pointer])
            return
        yield schema
        for each in schema.get("anyOf", ()):
            yield from self._kinds(each)

    @staticmethod
    def _apart(pointer: str) -> bool:
        # Numbers are known by their type, and a piece of recipe has the same keys as a recipe.
        known = pointer in _CHAPTERS or pointer in ("Piece", "InPlace", "Drop", "TerrainColumn")
        return known or bool(_VALUES.fullmatch(pointer)) or pointer.startswith((*_ELEMENTS, "attributes.", "property"))

    def _row(self, place: str, schema: Schema, required: bool) -> str:
        target = self.definitions.get(schema.get("$ref", "").rpartition("/")[2], {})
        schema = {**{key: target[key] for key in ("description", "default") if key in target}, **schema}
        about = self.about(schema)
        about, _, said = about.removesuffix(")").partition(_SAID) if _SAID in about else (about, "", "")
        default = f"`{_shown(schema['default'])}`" if "default" in schema else f"`{said}`" if said else ""
        cells = (f"**`{place}`**" if required else f"`{place}`", self._type(schema), default, about)
        return f"| {' | '.join(each.replace('|', chr(92) + '|') for each in cells)} |"

    def _type(self, schema: Schema) -> str:
        pointer = schema.get("$ref", "").rpartition("/")[2]
        if pointer:
            return self._named(pointer)
        if "const" in schema:
            return f"`{_shown(schema['const'])}`"
        if "enum" in schema:
            return ", ".join(f"`{_shown(word)}`" for word in schema["enum"])
        if "anyOf" in schema:
            return self._either(schema["anyOf"])
        if "allOf" in schema and "type" not in schema:  # a part, except some of its keys
            return self._type(schema["allOf"][0])
        types = schema.get("type", ())
        types = [types] if isinstance(types, str) else types
        if len(types) > 1 and _TEMPLATE in schema.get("pattern", ""):
            types = [type for type in types if type != "string"]
        words = [_TYPES[type] for type in types]
        if words == ["list"] and "items" in schema:
            return self._list(schema)
        return " or ".join(words) or "value"

    def _either(self, kinds: Sequence[Schema]) -> str:
        """Return the types of several kinds of values, without the expressions that every value may be."""
        text = {"type": "string", "pattern": _TEMPLATE}
        templates = text.items(), {"$ref": "#/$defs/template"}.items()
        others = [kind for kind in kinds if not any(kind.items() >= template for template in templates)]
        return " or ".join(dict.fromkeys(map(self._type, others)))

    def _list(self, schema: Schema) -> str:
        item = self._type(schema["items"])
        least = schema.get("minItems")
        if least == schema.get("maxItems", 0) and item in ("number", "whole number"):
            return f"{least} {item}s"
        item = f"lists{item[4:]}" if item.startswith("list of") else item
        return f"list of {item}s" if item in _PLURALS else f"list of {item}"

    def _named(self, pointer: str) -> str:
        number = _VALUES.fullmatch(pointer)
        if number is not None:
            word = "whole number" if number[1] == "integer" else "number"
            least = number[2]
            several = number[3]
            most = number[4]
            if least is None or (least == "1" and not several):
                return word
            count = least if not several else f"{least} to {most}" if most else f"{least} or more"
            return f"{count} {word}s"
        if pointer == "Drop":
            return self._named("selector")
        if pointer == "TerrainColumn":
            return "a kind, or a mapping with the kind and its numbers"
        if pointer == "code":
            return "[codes](../../errors)"
        if pointer in _CHAPTERS:
            return f"[{pointer}]({_CHAPTERS[pointer][1]})"
        if pointer.startswith(_ELEMENTS):
            return "element"
        if pointer == "Attachment":
            return "[part](attach.md)"
        if pointer in ("Piece", "InPlace"):
            return "any of the [top-level keys](index.md)"
        return self._type(self.definitions[pointer])


def _shown(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _elements(section: ElementType) -> Iterator[str]:
    """Yield a row for each element of a section of MJCF, each once; for the section itself if it has attributes."""
    seen: set[str] = set()
    waiting = [section]
    while waiting:
        kind = waiting.pop(0)
        if kind.path in seen:
            continue
        seen.add(kind.path)
        # Classes have the attributes of their elements, and bodies have the same children everywhere.
        if section.tag != "default":
            waiting += kind.children.values()
        if not kind.attributes or kind.tag in _SETTINGS:
            continue  # settings are keys of the recipe
        attributes = ", ".join(
            f"**`{name}`**" if each.required else f"`{name}`" for name, each in kind.attributes.items()
        )
        yield f"| [`{kind.path}`]({MANUAL}#{kind.path.replace('/', '-')}) | {kind.doc or ''} | {attributes} |"


if __name__ == "__main__":
    if len(sys.argv) > 1:
        write(Path(sys.argv[1]))
    else:
        sys.stdout.write(text())

"""The page docs/reference.md, and the order of a recipe's keys.

The order in which `fmt` writes the keys of a recipe: that of the fields and rows of the language.

`python -m mjcompose.language.reference_page > composer/mjcompose/text/key_order.json` writes it to a file.
`fmt` runs at every save and reads that file, because importing the models takes longer than formatting.

The page docs/reference.md: all keys of a recipe from the JSON Schema, and MJCF's elements from the grammar.

`python -m mjcompose schema reference > docs/reference.md` writes it.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from mjcompose.language.attach import Attachment
from mjcompose.language.expand import KEYS as MATRIX
from mjcompose.language.expand import SETTLED
from mjcompose.language.form import Schema, check_rows
from mjcompose.language.keyframe import KEYS as KEYFRAME
from mjcompose.language.keyframe import Keyframes
from mjcompose.language.parameters import KEYS as PARAMETER
from mjcompose.language.randomize import Randomize
from mjcompose.language.recipe import ID, TO, Additions, Recipe, sections_of
from mjcompose.language.schema import recipe_schema
from mjcompose.language.sections import PARENT, TYPE, Defaults, Typed
from mjcompose.language.used_model import KEYS as EDIT
from mjcompose.language.used_model import Base, key_names
from mjcompose.model.grammar import GRAMMAR, ElementType
from mjcompose.sources.kinds import KINDS

_WHEN = "when"
_AFTER = {
    "extends": "description",
    "trust": "extends",
    "params": "conflict",
    "variants": "keyframe",
    "matrix": "variants",
}
"""What is settled before a recipe is validated, each with the key behind which it stands."""
check_rows("the places of keys in composer/mjcompose/language/reference_page.py", _AFTER, SETTLED)


def key_order() -> dict[str, dict[str, list[str]]]:
    """Return keys by the path of their mapping, in which `*` stands for any name or index.

    In the mappings of `whole`, each key has a place. In those of `first`, only some keys have one, and come first;
    the author orders the others.
    """
    edit = list(EDIT)
    whole = {
        "": _top(),
        "base": key_names(Base),
        "attach.*": [*key_names(Attachment), _WHEN],
        "edit.*": edit,
        "base.edit.*": edit,
        "attach.*.edit.*": edit,
        "params.*": list(PARAMETER),
        **{f"{section}.*": list(KEYFRAME) for section in sections_of(Keyframes)},
        "matrix": list(MATRIX),
        "randomize": key_names(Randomize),
    }
    first = {
        **_each(sections_of(Additions), ID, TO),
        **_each(sections_of(Defaults), PARENT),
        **_each(sections_of(Typed), TYPE),
    }
    return {"whole": whole, "first": first}


def text() -> str:
    """Return the order as the text of its file, with one mapping on each line."""
    tables = [
        f'  "{name}": {{\n'
        + ",\n".join(f"    {json.dumps(path)}: {json.dumps(keys)}" for path, keys in table.items())
        + "\n  }"
        for name, table in key_order().items()
    ]
    return "{\n" + ",\n".join(tables) + "\n}\n"


def _top() -> list[str]:
    keys = key_names(Recipe)
    for key, before in _AFTER.items():
        keys.insert(keys.index(before) + 1, key)
    return keys


def _each(sections: Iterable[str], *keys: str) -> dict[str, list[str]]:
    return {f"{section}.*": list(keys) for section in sections}


MANUAL = "https://mujoco.readthedocs.io/en/stable/XMLreference.html"
_HEAD = f"""# Reference

All keys of a recipe, as `mjcompose schema reference` prints them. [Recipes](recipes.md), [variation](variation.md),
[randomisation](randomisation.md) and [checks](checks.md) explain what they mean together. Every chapter begins with
examples that together use each of its keys; the tests build them. Elements and their attributes are those of MJCF, and
mean what MuJoCo's [XML reference]({MANUAL}) says.

You choose the words that `PREFIX`, `NAME` and the like stand for. `[]` stands for each item of a list. Keys in **bold**
are required unless `extends` or a variant gives them. `${{…}}` may stand for any value, and a number may have the unit
`deg` or `rad`.
"""
_CHAPTERS = {
    "selector": (
        "Selectors",
        "One key is a tag, a family, a path of tags or `default`, with a glob over names; others narrow it.",
    ),
    "edit": ("Entries of `edit`", "A selector, and what is done to what it selects."),
    "draw": ("Fields of `randomize`", "What is drawn: an attribute of what is selected, or a parameter."),
}
"""What is explained once, in a chapter of its own: by definition, the title and what stands above the keys."""
_SAME = ("scale", "offset")
"""Keys of a field of `randomize` with the distributions that the field itself may have."""
_PLACES = {
    "attach": "PREFIX", "with": "PARAMETER", "packages": "PACKAGE", "params": "PARAMETER", "variants": "AXIS",
    "axes": "AXIS", "default": "CLASS", "fields": "FIELD", "from": "PART",
}  # fmt: skip
_BY_NAME = {"default": "settings by tag; `parent` is the class above", "randomize.fields": "one draw"}
_TYPES = {
    "string": "text", "number": "number", "integer": "whole number", "boolean": "true or false", "array": "list",
    "object": "mapping",
}  # fmt: skip
_SETTINGS = ("option", "size", "statistic", "compiler")
_VALUES = re.compile(r"(number|integer)(?:-(\d+)(-(\d*))?)?")
_TEMPLATE = r"\$\{"
_SAID = " (default: "
_ELEMENTS = ("element.", "named.", "typed.", "variant.", "step.", "class")


def page() -> str:
    """Return the text of the page. It is the same every time."""
    schema = recipe_schema()
    keys = _Keys(schema["$defs"])
    whole = {**schema["else"], "required": schema["required"]}  # a recipe that extends no other
    lines = [_HEAD, "## Top-level keys", *_examples("top"), "", *keys.table(whole, "", deep=False)]
    for name, each in whole["properties"].items():
        rows = list(keys.rows(each, name))
        if rows:
            lines += ["", f"## `{name}`", *_examples(name), "", *keys.head, *rows]
    for name, (title, about) in _CHAPTERS.items():
        lines += ["", f"## {title}", "", about, *_examples(name), "", *keys.table(keys.definitions[name], "")]
    lines += ["", "## Model references", "", *_references()]
    lines += ["", "## Elements", ""]
    lines += [
        "Names in bold are required. Types, units and defaults are shown by [editors](editors.md), and are in the XML",
        "reference, to which each element is a link. Of a class an element has the same attributes but its name.",
    ]
    for section in GRAMMAR.root.children.values():
        if rows := list(_elements(section)):
            title = "the body tree, in `add`" if section.tag == "worldbody" else f"`{section.tag}`"
            lines += [
                "",
                f"### In {title}",
                "",
                "| element | what it is | attributes |",
                "|---|---|---|",
                *rows,
            ]
    return "\n".join(lines) + "\n"


def examples(name: str) -> list[str]:
    """Return the recipes that show the keys of a chapter.

    In an installed package they are beside this file, in a clone in the docs.
    """
    here = Path(__file__).resolve()
    for folder in (here.parent / "examples", here.parents[3] / "docs" / "examples" / "keys"):
        if os.path.isfile(folder / f"{name}.yaml"):
            return (folder / f"{name}.yaml").read_text(encoding="utf-8").split("---\n")
    return []


def _examples(name: str) -> Iterator[str]:
    for text in examples(name):
        yield from ("", "```yaml", text.rstrip(), "```")


def _references() -> Iterator[str]:
    """Yield every form of a model reference, from the rows of the source kinds."""
    yield "What `base`, `model` of a part and `extends` take. What is behind each form is in [sources](sources.md)."
    yield ""
    yield "| form | what it is |"
    yield "|---|---|"
    yield from (f"| `{form.example}` | {form.meaning} |" for kind in KINDS for form in kind.forms)


class _Keys:
    """Makes tables of keys from JSON Schema."""

    head = ("| key | type | default | what it is |", "|---|---|---|---|")

    def __init__(self, definitions: dict[str, Schema]) -> None:
        self.definitions = definitions

    def table(self, schema: Schema, path: str, deep: bool = True) -> list[str]:
        return [*self.head, *self.rows(schema, path, deep)]

    def rows(self, schema: Schema, path: str, deep: bool = True) -> Iterator[str]:
        """Yield a row for each key in what the schema describes, and for the keys inside, at any depth."""
        for kind in self._kinds(schema):
            required = {*kind.get("required", ())}
            for rule in (*kind.get("allOf", ()), kind.get("else", {})):
                required |= {*rule.get("required", ())}
            for name, each in kind.get("properties", {}).items():
                place = f"{path}.{name}" if path else name
                yield self._row(place, each, name in required)
                if deep and name not in _SAME:
                    yield from self.rows(each, place)
            below = kind.get("additionalProperties")
            if isinstance(below, dict):
                word = _PLACES.get(path.rpartition(".")[2], "NAME")
                pointer = below.get("$ref", "").rpartition("/")[2]
                if pointer in _CHAPTERS or pointer.startswith(("typed.", "class")):
                    described = {"description": _BY_NAME.get(path, "`type` is the tag of MJCF"), **below}
                    yield self._row(f"{path}.{word}", described, False)
                yield from self.rows(below, f"{path}.{word}" if path else word)
            if isinstance(kind.get("items"), dict):
                yield from self.rows(kind["items"], f"{path}[]")

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
        known = pointer in _CHAPTERS or pointer in ("Piece", "InPlace", "dropped")
        return known or bool(_VALUES.fullmatch(pointer)) or pointer.startswith((*_ELEMENTS, "property"))

    def _row(self, place: str, schema: Schema, required: bool) -> str:
        target = self.definitions.get(schema.get("$ref", "").rpartition("/")[2], {})
        schema = {**{key: target[key] for key in ("description", "default") if key in target}, **schema}
        about = " ".join(schema.get("description", "").split())
        about, _, said = about.removesuffix(")").partition(_SAID) if _SAID in about else (about, "", "")
        default = f"`{_shown(schema['default'])}`" if "default" in schema else f"`{said}`" if said else ""
        cells = (f"**`{place}`**" if required else f"`{place}`", self._type(schema), default, about)
        return f"| {' | '.join(each.replace('|', chr(92) + '|') for each in cells)} |"

    def _type(self, schema: Schema) -> str:
        if pointer := schema.get("$ref", "").rpartition("/")[2]:
            return self._named(pointer)
        if "const" in schema:
            return f"`{_shown(schema['const'])}`"
        if "enum" in schema:
            return ", ".join(f"`{_shown(each)}`" for each in schema["enum"])
        if "anyOf" in schema:
            kinds = [each for each in schema["anyOf"] if not self._is_template(each)]
            return " or ".join(dict.fromkeys(self._type(each) for each in kinds))
        types = schema.get("type", ())
        types = [types] if isinstance(types, str) else types
        if len(types) > 1 and _TEMPLATE in schema.get("pattern", ""):
            types = [each for each in types if each != "string"]
        words = [_TYPES[each] for each in types]
        if words == ["list"] and "items" in schema:
            item, least = self._type(schema["items"]), schema.get("minItems")
            is_fixed = least == schema.get("maxItems", 0) and item in ("number", "whole number")
            return f"{least} {item}s" if is_fixed else f"list of {item}"
        return " or ".join(words) or "value"

    @staticmethod
    def _is_template(schema: Schema) -> bool:
        return schema.get("pattern") == _TEMPLATE or schema.get("$ref") == "#/$defs/template"

    def _named(self, pointer: str) -> str:
        if (number := _VALUES.fullmatch(pointer)) is not None:
            word = "number" if number[1] == "number" else "whole number"
            least, several, most = number[2], number[3], number[4]
            if least is None or (least == "1" and not several):
                return word
            count = least if not several else f"{least} to {most}" if most else f"{least} or more"
            return f"{count} {word}s"
        if pointer == "dropped":
            return self._named("selector")
        if pointer == "code":
            return "[codes](errors)"
        if pointer in _CHAPTERS:
            title = _CHAPTERS[pointer][0]
            anchor = re.sub(r"[^a-z ]", "", title.lower()).replace(" ", "-")
            return f"[{pointer}](#{anchor})"
        if pointer.startswith(_ELEMENTS):
            return "[element](#elements)"
        if pointer in ("Piece", "InPlace"):
            return "any of the [top-level keys](#top-level-keys)"
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
    sys.stdout.write(text())

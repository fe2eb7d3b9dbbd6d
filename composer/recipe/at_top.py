"""Advice for a key at the top of a recipe that belongs elsewhere, for those who left out a level or know MJCF."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.diagnostics.suggest import closest
from composer.grammar import GRAMMAR
from composer.recipe.attach import Attachment
from composer.recipe.by_tag import ByTag, Lists
from composer.recipe.recipe import Recipe, sections_of
from composer.recipe.shown import shown
from composer.recipe.typed import Typed

_PART_KEYS = frozenset(
    str(field.alias or name) for name, field in Attachment.model_fields.items()
) - frozenset(Recipe.model_fields)
_OF_MJCF = {
    "worldbody": "write `add: [{to: world, body: {…}}]`",
    "include": "write `attach` for another model, or `base` for the one to start from",
    "flag": "write `option: {flag: {…}}`",
}
_MODEL_FILES = (".xml", ".urdf", ".xacro", ".yaml", ".yml")


def part_keys(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys at the top of a recipe that only a part can have."""
    return {key: each for key, each in data.items() if key in _PART_KEYS and not isinstance(each, Mapping)}


def advice_at_top(name: str, value: Any, parts: Mapping[str, Any]) -> str | None:
    """Return what to write instead of `name: value` at the top of a recipe, or None if that is not known.

    `parts` are the keys at the top that only a part can have.
    """
    if isinstance(value, Mapping) and "model" in value and not closest(name, Recipe.model_fields):
        return f"a part goes under `attach`:\nattach:\n  {name}: {_flow(value)}"
    if name in parts and (len(parts) > 1 or name != "model"):
        entries = _flow({"model": "…", **parts})
        return f"{_keys(parts)} of a part under `attach`:\nattach:\n  PREFIX: {entries}"
    if name == "model":
        if isinstance(value, str) and (":" in value or value.lower().endswith(_MODEL_FILES)):
            return f"write `base: {value}` for the model to start from, or put it under `attach`, in a part"
        return "write `base` for the model to start from, or `name` for what the result is called"
    return _OF_MJCF.get(name) or _in_section(name, value)


def _in_section(name: str, value: Any) -> str | None:
    """Return the section that has such an element or setting, or None."""
    if name in GRAMMAR.element("body").children:
        return f"write it in the list `add`: `add: [{{to: world, {name}: {_short(value)}}}]`"
    for tag, section in GRAMMAR.root.children.items():
        if tag in ("option", "visual", "statistic") and name in {*section.attributes, *section.children}:
            return f"write it in `{tag}`: `{tag}: {{{name}: {_short(value)}}}`"
        if tag in (*sections_of(ByTag), *sections_of(Lists)) and name in section.children:
            return f"write it in the section `{tag}`: `{tag}: {{{name}: …}}`"
        if tag in sections_of(Typed) and name in section.children:
            return f"write it in the section `{tag}`: `{tag}: {{NAME: {{type: {name}, …}}}}`"
    return None


def _keys(parts: Mapping[str, Any]) -> str:
    *others, last = (f"`{key}`" for key in parts)
    return f"{', '.join(others)} and {last} are keys" if others else f"{last} is a key"


def _short(value: Any) -> str:
    return shown(value) if isinstance(value, str | int | float | bool) or _is_flat(value) else "{…}"


def _is_flat(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, str | int | float) for item in value)


def _flow(value: Mapping[str, Any]) -> str:
    return f"{{{', '.join(f'{key}: {_short(each)}' for key, each in value.items())}}}"

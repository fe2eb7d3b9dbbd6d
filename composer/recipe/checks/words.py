"""Attributes whose values in a compiled model are words: kinds of element, and names of others."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from composer.compiled.attributes import ENUMERATED
from composer.grammar import GRAMMAR
from composer.tree.selector import paths_of

_NAMING = ("geom", "site", "camera", "light", "skin", "material", "pair", "exclude", "equality", "tendon", "actuator",
           "sensor")  # fmt: skip
_NOT_COMPILED = ("default", "instance")


@cache
def keywords(tag: str) -> Mapping[str, tuple[str, ...]]:
    """The attributes of a tag that have one of several words, with these. `type` of a family is its tags."""
    paths = paths_of(tag)
    found: dict[str, tuple[str, ...]] = {}
    for name in sorted(ENUMERATED.get(tag, ())):
        words = {word for path in paths for word in _words(path, name)}
        found[name] = tuple(sorted(words or {GRAMMAR.element(path).tag for path in paths}))
    return found


def _words(path: str, name: str) -> tuple[str, ...]:
    attribute = GRAMMAR.element(path).attributes.get(name)
    return attribute.keywords if attribute is not None else ()


@cache
def naming(tag: str) -> Mapping[str, str | None]:
    """The attributes of a tag that name another element, with its kind; None where another attribute says which."""
    if tag not in _NAMING:
        return {}
    return {
        name: attribute.refers
        for path in sorted(paths_of(tag))
        for name, attribute in GRAMMAR.element(path).attributes.items()
        if (attribute.is_reference or attribute.refers_by) and attribute.refers not in _NOT_COMPILED
    }

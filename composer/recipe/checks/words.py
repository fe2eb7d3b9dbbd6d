"""Attributes whose values in a compiled model are words: keywords, and names of other elements."""

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
    """Return the attributes of a tag that have keywords, with these. The keywords of a family's `type` are its tags."""
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
    """Return the attributes of a tag that name another element, with its kind.

    The kind is None if another attribute gives it.
    """
    if tag not in _NAMING:
        return {}
    return {
        name: attribute.refers
        for path in sorted(paths_of(tag))
        for name, attribute in GRAMMAR.element(path).attributes.items()
        if (attribute.is_reference or attribute.refers_by) and attribute.refers not in _NOT_COMPILED
    }

"""Settings that neither the base nor the recipe writes, and on which all parts that write them agree."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from composer.link.written import Written, equal, is_default
from composer.tree.adopted import Adopted

Opinions = Mapping[str, Written]


def common_settings(
    base: Opinions, parts: Sequence[tuple[str, Opinions]], overridden: Collection[str]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, Written]]]]:
    """Return the settings that the parts agree on, and those that they do not agree on, by path.

    `base` and `parts` are what each unit asks for, the parts by what messages call them; `overridden` are the paths
    that the recipe sets itself. What the parts do not agree on comes with who writes which value.
    """
    asked: dict[str, list[tuple[str, Written]]] = {}
    for name, opinions in parts:
        for path, wanted in opinions.items():
            if path not in base and path not in overridden:
                asked.setdefault(path, []).append((name, wanted))
    found: dict[str, Adopted] = {}
    for path, given in list(asked.items()):
        first = given[0][1]
        if all(equal(first.value, wanted.value) for _, wanted in given):
            names = tuple(name for owner, wanted in given for name in _names(owner, wanted))
            found[path] = Adopted(path, first.value, names, first.span, not is_default(path, first.value))
            del asked[path]
    return found, asked


def _names(owner: str, wanted: Written) -> list[str]:
    """Return the part that writes the setting, or for a nested recipe its parts that write it."""
    return [owner + inner for inner in wanted.parts] or [owner]


def of_base(adopted: tuple[Adopted, ...], now: Opinions, overridden: Collection[str]) -> tuple[Adopted, ...]:
    """Return the settings from the parts of a base that is a recipe, if it still asks for the same values `now`."""
    return tuple(
        each
        for each in adopted
        if each.path not in overridden and each.path in now and equal(now[each.path].value, each.value)
    )

"""Settings that neither the base nor the recipe writes, and on which all parts that write them agree."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from composer.link.written import Written, equal, is_default
from composer.tree.adopted import Adopted

Opinions = Mapping[str, Written]


def common_settings(
    base: Opinions, parts: Sequence[tuple[str, Opinions]], overridden: Collection[str]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, Written]]]]:
    """What the parts agree on, and what they do not, by path.

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
    """The part that writes it, or those of a nested recipe that do."""
    return [owner + inner for inner in wanted.parts] or [owner]


def of_base(adopted: tuple[Adopted, ...], now: Opinions, overridden: Collection[str]) -> tuple[Adopted, ...]:
    """What the parts of a base that is a recipe itself agree on, as far as that is what the base asks for `now`."""
    return tuple(
        each
        for each in adopted
        if each.path not in overridden and each.path in now and equal(now[each.path].value, each.value)
    )

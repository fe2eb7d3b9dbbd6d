"""A selector as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache

from mjcompose.base.dataclass import dataclass
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import is_pattern

EVERYTHING = "**"
# If a tag has elements in several sections, it selects those in the body tree and the assets.
_USUAL = ("worldbody", "asset")


@dataclass(frozen=True, slots=True)
class Selector:
    """A tag with a glob for the names, and further conditions. `tag` is a path, a tag or a family.

    `pattern` is a glob, or `/…/` for a regular expression. `where` compares effective values by
    attribute (`friction[0]` for one number), or is one boolean `${…}`. `at` is the path of the selector in the
    recipe.
    """

    tag: str
    pattern: str
    parent: Selector | None = None
    inside: Selector | None = None
    part: str | None = None
    dclass: str | None = None
    where: Mapping[str, object] | str | None = None
    at: tuple[str | int, ...] = ()

    @property
    def is_one_name(self) -> bool:
        """Whether it is a single name without further conditions."""
        narrowed = any((self.parent, self.inside, self.part, self.dclass, self.where))
        return not (narrowed or is_pattern(self.pattern))

    def all(self) -> Iterator[Selector]:
        """Yield this selector and those of its parents."""
        yield self
        for outer in (self.parent, self.inside):
            if outer is not None:
                yield from outer.all()

    def __str__(self) -> str:
        conditions = {"parent": self.parent, "in": self.inside, "part": self.part, "class": self.dclass}
        narrowed = [f"{name}: {condition}" for name, condition in conditions.items() if condition]
        if isinstance(self.where, str):
            narrowed.append(f"where: {self.where}")
        elif self.where:
            narrowed.append(f"where: {{{', '.join(f'{name}: {_shown(v)}' for name, v in self.where.items())}}}")
        return f"{{{', '.join([f'{self.tag}: {self.pattern}', *narrowed])}}}"


def _shown(value: object) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_shown, value))}]"
    return {True: "true", False: "false"}.get(value, str(value)) if isinstance(value, bool) else str(value)


@cache
def paths_of(tag: str) -> frozenset[str]:
    """Return the grammar paths that a tag, a family or a path selects; none if MJCF has no such element.

    >>> sorted(paths_of("joint")), sorted(paths_of("equality/joint")), sorted(paths_of("weld"))
    (['freejoint', 'joint'], ['equality/joint'], ['equality/weld'])
    """
    family = GRAMMAR.families.get(tag)
    if family is not None:
        return frozenset(path for path in family if not path.startswith("default/"))
    if "/" in tag:
        return frozenset({tag}) if tag in GRAMMAR.paths else frozenset()
    usual = frozenset(kind.path for section in _USUAL for name, kind in GRAMMAR.within(section).items() if name == tag)
    if usual:
        return usual
    fitting = [path for path in GRAMMAR.paths if path.rpartition("/")[2] == tag]
    return frozenset(path for path in fitting if not path.startswith("default/") and path != "mujoco")


@cache
def known_tags() -> tuple[str, ...]:
    """Return every tag, family and path that a selector may have, for suggestions."""
    tags = {path.rpartition("/")[2] for path in GRAMMAR.paths} | GRAMMAR.families.keys()
    return tuple(sorted(tags - {"mujoco", "include"}))

"""The entries of a recovered recipe, and the changes that they express."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.document.quote import word
from composer.grammar.attribute import Attribute
from composer.importing.elements import Item
from composer.importing.flow import flow_list
from composer.importing.match import Instance

# Ranks. Classes come first. Removals come after all changes, because they may select by number, and references are
# removed before their targets. Renames come last: until then, names are those of the parts.
CLASSES, REMOVED, RENAMED = -1, 10_000, 20_000


@dataclass(slots=True)
class Entry:
    """One entry of a section of the recipe; `note` says why it is only a comment.

    Entries are in groups within a section, ordered by `rank`: removals by number come last.
    """

    section: str
    text: str
    note: str | None = None
    group: str = ""
    rank: int = 0


@dataclass(frozen=True, slots=True)
class Pair:
    """An element of a part and how it differs in the merged model; `select` is its selector in the recipe."""

    select: str
    item: Item
    each: Instance
    changes: dict[str, str | None]
    moved: dict[str, str]


@dataclass(frozen=True, slots=True)
class Changed:
    """An attribute with another value in the merged model than in the parts.

    `kind` and `name` are those of the element, or of the class if `count` elements get the value from it. `before`
    and `after` are the written values, None if there is none.
    """

    kind: str
    name: str
    attribute: str
    before: str | None
    after: str | None
    unit: str = ""
    count: int = 1


Names = dict[str, dict[str, str]]
"""By kind, the names of a part's elements in the merged model that are not just prefixed."""


def selector_of(namespace: str, tag: str, name: str) -> str:
    kind = namespace if namespace in ("actuator", "sensor", "equality", "tendon") else tag
    return f"{{{kind}: {word(name)}}}"


def written_value(attribute: Attribute, text: str) -> str:
    parts = text.split()
    if attribute.separated and (attribute.max_length != 1):
        return flow_list(parts)
    if attribute.type == "bool" or attribute.is_number:
        return text
    return word(text)

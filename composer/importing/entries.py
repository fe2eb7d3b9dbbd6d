"""What a recipe that is recovered says: its entries, and the changes that they stand for."""

from __future__ import annotations

from dataclasses import dataclass

from composer.document.quote import word
from composer.grammar.attribute import Attribute
from composer.importing.elements import Item
from composer.importing.flow import flow_list
from composer.importing.match import Instance

# Classes first. Before what is removed by its number all is changed, and what refers to something goes before it
# does; names are as the parts have them until the end.
CLASSES, REMOVED, RENAMED = -1, 10_000, 20_000


@dataclass(slots=True)
class Entry:
    """One thing that the recipe says, in its section; `note` says why it is only a comment.

    Entries of a section stand in groups, and in these by `rank`: what is removed while it is counted goes last.
    """

    section: str
    text: str
    note: str | None = None
    group: str = ""
    rank: int = 0


@dataclass(frozen=True, slots=True)
class Pair:
    """An element of a part and what is otherwise in the merged model; `select` is how the recipe selects it."""

    select: str
    item: Item
    each: Instance
    changes: dict[str, str | None]
    moved: dict[str, str]


@dataclass(frozen=True, slots=True)
class Changed:
    """An attribute that the merged model says otherwise than the parts.

    `kind` and `name` are those of the element or, for `count` elements that have it from there, of the class. `before`
    and `after` are as they are written, None where nothing is.
    """

    kind: str
    name: str
    attribute: str
    before: str | None
    after: str | None
    unit: str = ""
    count: int = 1


Names = dict[str, dict[str, str]]
"""By kind what a part's elements are called in the merged model, where that is not their name with the prefix."""


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

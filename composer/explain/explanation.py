"""Explanations of an element or an attribute, as plain data for text and JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Literal

from composer.dataclass import dataclass
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Reason:
    """A reason in words, and the place where it is written."""

    words: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Changed:
    """A changed attribute: values as MJCF text, None if it is not written."""

    attribute: str | None
    before: str | None
    after: str | None
    reason: Reason


@dataclass(frozen=True, slots=True)
class Given:
    """An attribute that a default class gives to an element."""

    attribute: str
    value: str
    by: str
    span: Span | None


@dataclass(frozen=True, slots=True)
class ClassStep:
    """A default class that reaches an element."""

    name: str
    reason: Reason


@dataclass(frozen=True, slots=True)
class Listed:
    """One of several elements; `value` is the value of an attribute, or the start tag."""

    label: str
    value: str | None
    reason: Reason


@dataclass(frozen=True, slots=True)
class RowExplained:
    """Numbers of a keyframe that belong to one joint, actuator or mocap body and have one origin.

    `origin` says where they come from: `file`, `entry` (of a `keyframe` section), `edit`, `reference`
    (configuration), `zero`, `mujoco` or `unknown`. `written` is the text at the place in `reason`. `on_the_way` has
    everything that passed the numbers on or changed them, in order.
    """

    label: str
    value: str
    origin: str
    reason: Reason
    written: str | None
    on_the_way: tuple[Reason, ...]


@dataclass(frozen=True, slots=True)
class ElementExplained:
    """An element of the model, and how it came to be as it is.

    `written` are the places where it was read or created, several if elements were merged; `end_line` is the last
    line of the first start tag. `parts` are the parts that it belongs to, the innermost first. `sets` lists what a
    default class sets for each kind of element.
    """

    label: str
    text: str
    holder: str | None
    written: tuple[Reason, ...]
    end_line: int | None
    parts: tuple[Reason, ...]
    changes: tuple[Changed, ...]
    in_force: Reason | None
    classes: tuple[ClassStep, ...]
    given: tuple[Given, ...]
    sets: tuple[Listed, ...]


@dataclass(frozen=True, slots=True)
class LevelExplained:
    """One place that an attribute may come from.

    If it `wins`, its text is in effect, or only `part_of_it`: a shorter list leaves the remaining numbers to the
    next level that has them. The text is written at `span`, apart from the `changes`; if there are `words`, these
    say where it came from instead.
    """

    kind: Literal["element", "class", "mujoco"]
    name: str
    text: str | None
    wins: bool
    part_of_it: str | None
    span: Span | None
    changes: tuple[Changed, ...]
    words: str = ""


@dataclass(frozen=True, slots=True)
class AttributeExplained:
    """One attribute of an element: the value in effect, and every level that it may come from, the nearest first.

    `about` is the grammar's description of the attribute. `rows` lists the numbers of a keyframe by their owners.
    """

    label: str
    attribute: str
    value: str | None
    levels: tuple[LevelExplained, ...]
    in_force: Reason | None
    about: str | None
    rows: tuple[RowExplained, ...]
    notes: tuple[str, ...]


Explained = ElementExplained | AttributeExplained | tuple[Listed, ...]


def as_data(explained: Explained) -> dict[str, Any]:
    """Return the explanation as JSON data; `explains` says which of the three kinds it is."""
    if isinstance(explained, tuple):
        return {"explains": "list", "found": [asdict(each) for each in explained]}
    kind = "element" if isinstance(explained, ElementExplained) else "attribute"
    return {"explains": kind, **asdict(explained)}

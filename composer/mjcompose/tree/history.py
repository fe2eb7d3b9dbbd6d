"""Elements, attributes and words of attributes that each version of MuJoCo can read."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import Struct
from mjcompose.tree.grammar import GRAMMAR, exists_in, to_text, version_key

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

Span = tuple[str | None, str | None]
_BODIES = ("worldbody", "body", "frame", "replicate")
_CONTENT = ("frame", "replicate")

_ROWS: tuple[tuple[str, str, str, str | None, str | None], ...] = (
    ("option", "integrator", "discrete", "3.13.0", None),
    ("body/flexcomp", "dof", "quadratic", "3.4.0", None),
    ("body/flexcomp/edge", "equality", "vert", "3.5.0", "3.17.0"),
    ("body/flexcomp/edge", "equality", "strain", "3.6.0", None),
    ("visual/headlight", "active", "true false auto 2", "4.0.0", None),
    ("body/site default/site", "type", "mesh", "3.13.0", None),
    ("actuator/dcmotor default/dcmotor", "input", "pos vel ff none", "3.12.0", None),
    ("actuator/dcmotor default/dcmotor", "input", "position velocity", None, "3.11.0"),
    ("asset/mesh", "builtin", "grid box cylinder ellipsoid square disc", "3.16.0", None),
    ("sensor/contact", "data", "linvel angvel", "3.16.0", None),
    ("actuator/general default/general", "dyntype gaintype biastype", "dcmotor", "3.7.0", None),
    ("actuator/general default/general", "dyntype gaintype", "pid", "3.12.0", None),
    ("body/composite", "type", "box cylinder ellipsoid", None, "3.2.4"),
    ("body/composite", "type", "rope loop", None, "3.2.5"),
    ("body/composite", "type", "grid particle", None, "3.2.7"),
)
WORDS: dict[str, Span] = {
    f"{place}@{name}={word}": (since, until)
    for places, names, words, since, until in _ROWS
    for place, name, word in product(places.split(), names.split(), words.split())
}
"""Words that some versions do not know although they know the attribute."""

_SPRINGY = ("body/joint", "default/joint", "tendon/spatial", "tendon/fixed", "default/tendon")
LONGER = {f"{place}@{name}": "3.7.0" for place in _SPRINGY for name in ("stiffness", "damping")}
"""Numbers that may be lists since that version."""


RELEASED = tuple(
    """
    3.0.0 3.0.1 3.1.0 3.1.1 3.1.2 3.1.3 3.1.4 3.1.5 3.1.6 3.2.0 3.2.1 3.2.2 3.2.3 3.2.4 3.2.5 3.2.6 3.2.7
    3.3.0 3.3.1 3.3.2 3.3.3 3.3.4 3.3.5 3.3.6 3.3.7 3.4.0 3.5.0 3.6.0 3.7.0 3.8.0 3.8.1 3.9.0 3.10.0 3.11.0
    3.12.0 3.13.0 3.14.0 3.15.0 3.16.0 3.17.0 4.0.0
    """.split()
)


def release(text: str) -> str | None:
    """Return a release: for `3.1`, the last one; None for a version that does not exist.

    >>> release("3.1"), release("3.2.3"), release("4"), release("2.3")
    ('3.1.6', '3.2.3', '4.0.0', None)
    """
    wanted = version_key(text)
    return next((each for each in RELEASED[::-1] if wanted and version_key(each)[: len(wanted)] == wanted), None)


class Unread(Struct):
    """A feature that a version does not read: an element (`attribute` None), an attribute, or its `value`."""

    node: Node
    attribute: str | None
    value: str | None
    since: str | None
    until: str | None

    @property
    def called(self) -> str:
        if self.attribute is None:
            return f"`<{self.node.tag}>`"
        written = f"`{self.attribute}`" if self.value is None else f'`{self.attribute}="{self.value}"`'
        return f"{written} of `<{self.node.tag}>`"

    def when(self) -> str:
        """The versions that have it."""
        return f"MuJoCo has it since {self.since}" if self.since else f"MuJoCo had it up to {self.until}"


@cache
def spans() -> dict[str, Span]:
    """First and last version of elements, attributes and words; made by `tests/tools/migrate/survey.py`."""
    text = (Path(__file__).parent / "history.json").read_text(encoding="utf-8")
    return {name: (since, until) for name, (since, until) in json.loads(text)["spans"].items()}


def place(node: Node) -> str:
    """Return the place of an element in the form of the tables: `body/geom`, also inside a frame or a replicate."""
    above = [str(each.tag) for each in node.iterancestors() if each.tag != "mujoco"][::-1]
    tags = [*("body" if tag in _BODIES else tag for tag in above), str(node.tag)]
    if tags[0] == "worldbody":
        tags[0] = "body"
    while len(tags) > 1 and tags[0] == tags[1] and tags[0] in ("body", "default"):
        del tags[0]
    return tags[-1] if len(tags) > 1 and tags[-1] in _CONTENT else "/".join(tags)


def unread(root: Node, version: str) -> Iterator[Unread]:
    """Everything in a tree that this version of MuJoCo lacks; of nested elements, only the outermost."""
    known = spans()
    waiting = list(reversed(list(root.iterchildren("*"))))
    while waiting:
        node = waiting.pop()
        path = place(node)
        if path in known and not exists_in(version, *known[path]):
            yield Unread(node, None, None, *known[path])
            continue
        yield from _attributes(node, path, version)
        waiting.extend(reversed(list(node.iterchildren("*"))))


def _attributes(node: Node, path: str, version: str) -> Iterator[Unread]:
    known = spans()
    for name, value in [(str(name), str(value)) for name, value in node.items()]:
        span = known.get(f"{path}@{name}")
        if span is not None and not exists_in(version, *span):
            yield Unread(node, name, None, *span)
            continue
        for word in value.split():
            span = WORDS.get(f"{path}@{name}={word}")
            if span is not None and not exists_in(version, *span):
                yield Unread(node, name, word, *span)
        since = LONGER.get(f"{path}@{name}")
        if since is not None and len(value.split()) > 1 and not exists_in(version, since, None):
            yield Unread(node, name, value, since=since, until=None)


def default_of(path: str, attribute: str) -> str | None:
    """Return the grammar's default of an attribute as text."""
    try:
        kind = GRAMMAR.element(path.removeprefix("body/") if path != "body" else "body")
    except KeyError:
        return None
    known = kind.attributes.get(attribute)
    return None if known is None or known.default is None else to_text(known, known.default)

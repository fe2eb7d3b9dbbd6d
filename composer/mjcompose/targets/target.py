"""The definition of a target, its limits, and losses."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.words import after_noun
from mjcompose.tree.files import file_attributes
from mjcompose.tree.xml_text import write

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


class FeatureOutcome(StrEnum):
    KEPT = "written"
    WRITTEN = "written otherwise"
    PARTLY = "partly"
    LEFT_OUT = "left out"
    SOME_REFUSED = "some refused"
    REFUSED = "refused"


class Loss(Struct):
    """An element that a target cannot express, and its treatment.

    `feature` is a row of the table of features. `kind` and `number` identify the element in the compiled model, `tag`
    and `name` are for messages. `what` names the part of the element that is left out; it is empty for the element
    itself. `why` is a remark, or the sentence about the element if it is refused or written in another form. If an
    element is refused, no model is written.
    """

    feature: str
    kind: str
    number: int
    tag: str
    name: str
    why: str = ""
    what: str = ""
    outcome: str = FeatureOutcome.LEFT_OUT
    help: str | None = None

    @property
    def refused(self) -> bool:
        return self.outcome == FeatureOutcome.REFUSED

    @property
    def otherwise(self) -> bool:
        """Whether the target gets the same model, written in another way."""
        return self.outcome == FeatureOutcome.WRITTEN

    @property
    def shown(self) -> str:
        return f"{self.tag}{after_noun(self.name)}"


_PLURALS = {
    "body": "bodies",
    "equality": "equality constraints",
    "key": "keyframes",
    "flex": "flexes",
    "pair": "contact pairs",
    "exclude": "excluded contacts",
    "mesh": "meshes",
}
_SINGULARS = {
    "equality": "equality constraint",
    "key": "keyframe",
    "pair": "contact pair",
    "exclude": "excluded contact",
}
_NAMED = 3
OPTION = "option"


def grouped(losses: Iterable[Loss]) -> Iterator[list[Loss]]:
    """Yield the losses of one kind together, in their order."""
    groups: dict[tuple[str, ...], list[Loss]] = {}
    for loss in losses:
        groups.setdefault((loss.outcome, loss.feature, loss.what, loss.why, loss.kind or loss.tag), []).append(loss)
    yield from groups.values()


def in_words(title: str, group: list[Loss]) -> str:
    """Return a sentence about losses of one kind: their number, and the first names.

    >>> in_words("Pinocchio", [Loss("damping", "joint", n, "joint", f"j{n}", what="damping") for n in range(5)])
    'Pinocchio ignores damping of 5 joints: `j0`, `j1`, `j2` and 2 more'
    """
    first = group[0]
    kind = first.kind or first.tag
    counted = OPTION
    if kind != OPTION:
        word = _SINGULARS.get(kind, kind) if len(group) == 1 else _PLURALS.get(kind, f"{kind}s")
        names = [f"`{each.name}`" for each in group if each.name]
        shown = names if len(names) <= _NAMED + 1 else [*names[:_NAMED]]
        listed = f": {', '.join(shown)}" if names else ""
        counted = f"{len(group)} {word}{listed}" + (f" and {len(names) - _NAMED} more" if shown != names else "")
    if first.otherwise:
        return f"{title} gets {counted} in another form: {first.why}"
    if first.refused:
        return f"{counted}: {first.why}"
    of = f"{first.what} of " if first.what else ""
    if first.tag == OPTION and first.what:
        counted = first.what
        of = ""
    return f"{title} ignores {of}{counted}" + (f"; {first.why}" if first.why else "")


class Draft(Struct, frozen=False):
    """The plain text of a model with its files, and the compiled model itself.

    `elements` has the elements of the text by kind, in the order of the compiled model. `files` has the content of the
    files that the text names, by path. The limits of a target change `root` and record the losses in `losses`.
    `rows` has the kind and the number of each element.
    """

    mujoco: Any
    model: MjModel
    root: Node
    files: dict[str, bytes]
    elements: Mapping[str, Sequence[Node]]
    losses: list[Loss] = field(default_factory=list)
    output: str = "model.xml"
    mujoco_reads: bool = True
    rows: dict[Node, tuple[str, int]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        for kind, nodes in self.elements.items():
            self.rows.update((node, (kind, number)) for number, node in enumerate(nodes))

    def lose(
        self,
        feature: str,
        node: Node,
        why: str = "",
        *,
        what: str = "",
        outcome: FeatureOutcome = FeatureOutcome.LEFT_OUT,
        help: str | None = None,
    ) -> None:
        """Record that the target cannot express an element, or the part `what` of it."""
        row = self.rows.get(node, ("", -1))
        tag = str(node.tag)
        name = str(node.get("name") or "")
        self.losses.append(Loss(feature, *row, tag, name, why=why, what=what, outcome=outcome, help=help))

    def remove(self, node: Node) -> None:
        """Remove an element, and its section if it becomes empty."""
        holder = node.getparent()
        if holder is not None:
            holder.remove(node)
            if not len(holder) and holder.tag in _SECTIONS and holder.getparent() is not None:
                self.remove(holder)

    def of(self, kind: str) -> Iterator[tuple[int, Node]]:
        """Yield the elements of a kind that are still in the text, with their numbers in the compiled model."""
        yield from self._left(kind, range(len(self.elements[kind])))

    def of_body(self, kind: Literal["geom", "joint"], body: int) -> Iterator[tuple[int, Node]]:
        """Yield the elements of a kind in one body that are still in the text, with their numbers in the model."""
        firsts, counts = _RANGES[kind]
        first = int(getattr(self.model, firsts)[body])
        count = int(getattr(self.model, counts)[body])
        yield from self._left(kind, range(first, first + count))

    def _left(self, kind: str, numbers: Iterable[int]) -> Iterator[tuple[int, Node]]:
        nodes = self.elements[kind]
        for number in numbers:
            if any(above is self.root for above in nodes[number].iterancestors()):
                yield number, nodes[number]


_RANGES = {"geom": ("body_geomadr", "body_geomnum"), "joint": ("body_jntadr", "body_jntnum")}
"""The arrays with the first geom or joint of each body, and with their number. MuJoCo numbers them body by body."""


_SECTIONS = (
    "actuator",
    "sensor",
    "equality",
    "tendon",
    "contact",
    "keyframe",
    "asset",
    "custom",
    "deformable",
    "extension",
)


def write_mjcf(draft: Draft) -> dict[str, bytes]:
    """Return the text and the files that it names, by path."""
    etree.indent(draft.root)
    named = {name for _, _, name in file_attributes(draft.root)}
    files = {path: content for path, content in draft.files.items() if path in named}
    return {draft.output: write(draft.root), **files}


class UnsupportedElement(Struct):
    """An element of a compiled model that a simulator does not accept; the kind of its options is `option`."""

    kind: str
    number: int
    why: str
    help: str


class Limit(Struct):
    """A feature that a target does not support. `apply` changes the draft and records each loss.

    `refuses` yields the elements of a compiled model (after MuJoCo, as its second argument) that a simulator refuses,
    for simulators that take MuJoCo's own `mjModel`.
    """

    feature: str
    outcome: FeatureOutcome
    apply: Callable[[Draft], None]
    refuses: Callable[[Any, Any], Iterator[UnsupportedElement]] | None = None


class Target(Struct):
    """A program that reads models, or a form in which models are written.

    `words` describe it. `package` is the package on PyPI with which it is tested, or None. `limits` are its limits, in
    the order in which they change the model. `write` returns the remaining text and files, by path.
    """

    name: str
    words: str
    limits: tuple[Limit, ...]
    write: Callable[[Draft], dict[str, bytes]]
    package: str | None = None

    @property
    def title(self) -> str:
        """Return the name of the program in sentences: `MuJoCo Warp`."""
        return self.words.partition(",")[0]

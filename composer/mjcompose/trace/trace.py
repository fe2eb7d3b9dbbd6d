"""The history of every element and key during composition.

It comes from the journal: every pass and step records its changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import field, replace
from itertools import pairwise
from types import FunctionType
from typing import Literal, NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.link import numbers
from mjcompose.link.expansion import element_of
from mjcompose.link.key_layout import KeyLayout, Unknown, lay_out
from mjcompose.link.linking import AttachedPart, Linking, Part
from mjcompose.link.unit_keys import VECTORS as VECTORS
from mjcompose.plan.steps import DrawValues, EditElements
from mjcompose.tree import journal
from mjcompose.tree.journal import PARENT, SOURCE, TAG as TAG, Why
from mjcompose.tree.unit import KeySource, Number, Origins, Place, Unit, line_of

Owner = str | Span | Place
Function = Callable[..., object]


class TracedOperation(Struct):
    """The operation, as reported to the `Watch`, and the tree and part in which it changed something."""

    done: object
    unit: Unit
    part: Part | None = None
    linking: Linking | None = None

    @property
    def function(self) -> Function | None:
        """The pass or other function that ran; None for a step, a source or a plan."""
        return self.done if isinstance(self.done, FunctionType) else None

    @property
    def is_pass(self) -> bool:
        return callable(self.done)


class AttributeChange(Struct):
    """A new value of an attribute or of `TAG`; None if it is not written. `owner` knows its place."""

    attribute: str
    before: str | None
    after: str | None
    cause: TracedOperation
    owner: Owner
    why: Why | None = None


class ParentChange(Struct):
    """A new parent."""

    before: Node | None
    after: Node | None
    cause: TracedOperation
    why: Why | None = None


class Life(Struct, frozen=False, eq=False):
    """Everything known about one element: its first state, its changes, and its end.

    `born` is the cause after which it was first seen. `made_by` is the same cause, or None for an element that was read
    from a file. `home` is the root of the tree that it was last seen in. `parts` are the parts that it belongs to, the
    innermost first. `sources` are the elements that it replaces. `whys` has the recorded reasons of a new element: for
    its place under `PARENT`, and for its attributes. `why_gone` is the reason of its end.
    """

    node: Node
    root: Node
    owner: Owner
    line: int | None
    tag: str
    attributes: dict[str, str]
    parent: Node | None
    home: Node
    made_by: TracedOperation | None
    born: TracedOperation
    changes: list[AttributeChange | ParentChange] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    sources: list[Life] = field(default_factory=list)
    gone: TracedOperation | None = None
    whys: dict[str, Why | None] = field(default_factory=dict)
    why_gone: Why | None = None
    items: list[tuple[str, str]] = field(default_factory=list)
    last_tag: str = ""
    last_parent: Node | None = None

    def span(self, origins: Origins, attribute: str | None = None, owner: Owner | None = None) -> Span:
        """Return where the element was first written, or the value of an attribute there."""
        owner = self.owner if owner is None else owner
        if isinstance(owner, Span):
            return owner
        if not isinstance(owner, str):
            return owner(attribute)
        return origins.in_file(owner, self.line, self.tag, written=self.attributes, attribute=attribute)

    @property
    def naming(self) -> str:
        """The attribute with the name."""
        return "class" if self.tag == "default" else "name"

    @property
    def name(self) -> str | None:
        return self.attributes.get(self.naming)

    def of(self, attribute: str) -> list[AttributeChange]:
        return [each for each in self.changes if isinstance(each, AttributeChange) and each.attribute == attribute]


class NetChange(NamedTuple):
    """The value of an attribute, a tag or a parent before its first change and after its last change."""

    before: str | Node | None
    after: str | Node | None
    why: Why | None

    @property
    def is_other(self) -> bool:
        return self.before is not self.after and self.before != self.after


class ReplacedElement(NamedTuple):
    """An element that a new one replaces or copies, and the reason why the new one differs from it."""

    node: Node
    why: Why | None


class RecordSummary:
    """The sum of a record: changes by element and attribute, `TAG` or `PARENT`, and the sources of new elements."""

    def __init__(self, record: Iterable[journal.TreeChange]) -> None:
        self.changes: dict[Node, dict[str, NetChange]] = {}
        self.sources: dict[Node, list[ReplacedElement]] = {}
        for change in record:
            is_element = isinstance(change.node.tag, str)  # a comment has a function
            if not is_element:
                continue
            if change.what == SOURCE:
                assert change.after is not None and not isinstance(change.after, str)
                self.sources.setdefault(change.node, []).append(ReplacedElement(change.after, change.why))
                continue
            rows = self.changes.setdefault(change.node, {})
            known = rows.get(change.what)
            before = change.before if known is None else known.before
            rows[change.what] = NetChange(before, change.after, change.why or (known and known.why))


def top_of(node: Node) -> Node:
    """Return the root of the tree that an element is in now."""
    # lxml's `getroottree` of an element that was removed still answers with the tree that it was in.
    while (holder := node.getparent()) is not None:
        node = holder
    return node


def as_text(value: str | Node | None) -> str | None:
    assert value is None or isinstance(value, str)
    return value


class Trace:
    """A `Watch` that reads the journal. It keeps a reference to every node, so identities stay valid.

    Compose the model in a block `with trace.recording():`.
    """

    def __init__(self) -> None:
        self.lives: dict[Node, Life] = {}
        self.gone: list[Life] = []
        self._record: list[journal.TreeChange] = []
        self._roots: set[Node] = set()
        self._linkings: dict[Node, Linking] = {}
        self._parts: dict[Node, Part] = {}
        self._linking_of: dict[Part, Linking] = {}
        self._joined: dict[Node, Node] = {}
        self._indexed: tuple[Linking, _Carriers] | None = None

    def recording(self) -> AbstractContextManager[None]:
        """Record the changes of the models that are composed in the block."""
        return journal.recording(self._record)

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        units = list(units)
        self._indexed = None
        if isinstance(done, Linking):
            self._note_parts(done)
        linking = self._linkings.get(units[0].root)
        causes = {each.root: TracedOperation(done, each, self._parts.get(each.root), linking=linking) for each in units}
        record = tuple(self._record)
        self._record.clear()
        born = {life.node: life for unit in units for life in self._read(unit, causes[unit.root])}
        summary = RecordSummary(record)
        if summary.changes:
            self._take(summary, causes, born)

    def attachment(self, part: Part) -> AttachedPart | None:
        """Return where a part is attached, or None if it is not attached."""
        linking = self._linking_of.get(part)
        return None if linking is None else linking.attachments.get(part)

    def _note_parts(self, linking: Linking) -> None:
        self._linkings[linking.base.root] = linking
        for part in linking.parts:
            self._parts[part.unit.root] = part
            self._linking_of[part] = linking
            for node in part.unit.root.iter("*"):
                self.lives[node].parts.append(part)
        by_root = {part.unit.root: part for part in linking.parts}
        for life in self.gone:  # `drop`, `subtree` and edits of the part have removed them before
            if (part_of_it := by_root.get(self._joined.get(life.home, life.home))) is not None:
                life.parts.append(part_of_it)
        self._joined |= {root: linking.base.root for root, into in self._joined.items() if into in by_root}
        self._joined |= dict.fromkeys(by_root, linking.base.root)

    def _read(self, unit: Unit, cause: TracedOperation) -> list[Life]:
        """Note the elements of a unit that is seen for the first time."""
        if unit.root in self._roots:
            if not journal.is_recording(self._record):
                raise RuntimeError("a model was composed outside the block `with trace.recording():`")
            return []
        self._roots.add(unit.root)
        return [self._born(node, cause) for node in unit.root.iter("*") if node not in self.lives]

    def _take(self, summary: RecordSummary, causes: Mapping[Node, TracedOperation], born: dict[Node, Life]) -> None:
        """Note the changes of a pass or step."""
        tops = {node: top_of(node) for node, rows in summary.changes.items() if PARENT in rows}
        for node, top in tops.items():
            if top in causes:
                born |= {life.node: life for life in self._appear(node, causes[top], summary)}
            else:
                self._end(node, causes, summary.changes[node][PARENT].why)
        lives = {node: self.lives[node] for node in summary.changes if node in self.lives and node not in born}
        present = {node: life for node, life in lives.items() if life.gone is None}
        any_cause = next(iter(causes.values()))
        causes_of = {node: causes.get(life.home, any_cause) for node, life in present.items()}
        for node, life in present.items():
            self._note_attributes(life, summary.changes[node], causes_of[node], causes)
        for node in tops:
            if node in present:
                self._note_move(present[node], summary.changes[node][PARENT], causes_of[node], tops[node])
        for node, life in born.items():
            self._note_sources(life, summary.sources.get(node, []))

    def _appear(self, node: Node, cause: TracedOperation, summary: RecordSummary) -> Iterator[Life]:
        """Note the elements in a tree that are new, or there again."""
        for each in node.iter("*"):
            life = self.lives.get(each)
            if life is None:
                life = self._born(each, cause)
                life.whys = {what: change.why for what, change in summary.changes.get(each, {}).items()}
                around = (summary.changes.get(above, {}) for above in (each, *each.iterancestors()))
                life.whys[PARENT] = next(rows[PARENT].why for rows in around if PARENT in rows)
                yield life
            elif life.gone is not None:
                life.gone = None
                self.gone.remove(life)

    def _end(self, node: Node, causes: Mapping[Node, TracedOperation], why: Why | None) -> None:
        """Note the elements that left the model."""
        for each in node.iter("*"):
            life = self.lives.get(each)
            if life is not None and life.gone is None:
                life.gone = causes.get(life.home, next(iter(causes.values())))
                life.why_gone = why
                self.gone.append(life)

    def _note_attributes(
        self, life: Life, rows: Mapping[str, NetChange], cause: TracedOperation, causes: Mapping[Node, TracedOperation]
    ) -> None:
        items: list[tuple[str, str]] = life.node.items()  # type: ignore[assignment]  # of a parsed tree
        unit = causes.get(top_of(life.node), cause).unit
        owner = unit.origins.owner(life.node, unit.file)
        for what in dict.fromkeys((TAG, *(name for name, _ in (*life.items, *items)))):
            # A step writes its value even where the element has the same one already.
            if what in rows and (rows[what].is_other or not cause.is_pass):
                before, after, why = rows[what]
                life.changes.append(AttributeChange(what, as_text(before), as_text(after), cause, owner, why))
        life.items = items
        life.last_tag = str(life.node.tag)

    def _note_move(self, life: Life, change: NetChange, cause: TracedOperation, top: Node) -> None:
        parent = life.node.getparent()
        if parent is not life.last_parent:
            life.changes.append(ParentChange(life.last_parent, parent, cause, change.why))
            life.last_parent = parent
        if life.home is not top:
            for each in life.node.iter("*"):
                self.lives[each].home = top

    def _note_sources(self, life: Life, sources: list[ReplacedElement]) -> None:
        """Link an element that a pass wrote again to the elements that it replaces."""
        if life.made_by is None or not life.made_by.is_pass:
            return
        known = [source for source in sources if source.node in self.lives]
        life.sources += [self.lives[source.node] for source in known]
        if len(known) == 1:
            life.changes += _differences(dict(life.sources[0].items), life, known[0].why)

    def life(self, node: Node) -> Life:
        return self.lives[node]

    def _born(self, node: Node, cause: TracedOperation) -> Life:
        owner = cause.unit.origins.owner(node, cause.unit.file)
        laid_out = node in cause.unit.origins.keys  # by the edits of a part that is not linked to anything yet
        made = cause if cause.linking is not None or laid_out else None
        items: list[tuple[str, str]] = node.items()  # type: ignore[assignment]  # of a parsed tree
        parent = node.getparent()
        root = cause.unit.root
        life = Life(
            node,
            root,
            owner,
            line=line_of(node),
            tag=str(node.tag),
            attributes=dict(items),
            parent=parent,
            home=root,
            made_by=made,
            born=cause,
            items=items,
            last_tag=str(node.tag),
            last_parent=parent,
        )
        self.lives[node] = life
        part = cause.part or (self._carriers(cause.linking).of(life) if cause.linking is not None else None)
        if part is not None and made is not None and made.is_pass:
            life.made_by = TracedOperation(cause.done, part.unit, part, linking=cause.linking)
            life.parts.append(part)
        return life

    def _carriers(self, linking: Linking) -> _Carriers:
        """Return the index of the parts of a linking, which get their classes and places from pass to pass."""
        if self._indexed is None or self._indexed[0] is not linking:
            self._indexed = linking, _Carriers(linking)
        return self._indexed[1]


def _differences(before: dict[str, str], life: Life, why: Why | None) -> Iterator[AttributeChange]:
    """Yield the changes from another element to a new one that replaces it, with the reasons of the new one."""
    assert life.made_by is not None
    after = life.attributes
    for name in {**before, **after}:
        if before.get(name) != after.get(name):
            own = why or life.whys.get(name) or life.whys.get(PARENT)
            yield AttributeChange(name, before.get(name), after.get(name), life.made_by, life.owner, own)


class _Carriers:
    """The parts of a linking by the class and by the lines of the recipe that their frames and sensors have."""

    def __init__(self, linking: Linking) -> None:
        self.parts = linking.parts
        self._by_class: dict[str, int] = {}
        self._by_owner: dict[Owner, int] = {}
        for number, part in enumerate(linking.parts):
            if part.unit in linking.top_classes:
                self._by_class.setdefault(linking.top_class(part.unit), number)
            if part.span is not None:
                self._by_owner.setdefault(part.span, number)
                if part.sense is not None and part.sense.span is not None:
                    self._by_owner.setdefault(part.sense.span, number)

    def of(self, life: Life) -> Part | None:
        """Return the part for which the linker created an element, such as the frame of its attachment."""
        class_name = life.attributes.get({"frame": "childclass", "default": "class"}.get(life.tag, ""))
        numbers = (self._by_class.get(class_name or ""), self._by_owner.get(life.owner))
        first = min((number for number in numbers if number is not None), default=None)
        return None if first is None else self.parts[first]


Kind = Literal["file", "entry", "edit", "reference", "zero", "mujoco", "unknown"]


class NumberOrigin(Struct):
    """The origin of numbers in a key. - `file`: a `<key>` of a file writes them.
    - `entry`: an entry of a `keyframe` section of a recipe writes them.
    - `edit`: an edit or a draw of a recipe made them: `change`.
    - `reference`: no source writes them, and they are the reference configuration: `zero` if they are 0.
    - `mujoco`: the row of the key at `span` is too short, and MuJoCo filled in the missing numbers.
    - `unknown`.

    `span` is the place of the numbers themselves if that is known; `written` is the text there. `taken` are the
    `from` entries of recipes that passed them on. `moved` are the parts whose place changed them, each with the
    place of its attachment. `lost` is the origin of numbers in a key that edits made meaningless. `joint` is the
    joint from whose number a control follows.
    """

    kind: Kind
    span: Span | None = None
    written: str | None = None
    taken: tuple[Span, ...] = ()
    moved: tuple[tuple[str, Span | None], ...] = ()
    change: AttributeChange | None = None
    lost: NumberOrigin | None = None
    joint: str | None = None


class Row(NamedTuple):
    """Numbers of one joint, actuator or mocap body that have one origin."""

    holder: Node
    numbers: str
    origin: NumberOrigin


def rows(model: Unit, key: Node, vector: str, trace: Trace) -> list[Row]:
    """Return at least one row for each owner of numbers; none if only MuJoCo knows their layout."""
    reading = _Reading(model, trace)
    known = reading.settled(key, vector)
    layout = _layout(model, trace.life(key))
    owners = [] if layout is None else layout.holders(vector)
    if not known or sum(width for _, width in owners) != len(known):
        return []
    found = []
    at = 0
    for holder, width in owners:
        found += [
            Row(element_of(holder), " ".join(each.number.text for each in run), reading.origin(run))
            for run in _runs(known[at : at + width])
        ]
        at += width
    return found


def key_origins(model: Unit, key: Node, attribute: str, trace: Trace) -> list[NumberOrigin]:
    """Return the origins of all numbers in an attribute of a key, including `time`, in order."""
    reading = _Reading(model, trace)
    return [reading.origin(run) for run in _runs(reading.settled(key, attribute))]


class _Known(NamedTuple):
    """A number of a key, and the edit or draw that made it, if any."""

    number: Number
    change: AttributeChange | None = None


class _Reading:
    """Reads the linker's records of keys, and the observed changes to them."""

    def __init__(self, model: Unit, trace: Trace) -> None:
        self.model = model
        self.trace = trace
        self.known: dict[tuple[Node, str], list[_Known]] = {}

    def settled(self, key: Node, vector: str) -> list[_Known]:
        """Return the numbers of a key, each with the file attribute, entry or edit that it comes from."""
        return [self._settled(each) for each in self._numbers(key, vector)]

    def _settled(self, known: _Known) -> _Known:
        source = known.number.source
        if known.change is not None or source.key not in self.trace.lives or source.kind not in ("key", "edited"):
            return known
        assert source.key is not None
        if source.kind == "key" and self._noted(source.key, source.vector) is not None:
            return known  # as in the file: the record shows later values
        there = self._numbers(source.key, source.vector)
        if known.number.at >= len(there):
            return _Known(Number(known.number.text, KeySource("edited", source.vector)))
        found = there[known.number.at]
        if found.number.source is not source:
            if found.number.source.key is not source.key:
                found = self._settled(found)
            ours = source
            theirs = found.number.source
            both = replace(theirs, taken=theirs.taken + ours.taken, moved=theirs.moved + ours.moved, lost=theirs.lost)
            found = _Known(Number(known.number.text, both, found.number.at), found.change)
        return found

    def _noted(self, key: Node, vector: str) -> list[Number] | None:
        record = self.model.origins.keys.get(key)
        return None if record is None else record.numbers.get(vector)

    def _numbers(self, key: Node, vector: str) -> list[_Known]:
        """Return the numbers of an element from the linker's notes, updated by later edits and draws."""
        if (key, vector) not in self.known:
            life = self.trace.life(key)
            noted = self._noted(key, vector)
            if noted is None:
                noted = _numbered(life.attributes.get(vector, ""), KeySource("key", vector, key))
            changes = [each for each in life.of(vector) if isinstance(each.cause.done, EditElements | DrawValues)]
            now = str(key.get(vector) or "")
            self.known[key, vector] = _after(list(map(_Known, noted)), now, changes, vector=vector)
        return self.known[key, vector]

    def origin(self, run: list[_Known]) -> NumberOrigin:
        first = run[0]
        last = run[-1]
        source = first.number.source
        lost = None if source.lost is None else self._of(source.lost.source, (source.lost.at, source.lost.at))
        found = self._of(source, (first.number.at, last.number.at))
        if first.change is not None:
            found = NumberOrigin("edit", change=first.change)
        text = " ".join(each.number.text for each in run)
        if found.written is not None and not source.moved and numbers.read(found.written) != numbers.read(text):
            found = NumberOrigin("unknown")
        return replace(found, taken=source.taken, moved=source.moved, lost=lost, joint=source.joint)

    def _of(self, source: KeySource, at: tuple[int, int]) -> NumberOrigin:
        if source.kind == "entry":
            return NumberOrigin("entry", source.span)
        if source.kind in ("reference", "zero"):
            return NumberOrigin("reference" if source.kind == "reference" else "zero")
        life = None if source.key is None else self.trace.lives.get(source.key)
        if life is None or (source.kind == "edited"):
            return NumberOrigin("unknown")
        span = life.span(self.model.origins, source.vector)
        if source.kind == "mujoco":
            return NumberOrigin("mujoco", span)
        if not isinstance(life.owner, str):  # a recipe writes the key, by `mirror`
            return NumberOrigin("entry", span)
        return self._in_file(source, at, life) or NumberOrigin("file", span)

    def _in_file(self, source: KeySource, at: tuple[int, int], life: Life) -> NumberOrigin | None:
        """Return the place of the numbers themselves if they are on one line."""
        if not isinstance(life.owner, str) or life.line is None:
            return None
        text = self.model.origins.text(life.owner)
        found = None if text is None else text.items(life.tag, life.line, life.attributes, source.vector, *at)
        if found is None:
            return None
        first, last, words = found
        span = Span(life.owner, first.line, first.column, end_line=last.line, end_column=last.end_column)
        return NumberOrigin("file", span, " ".join(words.split()))


def _after(known: list[_Known], now: str, changes: list[AttributeChange], vector: str) -> list[_Known]:
    """Apply the changes of recipe steps to the numbers; numbers that no step accounts for become unknown."""
    source = KeySource("edited", vector)
    for change in changes:
        before = (change.before or "").split()
        made = [_Known(each, change) for each in _numbered(change.after or "", source)]
        if len(made) == len(before) and [each.number.text for each in known] == before:
            pairs = zip(known, made, strict=True)
            made = [old if old.number.text == new.number.text else new for old, new in pairs]
        if made or not now:
            known = made
    is_known = [each.number.text for each in known] == now.split()
    return known if is_known else list(map(_Known, _numbered(now, source)))


def _numbered(text: str, source: KeySource) -> list[Number]:
    return [Number(each, source, at) for at, each in enumerate(text.split())]


def _layout(model: Unit, life: Life) -> KeyLayout | None:
    """Return the layout of a key's numbers: the linker's, or else the layout that the tree implies."""
    linking = None if life.made_by is None else life.made_by.linking
    if linking is not None and linking.keys.final_layout is not None:
        return linking.keys.final_layout
    try:
        return lay_out(model, {})
    except Unknown:
        return None


def _runs(numbers: list[_Known]) -> Iterator[list[_Known]]:
    start = 0
    for at, (before, after) in enumerate(pairwise(numbers), 1):
        source = before.number.source
        is_alike = before.change is after.change and source == after.number.source
        if not is_alike or (source.kind == "key" and after.number.at != before.number.at + 1):
            yield numbers[start:at]
            start = at
    yield from [numbers[start:]] if numbers else []

"""Keys during edits: removed, held, or scaled in vain."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Path, Span
from mjcompose.build.compose.editing import Editing
from mjcompose.build.compose.elements import ElementBuilder
from mjcompose.build.compose.load import FINISHED, keep_finished
from mjcompose.build.plan.plan import Plan
from mjcompose.build.plan.steps import WriteKeyframe
from mjcompose.language.keyframe import CTRL
from mjcompose.language.value import attribute_and_index
from mjcompose.link import numbers
from mjcompose.link.key_layout import Layout
from mjcompose.link.linking import Linking
from mjcompose.link.unit_keys import keys_of
from mjcompose.model.select import kind_of
from mjcompose.model.unit import KeySource, Number, numbers_of, texts
from mjcompose.mujoco import engine
from mjcompose.text.node import locate

if TYPE_CHECKING:
    from mjcompose.sources.context import Context


def zero_attributes(editing: Editing, found: Iterable[Node], keys: Iterable[str]) -> list[str]:
    """Return the attributes, or single numbers of them (`friction[0]`), that are zero on every element."""
    nodes = list(found)
    return [key for key in keys if nodes and all(_is_zero(editing, node, key) for node in nodes)]


def report_only_zeros(editing: Editing, found: Sequence[Node], key: str, at: Path, help: str) -> None:
    """Warn about a factor for a value that is zero on every element."""
    whose = editing.called(found[0]) if len(found) == 1 else f"each of the {len(found)} selected elements"
    message = f"`{key}` of {whose} is 0, and a factor does not change it"
    notes = [Note(f"{editing.called(found[0])} is written here", editing.span_of(found[0]))]
    editing.sink.warning("scale-of-zero", message, editing.span(at), notes=notes, help=help)


def _is_zero(editing: Editing, node: Node, key: str) -> bool:
    name, subscript = attribute_and_index(key)
    attribute = kind_of(node).attributes.get(name)
    if attribute is None or not attribute.is_number:
        return False
    have = numbers.read(editing.effective(node, name) or "")
    those = have if subscript is None else have[subscript : subscript + 1]
    return bool(those) and not any(those)


@contextmanager
def without_keys(root: Node) -> Iterator[None]:
    """Remove the keys from a tree during the block."""
    # MuJoCo 4.0 refuses numbers that are too many for the model as it is: "keyframe 0: invalid ctrl size, expected
    # length 0".
    sections = [(root.index(section), section) for section in root.iterchildren("keyframe")]
    for _, section in sections:
        root.remove(section)
    try:
        yield
    finally:
        for at, section in sections:
            root.insert(at, section)


def hold_poses(
    plan: Plan, linking: Linking, making: ElementBuilder, context: Context, session: engine.Session | None
) -> None:
    """Write the controls, and the activations of filters and integrators, of every key that holds its pose."""
    steps = [step for step in plan.keyframes if step.key.controls.hold or step.key.controls.held]
    layout = linking.keys.final_layout
    if not steps or layout is None:
        return
    with ExitStack() as stack:
        session = session or stack.enter_context(engine.Session())
        if keep_finished(linking, context, session):
            for step in steps:
                _PoseHolder(step, layout, linking, making=making).hold(session)


@dataclass(frozen=True, slots=True)
class _PoseHolder:
    """Writes the controls that hold the pose of one key."""

    step: WriteKeyframe
    layout: Layout
    linking: Linking
    making: ElementBuilder

    def span(self, *path: str) -> Span:
        """Return the place of a control of the key in the recipe."""
        return locate(self.making.document, (*self.step.key.at, CTRL, *path))

    def hold(self, session: engine.Session) -> None:
        from mjcompose.mujoco.controls import hold  # needs numpy, and few keys hold

        name, sink = self.step.key.name, self.making.sink
        keys = list(keys_of(self.linking.base))
        index = next(at for at, key in enumerate(keys) if key.get("name") == name)
        question = {"key": index, "forces": self.step.key.controls.hold == "forces"}
        answer = engine.call(session, hold, [FINISHED], argument=question)
        if not answer.ok:
            message = f"MuJoCo stumbles over the key `{name}`: {answer.error}"
            sink.error("mujoco-crash", message, self.span())
            return
        if left := answer.value["left"]:
            message = f"the actuators cannot hold the key `{name}`: {left:.4g} N or N m are left"
            sink.warning("not-held", message, self.span())
        for vector in ("ctrl", "act"):
            self._write(vector, answer.value, keys[index])

    def _write(self, vector: str, found: Mapping[str, Any], key: Node) -> None:
        """Write the values of the holding actuators into the row of a key."""
        values: list[float | None] = found[vector]
        own = self.step.key
        record = self.linking.base.origins.keys.get(key)
        row = numbers_of(record, key, vector) or [
            Number("0", KeySource("zero", vector), at) for at in range(len(values))
        ]
        singles = {self.span(*path): path for path in own.controls.held}
        hold = self.span("hold")
        given = set(own.values.get(vector, {}))
        controls = dict(enumerate(numbers_of(record, key, "ctrl")))
        changed, unknown = False, []
        for actuator, at, width, control in _addresses(self.layout, vector):
            source = controls[control].source if control in controls else None
            span = None if source is None else source.span
            if span is None or source is None or source.kind != "entry" or span not in (hold, *singles):
                continue
            kind = found["unlike"].get(str(control)) if vector == "ctrl" else None
            if kind and span != hold:
                self._report_no_control(singles[span], kind)
            name = "" if isinstance(actuator, str) else str(getattr(actuator, "get", lambda _: "")("name") or "")
            if kind and span == hold and control in found["unknown"]:
                unknown.append(f"`{name}` ({kind})" if name else f"{kind} without a name")
            if vector == "act" and name in given:  # the recipe's own activation counts
                continue
            for place in range(at, at + width):
                value = values[place]
                if value is not None:
                    text = numbers.text([value + 0.0])
                    row[place] = Number(text, KeySource("entry", vector, span=span), place - at)
                    changed = True
        if changed:
            key.set(vector, " ".join(texts(row)))
            if record is not None:
                record.numbers[vector] = row
        if unknown:
            message = f"nothing says which control of {', '.join(unknown)} holds the key `{own.name}`: it is 0 there"
            help = "write the control beside `hold`: `ctrl: {hold: positions, ACTUATOR: 0.3}`"
            self.making.sink.warning("not-held", message, self.span(), help=help)

    def _report_no_control(self, path: tuple[str, ...], kind: str) -> None:
        message = f"no control of `{path[-1]}` holds the pose of the key `{self.step.key.name}`: it is {kind}"
        help = "write its control, or `ctrl: {hold: forces}`, which balances what acts on the model in that pose"
        self.making.sink.error("not-held", message, self.span(*path), help=help, subjects=(path[-1],))


def _addresses(layout: Layout, vector: str) -> Iterator[tuple[Any, int, int, int]]:
    """Yield every actuator with the start and count of its numbers in a vector, and the start of its controls."""
    at = control = 0
    for actuator, slot in layout.actuators.items():
        width = slot.widths[vector == "act"]
        yield actuator, at, width, control
        at += width
        control += slot.widths[0]

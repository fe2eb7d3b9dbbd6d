"""Keys during edits: removed from the tree, held, or scaled without effect."""

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
from mjcompose.mujoco import engine
from mjcompose.text.node import locate
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import KeySource, Number, numbers_of, texts

if TYPE_CHECKING:
    from mjcompose.sources.context import Context


def zero_attributes(editing: Editing, nodes: Sequence[Node], keys: Iterable[str]) -> list[str]:
    """Return the attributes, or single numbers of them (`friction[0]`), that are zero on every element."""
    return [key for key in keys if nodes and all(_is_zero(editing, node, key) for node in nodes)]


def report_only_zeros(editing: Editing, nodes: Sequence[Node], key: str, at: Path, help: str) -> None:
    """Warn about a factor for a value that is zero on every element."""
    whose = editing.called(nodes[0]) if len(nodes) == 1 else f"each of the {len(nodes)} selected elements"
    message = f"`{key}` of {whose} is 0, and a factor does not change it"
    notes = [Note(f"{editing.called(nodes[0])} is written here", editing.span_of(nodes[0]))]
    editing.sink.warning("scale-of-zero", message, editing.span(at), notes=notes, help=help)


def _is_zero(editing: Editing, node: Node, key: str) -> bool:
    name, subscript = attribute_and_index(key)
    attribute = kind_of(node).attributes.get(name)
    if attribute is None or not attribute.is_number:
        return False
    values = numbers.read(editing.effective(node, name) or "")
    values = values if subscript is None else values[subscript : subscript + 1]
    return bool(values) and not any(values)


@contextmanager
def without_keys(root: Node) -> Iterator[None]:
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
        if keep_finished(linking.flat(), context, session):
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
        return locate(self.making.document, (*self.step.key.at, CTRL, *path))

    def hold(self, session: engine.Session) -> None:
        from mjcompose.mujoco.controls import hold  # needs numpy, and few keys hold

        name, sink = self.step.key.name, self.making.sink
        keys = list(keys_of(self.linking.base))
        index = next(at for at, key in enumerate(keys) if key.get("name") == name)
        question = {"key": index, "forces": self.step.key.controls.hold == "forces"}
        answer = engine.call(session, hold, [FINISHED], argument=question)
        if not answer.ok:
            message = f"MuJoCo fails on the key `{name}`: {answer.error}"
            sink.error("mujoco-crash", message, self.span())
            return
        if left := answer.value["left"]:
            message = f"the actuators cannot hold the key `{name}`: they lack {left:.4g} N or N m"
            sink.warning("not-held", message, self.span())
        for vector in ("ctrl", "act"):
            self._write(vector, answer.value, keys[index])

    def _write(self, vector: str, answer: Mapping[str, Any], key: Node) -> None:
        """Write the values of the holding actuators into the row of a key."""
        values: list[float | None] = answer[vector]
        own = self.step.key
        record = self.linking.base.origins.keys.get(key)
        zero = KeySource("zero", vector)
        row = numbers_of(record, key, vector) or [Number("0", zero, index) for index in range(len(values))]
        singles = {self.span(*path): path for path in own.controls.held}
        hold = self.span("hold")
        given = set(own.values.get(vector, {}))
        controls = dict(enumerate(numbers_of(record, key, "ctrl")))
        changed, unknown = False, []
        end = next_control = 0
        for actuator, slot in self.layout.actuators.items():
            start, control = end, next_control
            end, next_control = end + slot.widths[vector == "act"], next_control + slot.widths[0]
            source = controls[control].source if control in controls else None
            span = None if source is None else source.span
            if span is None or source is None or source.kind != "entry" or span not in (hold, *singles):
                continue
            kind = answer["unlike"].get(str(control)) if vector == "ctrl" else None
            if kind and span != hold:
                end_of_path = singles[span][-1]
                message = f"no control of `{end_of_path}` holds the pose of the key `{own.name}`: it is {kind}"
                help = "write its control, or `ctrl: {hold: forces}`, which balances the forces in that pose"
                self.making.sink.error("not-held", message, span, help=help, subjects=(end_of_path,))
            name = "" if isinstance(actuator, str) else str(getattr(actuator, "get", lambda _: "")("name") or "")
            if kind and span == hold and control in answer["unknown"]:
                unknown.append(f"`{name}` ({kind})" if name else f"{kind} without a name")
            if vector == "act" and name in given:  # the recipe's own activation counts
                continue
            for index, value in enumerate(values[start:end]):
                if value is not None:
                    source = KeySource("entry", vector, span=span)
                    row[start + index] = Number(numbers.text([value + 0.0]), source, index)
                    changed = True
        if changed:
            key.set(vector, " ".join(texts(row)))
            if record is not None:
                record.numbers[vector] = row
        if unknown:
            message = f"the control of {', '.join(unknown)} that holds the key `{own.name}` is unknown: it is 0"
            help = "write the control next to `hold`: `ctrl: {hold: positions, ACTUATOR: 0.3}`"
            self.making.sink.warning("not-held", message, self.span(), help=help)

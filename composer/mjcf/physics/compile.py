"""Compile a composition with MuJoCo in this process, and note the rows of each element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace

from lxml.etree import _Element as Node

from composer.compiled.kinds import Model as MjModel
from composer.compiled.kinds import NameTable
from composer.compiled.order import compiled_kind, compiled_order, rows
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.link.request import Policy
from composer.mjcf.attaching import attachments_below
from composer.mjcf.errors import MjcfError, failed, failure, raise_errors
from composer.mjcf.flat import Flat, contents, copied, flatten, issue_warnings, name_files
from composer.mjcf.model import Model, Target
from composer.mujoco_errors.location import locate_fault
from composer.mujoco_errors.message import parse
from composer.mujoco_errors.sentence import Topic
from composer.mujoco_errors.translation import translate
from composer.tree.line import element_at
from composer.tree.mesh_points import check_meshes
from composer.tree.unit import Unit
from composer.tree.write import write

_IN_PYTHON = {
    Topic.FREE_JOINT: "put a body with a free joint into the worldbody",
    Topic.MOCAP: "put a mocap body into the worldbody, without joints",
    Topic.TRANSMISSION: "say what it moves: `joint=…`, or `tendon`, `site` or `body`",
    Topic.PLUGIN_INSTANCE: "let an actuator have it: `add('plugin', plugin=…, instance=…)`, or take the instance out",
}
"""Advice that is not about a recipe."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The elements of a composition when it was compiled, by node, with their rows in the compiled model.

    `known` has every node that existed; `rows` has those that are in MuJoCo's model, each with the number in its
    kind's arrays.
    """

    models: frozenset[Model]
    known: frozenset[Node]
    rows: Mapping[Node, int]


@dataclass(slots=True)
class _Copies:
    """Copies units for the linker and notes the original of each copied node."""

    originals: dict[Node, Target] = field(default_factory=dict)
    models: set[Model] = field(default_factory=set)

    def __call__(self, model: Model) -> Unit:
        unit = copied(model)
        self.models.add(model)
        pairs = zip(unit.root.iter("*"), model.unit.root.iter("*"), strict=True)
        self.originals.update((copy, Target(model, node)) for copy, node in pairs)
        return unit


def compile_model(model: Model, conflict: Policy) -> tuple[MjModel, Snapshot]:
    """Compile a composition. Raises `MjcfError` for faults that the linker or MuJoCo finds."""
    copies = _Copies()
    flat = flatten(model, conflict, copies)
    sink = Sink()
    for each in copies.models:
        check_meshes(each.unit, 0, sink)
    raise_errors(sink)
    name_files(flat)
    text = write(flat.unit.root)
    compiled = compile_text(text, contents(flat), flat)
    issue_warnings(flat)
    return compiled, _snapshot(model, copies, flat, NameTable(compiled))


def snapshot(model: Model, roster: NameTable) -> Snapshot:
    """Find the elements of a composition by their names in a model that was compiled from something else."""
    copies = _Copies()
    return _snapshot(model, copies, flatten(model, "warning", copies), roster)


def compile_text(text: bytes, assets: Mapping[str, bytes], flat: Flat | None = None) -> MjModel:
    """Compile MJCF text with MuJoCo. If the text comes from `flat`, report MuJoCo's errors at its elements."""
    mujoco = engine()
    try:
        return mujoco.MjModel.from_xml_string(text.decode(), dict(assets))
    except (ValueError, mujoco.FatalError) as error:
        raise refused(error, text, flat) from None


def engine() -> MjModel:
    """Return the module `mujoco`. Raises `MjcfError` if it is not installed."""
    try:
        import mujoco
    except ImportError as error:
        raise failure(
            "mujoco-missing", f"MuJoCo cannot be imported: {error}", help="pip install mujoco"
        ) from error
    return mujoco


def refused(error: Exception, text: bytes = b"", flat: Flat | None = None) -> MjcfError:
    """Return the error for a MuJoCo error about a model, at the element that the error is about."""
    fault = parse(str(error))
    element = None
    if flat is not None and fault.line is not None:
        element = element_at(flat.unit.root, text, fault.line)
    said = translate(" ".join(fault.message.split()), element)
    diagnostic = said.diagnostic
    if said.topic is not None:
        diagnostic = replace(diagnostic, help=_IN_PYTHON.get(said.topic, diagnostic.help))
    if flat is None or element is None:
        return failed(diagnostic)
    found = locate_fault(said, element, flat.unit)
    return failed(replace(diagnostic, span=found.span, notes=(*found.notes, *diagnostic.notes)))


def _snapshot(model: Model, copies: _Copies, flat: Flat, roster: NameTable) -> Snapshot:
    found = {
        copies.originals[node].node: row
        for node, row in rows(compiled_order(flat.unit.root), roster).items()
        if node in copies.originals
    }
    known = {original.node for original in copies.originals.values()}
    for target in (*copies.originals.values(), *_frames(model)):
        known.add(target.node)
        if target.node in found:
            continue
        kind = compiled_kind(target.node)
        name = None if kind is None else target.model.seen_from(model, target.node)
        if kind is not None and name is not None and name in roster.ids[kind]:
            found[target.node] = roster.ids[kind][name]
    return Snapshot(frozenset(copies.models), frozenset(known), found)


def _frames(model: Model) -> Iterator[Target]:
    """Yield the attachment frames that are bodies, and their joints. Other frames have no counterpart in MuJoCo."""
    for attachment in attachments_below(model):
        if attachment.is_body:
            yield Target(attachment.parent, attachment.frame)
            yield from (Target(attachment.parent, joint) for joint in attachment.frame)

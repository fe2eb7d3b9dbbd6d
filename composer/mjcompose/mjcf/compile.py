"""Compile a composition in this process, and find the rows of each element."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.sink import Sink
from mjcompose.link.existence import existence_faults
from mjcompose.link.linking import Policy
from mjcompose.mjcf.errors import MjcfError, error_of, failure, raise_errors
from mjcompose.mjcf.flat import Flat, contents, copy_unit, flatten, issue_warnings, name_files
from mjcompose.mjcf.model import ModelState, ReferencedNode
from mjcompose.mujoco.attributes import NameTable, all_names
from mjcompose.mujoco.index import compiled_kind, compiled_order, rows
from mjcompose.mujoco.messages import Topic, locate_fault, parse, translate
from mjcompose.tree.grammar import GRAMMAR, Attribute, to_text
from mjcompose.tree.mesh_cost import check_meshes
from mjcompose.tree.unit import Unit, element_at
from mjcompose.tree.xml_text import to_text as xml_text, write

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_Number = TypeVar("_Number", bound=np.generic)


class Scattered(np.ndarray[Any, np.dtype[Any]]):
    """A copy of some rows of one of MuJoCo's arrays, made when it was read.

    Assigned items and slices, and `+=` and the like, are also written to MuJoCo's array, but values that numpy's
    functions write (`out=`, `fill`, `sort`) are not. Results computed from it are separate arrays.
    """

    __slots__ = ("home",)
    home: ScatteredRows[Any]

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        self._write_back(key)

    def _write_back(self, key: Any = ...) -> None:
        """Write back only the numbers that were assigned, since the others may have changed after they were read."""
        rows: Any = self
        while getattr(rows, "home", None) is None:
            rows = rows.base
            if not isinstance(rows, Scattered):
                return  # computed from rows, or in memory that is shared with none
        source = rows.home.source
        if self is rows and source.ndim == 1:
            source[rows.home.index[key]] = np.asarray(self)[key]
        else:
            width = source[0].size
            at = flat_indices(rows, self)[key]
            written = rows.home.index[at // width]
            rows.home.before(written)
            np.put(source, written * width + at % width, np.asarray(self)[key])


def flat_indices(of: NDArray[Any], view: NDArray[Any]) -> NDArray[np.intp]:
    """Return the flat indices of the items of a view of the array `of`, in its shape. `of` is contiguous."""
    found = np.array((view.ctypes.data - of.ctypes.data) // of.itemsize, dtype=np.intp)
    for length, stride in zip(view.shape, view.strides, strict=True):
        found = found[..., None] + np.arange(length) * (stride // of.itemsize)
    return found


class ScatteredRows(Struct, Generic[_Number], eq=False):
    """The origin of scattered rows: the rows `index`, an array of integers, of `source`.

    `before` is called with the rows that are about to be written; rows with several numbers may be repeated.
    """

    source: NDArray[_Number]
    index: NDArray[np.intp]
    flat: bool
    before: Callable[[NDArray[np.intp]], None]

    @classmethod
    def of(
        cls,
        array: NDArray[_Number],
        index: NDArray[np.intp],
        before: Callable[[NDArray[np.intp]], None] = lambda rows: None,
    ) -> ScatteredRows[_Number]:
        return cls(array.view(Scattered), index, array.ndim == 1, before=before)

    def read(self) -> Scattered:
        """Return the current values of the rows."""
        # Indexing is fast for numbers, `take` for rows of several.
        rows: Any = self.source[self.index] if self.flat else self.source.take(self.index, 0)
        rows.home = self
        return rows  # type: ignore[no-any-return]

    def write(self, value: object) -> None:
        source: Any = self.source
        if not self.flat:
            np.empty((len(self.index), *source.shape[1:]), source.dtype)[...] = value
            self.before(self.index)
        source[self.index] = value


def _in_place(name: str) -> Any:
    compute = getattr(np.ndarray, name)

    def write(self: Scattered, other: object) -> Any:
        result = compute(self, other)
        self._write_back()
        return result

    write.__name__ = name
    return write


IN_PLACE = [f"__i{operator}__" for operator in "add sub mul truediv floordiv mod pow and or xor lshift rshift".split()]

for _name in IN_PLACE:
    setattr(Scattered, _name, _in_place(_name))


_IN_PYTHON = {
    Topic.FREE_JOINT: "put a body with a free joint into the worldbody",
    Topic.MOCAP: "put a mocap body into the worldbody, without joints",
    Topic.TRANSMISSION: "name the moved element: `joint=…`, or `tendon`, `site` or `body`",
    Topic.PLUGIN_INSTANCE: "give it to an actuator: `add('plugin', plugin=…, instance=…)`, or remove the instance",
}
"""Advice that is not about a recipe."""


class Snapshot(Struct):
    """The elements of a composition when it was compiled, by node, with their rows in the compiled model.

    `known` has every node that existed; `rows` has the nodes that are in MuJoCo's model, each with its index in the
    arrays of its kind.
    """

    models: frozenset[ModelState]
    known: frozenset[Node]
    rows: Mapping[Node, int]


class _Copies(Struct, frozen=False):
    """Copies units for the linker and notes the original of each copied node."""

    originals: dict[Node, ReferencedNode] = field(default_factory=dict)
    models: set[ModelState] = field(default_factory=set)

    def __call__(self, model: ModelState) -> Unit:
        unit = copy_unit(model)
        self.models.add(model)
        pairs = zip(unit.root.iter("*"), model.unit.root.iter("*"), strict=True)
        self.originals.update((copy, ReferencedNode(model, node)) for copy, node in pairs)
        return unit


def compile_model(model: ModelState, conflict: Policy) -> tuple[MjModel, Snapshot]:
    """Compile a composition. Raises `MjcfError` for faults that the linker or MuJoCo finds."""
    copies = _Copies()
    flat = flatten(model, conflict, copies)
    sink = Sink()
    for each in copies.models:
        check_meshes(each.unit, 0, sink)
    raise_errors(sink)
    name_files(flat)
    compiled = compile_text(write(flat.unit.root), contents(flat), flat)
    for fault in existence_faults(flat.unit, all_names(compiled)):
        sink.add(fault)
    raise_errors(sink)
    issue_warnings(flat.warnings)
    return compiled, _snapshot(model, copies, flat, roster=NameTable(compiled))


def snapshot(model: ModelState, roster: NameTable) -> Snapshot:
    """Find the elements of a composition by their names in a model that was compiled from other text."""
    copies = _Copies()
    return _snapshot(model, copies, flatten(model, "base", copies), roster=roster)


def compile_text(text: bytes, assets: Mapping[str, bytes], flat: Flat | None = None) -> MjModel:
    """Compile MJCF text with MuJoCo. If the text comes from `flat`, report MuJoCo's errors at its elements."""
    mujoco = engine()
    try:
        model: MjModel = mujoco.MjModel.from_xml_string(text.decode(), dict(assets))
    except (ValueError, mujoco.FatalError) as error:
        raise compile_error(error, text, flat) from None
    return model


def engine() -> Any:
    """Return the module `mujoco`. Raises `MjcfError` if it is not installed."""
    try:
        import mujoco
    except ImportError as error:
        raise failure("mujoco-missing", f"MuJoCo cannot be imported: {error}", help="pip install mujoco") from error
    return mujoco


def compile_error(error: Exception, text: bytes = b"", flat: Flat | None = None) -> MjcfError:
    """Return the error for a MuJoCo error about a model, at the element that the error is about."""
    fault = parse(str(error))
    element = None if flat is None or fault.line is None else element_at(flat.unit.root, text, fault.line)
    said = translate(" ".join(fault.message.split()), element)
    diagnostic = said.diagnostic
    if said.topic is not None:
        diagnostic = replace(diagnostic, help=_IN_PYTHON.get(said.topic, diagnostic.help))
    if flat is None or element is None:
        return error_of(diagnostic)
    found = locate_fault(said, element, flat.unit)
    return error_of(replace(diagnostic, span=found.span, notes=(*found.notes, *diagnostic.notes)))


def _snapshot(model: ModelState, copies: _Copies, flat: Flat, roster: NameTable) -> Snapshot:
    found = {
        copies.originals[node].node: row
        for node, row in rows(compiled_order(flat.unit.root), roster).items()
        if node in copies.originals
    }
    known = {original.node for original in copies.originals.values()}
    # Attachment frames that are bodies, and their joints. Other frames have no counterpart in MuJoCo.
    bodies = [each for below in copies.models for each in below.attachments.values() if each.is_body]
    frames = [ReferencedNode(each.parent, node) for each in bodies for node in (each.frame, *each.frame)]
    for target in (*copies.originals.values(), *frames):
        known.add(target.node)
        kind = None if target.node in found else compiled_kind(target.node)
        name = None if kind is None else target.model.seen_from(model, target.node)
        if kind is not None and name is not None and name in roster.ids[kind]:
            found[target.node] = roster.ids[kind][name]
    return Snapshot(frozenset(copies.models), frozenset(known), found)


_GENERAL = GRAMMAR.element("actuator/general").attributes
# The two that MuJoCo has by another word.
_FIELDS = {"input": "ctrlspec", "user": "userdata"}


def settings(default_sections: Iterable[Node], actuator: Node) -> Mapping[str, str] | None:
    """Return all settings of an actuator as texts by the attributes of `<general>`, or None if MuJoCo refuses it.

    An empty text stands for a setting that cannot be written because it has no value. A crank length is included only
    for a slider-crank, because MuJoCo lets classes set it for other actuators too. The actuator's target is not
    included.
    """
    mujoco = engine()
    root = etree.Element("mujoco")
    root.extend(copy.deepcopy(section) for section in default_sections)
    etree.SubElement(root, "actuator").append(copy.deepcopy(actuator))
    try:
        read = mujoco.MjSpec.from_string(etree.tostring(root, encoding="unicode")).actuators[0]
    except (ValueError, mujoco.FatalError):
        return None
    fields = {name: _FIELDS.get(name, name) for name in _GENERAL}
    if read.trntype.name != "mjTRN_SLIDERCRANK":
        del fields["cranklength"]
    return {
        name: _text(mujoco, _GENERAL[name], getattr(read, field), read=read)
        for name, field in fields.items()
        if field not in ("name", "refsite", "slidersite") and hasattr(read, field)
    }


def _text(mujoco: Any, attribute: Attribute, value: Any, read: Any) -> str:
    if attribute.name == "input":
        return _input(mujoco, int(value), read)
    if attribute.type == "keyword":
        kind = getattr(value, "name", None)  # `mjGAIN_FIXED`
        return attribute.keywords[value] if kind is None else str(kind).partition("_")[2].lower()
    if attribute.name == "user":
        value = list(value)
    return to_text(attribute, value)


def _input(mujoco: Any, signature: int, read: Any) -> str:
    """Return the text of `input`. MuJoCo keeps one bit for each input, or the form in which an orientation is given."""
    if not signature:
        return ""
    if read.gaintype.name == "mjGAIN_SO3":
        names = [each for each in mujoco.mjtCtrlChart.__members__.values() if each == signature]
    else:
        names = [each for each in mujoco.mjtCtrlInput.__members__.values() if each & signature]
    return " ".join(each.name.partition("_")[2].lower() for each in names)


def to_spec(model: ModelState, conflict: Policy) -> Any:
    """Return the composition as a `mujoco.MjSpec`. See `RootElement.to_spec`."""
    mujoco = engine()
    flat = flatten(model, conflict)
    name_files(flat)
    files = contents(flat)
    try:
        # MuJoCo reads sub-models at once, and looks for them in included files.
        models = {name: data for name, data in files.items() if name.endswith(".xml")}
        spec = mujoco.MjSpec.from_string(xml_text(flat.unit.root), include=models, assets=files)
    except (ValueError, mujoco.FatalError) as error:
        raise compile_error(error, write(flat.unit.root), flat) from None
    issue_warnings(flat.warnings)
    return spec

"""Compare each part of a composition with its source, compiled alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.report import with_rest
from mjcompose.base.rotation import Pose
from mjcompose.base.sink import Sink
from mjcompose.bundle.assemble import Renamed
from mjcompose.link.excerpt import ExcerptSource
from mjcompose.link.measure import folder_of, measure_with
from mjcompose.link.subtree import take_from_excerpt, take_subtree
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import FREE
from mjcompose.mujoco.attributes import DERIVED, NameTable, name_table
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.match import EXTRA, MISSING, Difference, Mount, Value
from mjcompose.mujoco.unchanged import compare
from mjcompose.plan.plan import PartRecord
from mjcompose.plan.read import read_source
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.parse import model_of_mesh
from mjcompose.tree.xml_text import write
from mjcompose.verify.compile import WHOLE

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


class Incomparable(Exception):
    """Raised with the reason that a part cannot be compared. With `lacks_body`, the body of its place is missing."""

    def __init__(self, why: str, lacks_body: bool = False) -> None:
        super().__init__(why)
        self.lacks_body = lacks_body


def _keep_source(member: PartRecord, session: engine.Session, name: str) -> None:
    """Keep the whole source under `name`. Raises Incomparable if it cannot be read or MuJoCo refuses it."""
    path = member.source.path
    if member.source.format != "urdf":
        _keep(session, path.parent, _path_of(member.source), text=_text_of(member.source), name=name)
        return
    from mjcompose.urdf.read import UrdfReader  # few recipes need it

    sink = Sink()
    unit = UrdfReader(member.source, sink, session, is_fixed_in_world=member.is_fixed_in_world).unit()
    if unit is None:
        raise _unreadable(sink)
    with folder_of(unit) as folder:
        _keep(session, folder, Path("source.xml"), text=write(unit.root), name=name)


def _path_of(source: Source) -> Path:
    """Return the path of the MJCF, which for a mesh is in no file."""
    return source.path.with_suffix(".xml") if source.format == "mesh" else source.path


def _text_of(source: Source) -> bytes | None:
    """Return the text of MJCF for a mesh, or that begins with the recipe's settings; None for a file as it is."""
    if source.format == "mesh":
        return model_of_mesh(source.path)
    if not source.compiler:
        return None
    try:
        root = etree.fromstring(source.door.read(source.path))
    except (OSError, etree.XMLSyntaxError) as error:
        raise Incomparable("its source cannot be read") from error
    root.insert(0, etree.Element("compiler", dict(source.compiler)))
    return etree.tostring(root)


_NAMELESS = "a body around the subtree, "


class _CutSource:
    """A source from which subtrees are taken. It is read once, and it is compiled once if its bodies have names."""

    def __init__(self, member: PartRecord, session: engine.Session, name: str) -> None:
        """`name` starts the names under which `session` keeps the compiled source. Raises Incomparable."""
        sink = Sink()
        self._text = _text_of(member.source)
        self._path = _path_of(member.source)
        unit = read_source(member.source, sink)
        if unit is None:
            raise _unreadable(sink)
        self._unit = unit
        self._bodies: dict[str, Node] = {}
        for each in unit.root.iterfind("worldbody//body[@name]"):
            self._bodies.setdefault(str(each.get("name")), each)
        self._excerpts = ExcerptSource.of(unit)
        self._session = session
        self._name = name
        self._compiled: dict[tuple[Node, ...], str] = {}

    def around(self, body: str) -> list[Node]:
        """Return the bodies around a body, the nearest first."""
        found = self._bodies.get(body)
        return [] if found is None else list(found.iterancestors("body"))

    def whole(self, around: Sequence[Node]) -> str:
        """Compile the source, in which the bodies `around` a subtree get names, and return the name of the result."""
        nameless = tuple(each for each in around if not each.get("name"))
        if nameless in self._compiled:
            return self._compiled[nameless]
        name = f"{self._name}, number {len(self._compiled)}"
        for each in nameless:
            each.set("name", _name_around(each, around))
        try:
            with folder_of(self._unit) as folder:
                text = write(self._unit.root) if nameless or self._text else None
                _keep(self._session, folder, self._path, text=text, name=name)
        finally:
            for each in nameless:
                del each.attrib["name"]
        self._compiled[nameless] = name
        return name

    def keep_subtree(self, member: PartRecord, name: str) -> None:
        """Compile the subtree of a part and keep it. Raises Incomparable."""
        assert member.subtree is not None
        sink = Sink()
        context = Context(sink=sink, environment={}, folder=self._path.parent)
        measure = measure_with(context, session=self._session)
        keyframes: KeyPolicy = "none" if member.keys is None else "merge"
        excerpt = None if self._excerpts is None else self._excerpts.excerpt(member.subtree)
        if excerpt is None:
            unit = self._unit.copied()
            subtree = take_subtree(unit, member.subtree, sink, keyframes=keyframes, measure=measure)
        else:
            unit = excerpt.unit
            subtree = take_from_excerpt(excerpt, sink, keyframes=keyframes, measure=measure)
        if subtree is None:
            raise _unreadable(sink)
        with folder_of(unit) as folder:
            _keep(self._session, folder, self._path, text=write(unit.root), name=name)


def _name_around(body: Node, around: Sequence[Node]) -> str:
    """Return a name for a body without one that is around a subtree."""
    return str(body.get("name") or f"{_NAMELESS}{around.index(body)}")


def _keep(session: engine.Session, folder: Path, path: Path, text: bytes | None, name: str) -> None:
    given = None if text is None else text.decode()
    compiled = engine.compile(folder if given else path.parent, path.name, text=given, keep=name, session=session)
    if not compiled.ok:
        said = " ".join((compiled.error or compiled.crash or "").split())
        raise Incomparable(f"MuJoCo does not accept its source alone: {said}")


def _unreadable(sink: Sink) -> Incomparable:
    return Incomparable(f"its source cannot be read{f': {sink.errors[0].message}' if sink.errors else ''}")


def compare_part(
    _mujoco: object, alone: MjModel, composed: MjModel, question: Mapping[str, Any]
) -> list[dict[str, Any]] | None:
    """Return the differences of a part as JSON data; runs under `mjcompose.mujoco.engine.call`.

    ``question`` has arguments of `compare`, and the place of the part: its ``body`` in the composition, None for the
    world, and the ``pose`` there (in meters), None if it is unknown. ``key_prefix`` starts the names of the part's keys
    if ``keys`` implies another prefix. ``welded`` says that free joints at the part's root were removed. Return None if
    the composition lacks the body.
    """
    body, pose, key_prefix, welded, renamed, keys = map(question.get, _PLACED)
    if body is not None and body not in name_table(composed).ids["body"]:
        return None
    if key_prefix is not None:
        renamed = {**(renamed or {}), "key": {name: key_prefix + name for name in NameTable(alone).ids["key"]}}
    hung_on = Mount(body, None) if pose is None else Mount.of(composed, body=body, pos=pose["pos"], quat=pose["quat"])
    others = {name: value for name, value in question.items() if name not in _PLACED}
    found = compare(alone, composed, hung_on=hung_on, renamed=renamed, keys=KeyMode(keys or KeyMode.MERGE), **others)
    free = _free(alone, question.get("prefix", "")) if welded else frozenset()
    return [asdict(each) for each in found if not _of_welding(each, free)]


_PLACED = ("body", "pose", "key_prefix", "welded", "renamed", "keys")


def _free(alone: MjModel, prefix: str) -> frozenset[str]:
    """Return the names of free joints and their bodies in the composition; `#` for unnamed joints and bodies."""
    roster = NameTable(alone)
    free = [index for index, kind in enumerate(alone.jnt_type) if kind == FREE]
    names = [roster.names["joint"][index] for index in free]
    names += [roster.names["body"][int(alone.jnt_bodyid[index])] for index in free]
    return frozenset(prefix + name if name else "#" for name in names)


def _of_welding(difference: Difference, free: frozenset[str]) -> bool:
    """Return whether the difference only says that a free joint was removed."""
    counts = difference.field in ("body_dofnum", "body_jntnum")
    if not counts and (difference.kind, difference.field) != ("joint", MISSING):
        return False
    return difference.name in free or ("#" in free and difference.name.startswith("#"))


def differences_of(value: list[dict[str, Any]]) -> list[Difference]:
    """Return the differences that ``compare_part`` returned as JSON data."""
    frozen = ("expected", "actual")
    return [Difference(**{**each, **{name: _frozen(each[name]) for name in frozen}}) for each in value]


def _frozen(value: Any) -> Value:
    if isinstance(value, list):
        return tuple(_frozen(item) for item in value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a difference cannot hold {type(value).__name__}")


_ROUNDING = 1e-12
"""Relative: `springdamper` and `dampratio` use the inertia of the whole model, which is summed in another order."""


class PartComparison(Struct):
    """The outcome for one part: its differences, or the reason that it could not be compared."""

    member: PartRecord
    differences: tuple[Difference, ...] = ()
    obscure: str | None = None

    @property
    def ok(self) -> bool:
        return self.obscure is None and not self.differences


class PartComparer(Struct, frozen=False):
    """Compares parts with the composition that `session` keeps as `WHOLE`. Each source is compiled once.

    `merged` maps by kind the names in the composition that were merged into another one. `renamed` has, by part and
    kind, the names that edits give to its elements. `cut` has the differences of subtrees from their whole sources.
    """

    session: engine.Session
    merged: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    renamed: Renamed = field(default_factory=dict)
    alone: dict[str, Incomparable | None] = field(default_factory=dict)
    cut: dict[str, tuple[Difference, ...]] = field(default_factory=dict)
    cut_sources: dict[str, _CutSource] = field(default_factory=dict)

    def compare(
        self, member: PartRecord, excused: Iterable[str] = (), replaced_keys: Iterable[str] = ()
    ) -> PartComparison:
        """Compare a part with its source, except for `excused` arrays (or endings of names) and `replaced_keys`."""
        if member.obscure is not None:
            return PartComparison(member, obscure=member.obscure)
        name = _kept(member)
        try:
            self._keep_alone(member, name)
            found = self._ask(name, WHOLE, self._question(member, excused, replaced_keys))
        except Incomparable as error:
            return PartComparison(member, obscure=str(error))
        return PartComparison(member, (*self.cut.get(name, ()), *found))

    def _keep_alone(self, member: PartRecord, name: str) -> None:
        """Compile the source of a part, or the subtree that is taken from it, once. Raises Incomparable."""
        if name not in self.alone:
            self.alone[name] = None
            try:
                if member.subtree is None:
                    _keep_source(member, self.session, name)
                else:
                    self._take(member, name)
            except Incomparable as error:
                self.alone[name] = error
        fault = self.alone[name]
        if fault is not None:
            raise fault

    def _question(self, member: PartRecord, excused: Iterable[str], replaced_keys: Iterable[str]) -> dict[str, Any]:
        prefix = member.prefix
        renamed = {
            kind: {gone.removeprefix(prefix): kept for gone, kept in names.items() if gone.startswith(prefix)}
            for kind, names in self.merged.items()
        }
        edited = self.renamed.get(member.part, {})
        renamed |= {kind: {**names, **renamed.get(kind, {})} for kind, names in edited.items()}
        keys = KeyMode.MERGE
        key_prefix = None
        if member.keys is None:
            keys = KeyMode.NONE
        elif member.keys and member.keys == prefix:
            keys = KeyMode.PREFIX
        elif member.keys:
            key_prefix = member.keys
        return {
            "prefix": prefix,
            "body": member.body,
            "pose": None if member.pose is None else asdict(member.pose),
            "renamed": renamed,
            "keys": keys,
            "key_prefix": key_prefix,
            "welded": member.welded,
            "ignore": tuple(excused),
            "replaced_keys": tuple(replaced_keys),
        }

    def _ask(self, alone: str, composed: str, question: dict[str, Any]) -> tuple[Difference, ...]:
        """Return the differences of two models that the session keeps. Raises Incomparable."""
        answer = engine.call(self.session, compare_part, [alone, composed], argument=question)
        if not answer.ok:
            raise Incomparable(answer.error or answer.crash or "it cannot be compared")
        if answer.value is None:
            why = f"the body `{question['body']}` that it is attached to is not in the compiled model"
            raise Incomparable(why, lacks_body=True)
        return tuple(differences_of(answer.value))

    def _take(self, member: PartRecord, name: str) -> None:
        """Compile the subtree of a source, compare it with the whole and keep it."""
        source_name = _kept(replace(member, subtree=None))
        if source_name not in self.cut_sources:
            self.cut_sources[source_name] = _CutSource(member, self.session, f"{source_name} with names")
        source = self.cut_sources[source_name]
        assert member.subtree is not None
        around = source.around(member.subtree)
        whole = source.whole(around)
        source.keep_subtree(member, name)
        # The subtree's world is the first of them, or a body further up if `fusestatic` fused them.
        above = (*(_name_around(each, around) for each in around), None)
        keys = KeyMode.NONE if member.keys is None else KeyMode.MERGE
        for body in above:
            pose = asdict(Pose()) if body == above[0] else None
            question = {"body": body, "pose": pose, "keys": keys, "tolerance": _ROUNDING, "cut": True}
            try:
                self.cut[name] = self._ask(name, whole, question)
                return
            except Incomparable as error:
                if not error.lacks_body or body is None:
                    raise


def _kept(member: PartRecord) -> str:
    """Return a name for the compiled source, shared by all parts with the same source."""
    stands = member.is_fixed_in_world or member.source.format != "urdf"
    taken = "" if member.subtree is None else f"{member.subtree} of {member.keys is None} "
    read = f"{member.source.urdf} {member.source.packages} " if member.source.format == "urdf" else ""
    read += f"{member.source.compiler} " if member.source.compiler else ""
    return f"alone {'' if stands else 'and loose '}{taken}{read}{member.source.path}"


def causes(differences: Sequence[Difference]) -> list[Difference]:
    """Return the differences that do not follow from other differences; all of them if each follows from another."""
    return [each for each in differences if each.array not in DERIVED] or list(differences)


def change_sentence(compared: PartComparison) -> str:
    found = causes(compared.differences)
    names: dict[str, None] = {}
    for each in found:
        names[f"{each.field} {each.kind}" if each.field in (MISSING, EXTRA) else f"`{each.array}`"] = None
    shown = ", ".join([*names][:4]) + (", …" if len(names) > 4 else "")
    count = f"{len(found)} difference{'s' if len(found) > 1 else ''}"
    return f"`{compared.member.called}` differs from `{compared.member.source.path.name}` alone: {count} ({shown})"


def difference_notes(differences: Sequence[Difference]) -> list[Note]:
    """Return the first differences as notes, with the expected and actual values."""
    return list(map(Note, with_rest([str(each) for each in causes(differences)])))

"""Compare each part of a composition with its source, compiled alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, field
from pathlib import Path
from typing import Any, NamedTuple

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN, Pose, Quat, Vec3
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.assemble import Renamed
from mjcompose.build.plan.plan import PartRecord
from mjcompose.build.verify.compile import WHOLE
from mjcompose.link.measure import folder_of, measure_with
from mjcompose.link.subtree import take_subtree
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import FREE
from mjcompose.mujoco.attributes import DERIVED, Model, NameTable
from mjcompose.mujoco.compare import Keys, Roots
from mjcompose.mujoco.match import EXTRA, MISSING, Difference, Mount, Value
from mjcompose.mujoco.unchanged import compare
from mjcompose.sources.context import Context
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.parse import parse_file
from mjcompose.tree.xml_text import write


def keep_source(member: PartRecord, session: engine.Session, name: str) -> str | None:
    """Keep the whole source under `name`; return a message if it cannot be read or MuJoCo refuses it."""
    path = member.source.path
    if member.source.format != "urdf":
        return _keep(session, path.parent, path, text=None, name=name)
    from mjcompose.urdf.read import UrdfReader  # few recipes need it

    sink = Sink()
    unit = UrdfReader(member.source, sink, session, is_fixed_in_world=member.is_fixed_in_world).unit()
    if unit is None:
        return _errors_text(sink) if sink.errors else "its source cannot be read"
    with folder_of(unit) as folder:
        return _keep(session, folder, Path("source.xml"), text=write(unit.root), name=name)


def refusal_message(said: str | None) -> str:
    """Return the message about a source that MuJoCo does not compile alone."""
    return f"MuJoCo does not accept its source alone: {' '.join((said or '').split())}"


_NAMELESS = "a body around the subtree, "


class KeptSubtree(NamedTuple):
    """The result of compiling a subtree and its source.

    `above` are the bodies around the subtree in the whole source, the nearest first, and None for the world. The
    subtree's world corresponds to the first of them, or to one further up if `fusestatic` fused them.
    """

    above: tuple[str | None, ...] = (None,)
    fault: str | None = None


def keep_subtree(member: PartRecord, session: engine.Session, taken: str, whole: str) -> KeptSubtree:
    """Compile the subtree and the whole source and keep them under these names.

    If that fails, the result has a message.
    """
    assert member.subtree is not None
    sink = Sink()
    path = member.source.path
    unit = parse_file(path, sink, door=member.source.door)
    if unit is None:
        return KeptSubtree(fault=_errors_text(sink))
    bodies = (each for world in unit.root.iterchildren("worldbody") for each in world.iter("body"))
    body = next((each for each in bodies if each.get("name") == member.subtree), None)
    around = [] if body is None else list(body.iterancestors("body"))
    nameless = [each for each in around if not each.get("name")]
    for number, each in enumerate(nameless):
        each.set("name", f"{_NAMELESS}{number}")
    with folder_of(unit) as folder:
        fault = _keep(session, folder, path, text=write(unit.root) if nameless else None, name=whole)
    if fault is not None:
        return KeptSubtree(fault=fault)
    above = (*(str(each.get("name")) for each in around), None)
    measure = measure_with(Context(sink=sink, environment={}, folder=path.parent), session=session)
    keyframes: KeyPolicy = "none" if member.keys is None else "merge"
    if take_subtree(unit, member.subtree, sink, keyframes=keyframes, measure=measure) is None:
        return KeptSubtree(fault=_errors_text(sink))
    with folder_of(unit) as folder:
        return KeptSubtree(above, _keep(session, folder, path, text=write(unit.root), name=taken))


def _keep(session: engine.Session, folder: Path, path: Path, text: bytes | None, name: str) -> str | None:
    given = None if text is None else text.decode()
    compiled = engine.compile(folder if given else path.parent, path.name, text=given, keep=name, session=session)
    return None if compiled.ok else refusal_message(compiled.error or compiled.crash)


def _errors_text(sink: Sink) -> str:
    return f"its source cannot be read: {sink.errors[0].message}"


@dataclass(frozen=True, slots=True)
class PartQuestion:
    """The question whether a part is unchanged.

    The fields are the fields of `compare`, and the place is given as in a recipe. ``site`` and ``body`` are names in
    the composition. If both are None, the place is the world. ``pos`` is in meters, in the frame of the place.
    ``posed=False`` says that the pose is unknown, and then there is no site. ``key_prefix`` starts the names of the
    part's keys if ``keys`` implies another prefix. ``welded`` says that free joints at the part's root were
    removed.
    """

    prefix: str = ""
    site: str | None = None
    body: str | None = None
    pos: Vec3 = ORIGIN
    quat: Quat = IDENTITY_QUAT
    posed: bool = True
    renamed: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    keys: Keys = Keys.MERGE
    roots_in_keys: Roots = Roots.MOVED
    ignore: tuple[str, ...] = ()
    replaced_keys: tuple[str, ...] = ()
    tolerance: float = 0.0
    key_prefix: str | None = None
    welded: bool = False
    cut: bool = False

    def mount(self, composed: Model) -> Mount:
        """Return the place of the part. Raises KeyError if the composition lacks the site or body."""
        if not self.posed:
            return Mount(self.body, None)
        return Mount.of(composed, site=self.site, body=self.body, pos=self.pos, quat=self.quat)


def compare_part(
    _mujoco: object, alone: Model, composed: Model, question: Mapping[str, Any]
) -> list[dict[str, Any]] | None:
    """Return the differences of a part as JSON data; runs under `mjcompose.mujoco.engine.call`.

    ``question`` has the fields of a `PartQuestion`. Return None if the composition lacks the body of the part's
    place.
    """
    given = PartQuestion(**question)
    if given.body is not None and given.body not in NameTable(composed).ids["body"]:
        return None
    renamed = given.renamed
    if given.key_prefix is not None:
        renamed = {**renamed, "key": {name: given.key_prefix + name for name in NameTable(alone).ids["key"]}}
    found = compare(
        alone, composed, prefix=given.prefix, hung_on=given.mount(composed), renamed=renamed, keys=Keys(given.keys),
        roots_in_keys=Roots(given.roots_in_keys), ignore=given.ignore, replaced_keys=given.replaced_keys,
        tolerance=given.tolerance, cut=given.cut,
    )  # fmt: skip
    free = _free(alone, given.prefix) if given.welded else frozenset()
    return [asdict(each) for each in found if not _of_welding(each, free)]


def _free(alone: Model, prefix: str) -> frozenset[str]:
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


@dataclass(frozen=True, slots=True)
class PartComparison:
    """The outcome for one part: its differences, or why it could not be compared."""

    member: PartRecord
    differences: tuple[Difference, ...] = ()
    obscure: str | None = None

    @property
    def ok(self) -> bool:
        return self.obscure is None and not self.differences


@dataclass(frozen=True, slots=True)
class Incomparable:
    """The reason why two models cannot be compared; `lacks_body` says that the second model lacks the given body."""

    why: str
    lacks_body: bool = False


@dataclass(slots=True)
class PartComparer:
    """Compares parts with the composition that `session` keeps as `WHOLE`. Each source is compiled once.

    `merged` maps by kind the names in the composition that were merged into another one. `renamed` has, by
    part and kind, the names that edits give to its elements. `cut` has the differences between a subtree that
    was taken from a source and the same subtree in the whole source.
    """

    session: engine.Session
    merged: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    renamed: Renamed = field(default_factory=dict)
    alone: dict[str, str | None] = field(default_factory=dict)
    cut: dict[str, tuple[Difference, ...]] = field(default_factory=dict)

    def compare(
        self, member: PartRecord, excused: Iterable[str] = (), replaced_keys: Iterable[str] = ()
    ) -> PartComparison:
        """Compare a part with its source.

        `excused` are arrays, or ends of their names; `replaced_keys` are keys of the composition that the
        recipe wrote.
        """
        if member.obscure is not None:
            return PartComparison(member, obscure=member.obscure)
        name = _kept(member)
        if name not in self.alone:
            whole = member.subtree is None
            self.alone[name] = keep_source(member, self.session, name) if whole else self._take(member, name)
        fault = self.alone[name]
        if fault is not None:
            return PartComparison(member, obscure=fault)
        question = self._question(member, tuple(excused), tuple(replaced_keys))
        found = self._ask(name, WHOLE, question)
        if isinstance(found, Incomparable):
            return PartComparison(member, obscure=found.why)
        return PartComparison(member, (*self.cut.get(name, ()), *found))

    def _question(self, member: PartRecord, excused: tuple[str, ...], replaced_keys: tuple[str, ...]) -> PartQuestion:
        pose, prefix = member.pose or Pose(), member.prefix
        renamed = {
            kind: {gone.removeprefix(prefix): kept for gone, kept in names.items() if gone.startswith(prefix)}
            for kind, names in self.merged.items()
        }
        edited = self.renamed.get(member.part, {})
        renamed |= {kind: {**names, **renamed.get(kind, {})} for kind, names in edited.items()}
        keys, key_prefix = Keys.MERGE, None
        if member.keys is None:
            keys = Keys.NONE
        elif member.keys and member.keys == prefix:
            keys = Keys.PREFIX
        elif member.keys:
            key_prefix = member.keys
        return PartQuestion(
            prefix, body=member.body, pos=pose.pos, quat=pose.quat, posed=member.pose is not None, renamed=renamed,
            keys=keys, ignore=excused, replaced_keys=replaced_keys, key_prefix=key_prefix, welded=member.welded,
        )  # fmt: skip

    def _ask(self, alone: str, composed: str, question: PartQuestion) -> tuple[Difference, ...] | Incomparable:
        """Return the differences of two models that the session keeps, or why they cannot be compared."""
        answer = engine.call(self.session, compare_part, [alone, composed], argument=asdict(question))
        if not answer.ok:
            return Incomparable(answer.error or answer.crash or "it cannot be compared")
        if answer.value is None:
            why = f"the body `{question.body}` that it is attached to is not in the compiled model"
            return Incomparable(why, lacks_body=True)
        return tuple(differences_of(answer.value))

    def _take(self, member: PartRecord, name: str) -> str | None:
        """Compile the subtree of a source, compare it with the whole and keep it; return an error message or None."""
        whole = f"{name} in the whole"
        taken = keep_subtree(member, self.session, name, whole=whole)
        if taken.fault is not None:
            return taken.fault
        keys = Keys.NONE if member.keys is None else Keys.MERGE
        why = ""
        for body in taken.above:
            here = body == taken.above[0]
            question = PartQuestion(body=body, posed=here, keys=keys, tolerance=_ROUNDING, cut=True)
            found = self._ask(name, whole, question)
            if not isinstance(found, Incomparable):
                self.cut[name] = found
                return None
            why = found.why
            if not found.lacks_body:
                break
        return why


def _kept(member: PartRecord) -> str:
    """Return a name for the compiled source, shared by all parts with the same source."""
    stands = member.is_fixed_in_world or member.source.format != "urdf"
    taken = "" if member.subtree is None else f"{member.subtree} of {member.keys is None} "
    read = f"{member.source.urdf} {member.source.packages} " if member.source.format == "urdf" else ""
    return f"alone {'' if stands else 'and loose '}{taken}{read}{member.source.path}"


_SHOWN = 8
"""How many differences of a part are listed one by one."""


def causes(differences: Sequence[Difference]) -> list[Difference]:
    """Return the differences that do not follow from others; all of them if each follows from another."""
    return [each for each in differences if each.array not in DERIVED] or list(differences)


def change_sentence(compared: PartComparison) -> str:
    """Return one sentence about a part that differs from its source."""
    found = causes(compared.differences)
    places = len(found)
    arrays = list(
        dict.fromkeys(
            f"{each.field} {each.kind}" if each.field in (MISSING, EXTRA) else f"`{each.array}`" for each in found
        )
    )
    shown = ", ".join(arrays[:4]) + (", …" if len(arrays) > 4 else "")
    return (
        f"`{compared.member.called}` differs from `{compared.member.source.path.name}` alone: "
        f"{places} difference{'s' if places > 1 else ''} ({shown})"
    )


def difference_notes(differences: Sequence[Difference]) -> list[Note]:
    """Return the first differences as notes, with the expected and actual values."""
    found = causes(differences)
    listed = [Note(str(each)) for each in found[:_SHOWN]]
    if len(found) > _SHOWN:
        listed.append(Note(f"and {len(found) - _SHOWN} more"))
    return listed

"""Compare the parts of a compiled composition with their sources compiled alone, in MuJoCo's child process."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field

from composer import engine
from composer.bundle.renamed import Renamed
from composer.compiled.difference import Difference
from composer.compiled.keyframes import Keys
from composer.dataclass import dataclass
from composer.numerics.pose import IDENTITY_QUAT, ORIGIN
from composer.plan.part_record import PartRecord
from composer.verify.compiles import WHOLE
from composer.verify.question import Question, ask, differences_of
from composer.verify.source_alone import keep_source

_ROUNDING = 1e-12
"""Relative: `springdamper` and `dampratio` use the inertia of the whole model, which is summed in another order."""


@dataclass(frozen=True, slots=True)
class Compared:
    """The outcome for one part: its differences, or why it could not be compared."""

    member: PartRecord
    differences: tuple[Difference, ...] = ()
    obscure: str | None = None

    @property
    def ok(self) -> bool:
        return self.obscure is None and not self.differences


@dataclass(frozen=True, slots=True)
class Incomparable:
    """The reason why two models cannot be compared; `lacks_body` says that the second one lacks the given body."""

    why: str
    lacks_body: bool = False


@dataclass(slots=True)
class Judge:
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
    ) -> Compared:
        """Compare a part with its source.

        `excused` are arrays, or ends of their names; `replaced_keys` are keys of the composition that the
        recipe wrote.
        """
        if member.obscure is not None:
            return Compared(member, obscure=member.obscure)
        name = _kept(member)
        if name not in self.alone:
            self.alone[name] = self._compile(member, name)
        fault = self.alone[name]
        if fault is not None:
            return Compared(member, obscure=fault)
        given = tuple(excused), tuple(replaced_keys)
        question = _question(member, *given, self.merged, self.renamed.get(member.part, {}))
        found = self._ask(name, WHOLE, question)
        if isinstance(found, Incomparable):
            return Compared(member, obscure=found.why)
        return Compared(member, (*self.cut.get(name, ()), *found))

    def _ask(self, alone: str, composed: str, question: Question) -> tuple[Difference, ...] | Incomparable:
        """Return the differences of two models that the session keeps, or why they cannot be compared."""
        answer = engine.call(self.session, ask, [alone, composed], argument=question.to_json())
        if not answer.ok:
            return Incomparable(answer.error or answer.crash or "it cannot be compared")
        if answer.value is None:
            why = f"the body `{question.body}` that it is attached to is not in the compiled model"
            return Incomparable(why, lacks_body=True)
        return tuple(differences_of(answer.value))

    def _take(self, member: PartRecord, name: str) -> str | None:
        """Compile the subtree of a source, compare it with the whole and keep it; return an error message or None."""
        from composer.verify.subtree_reference import keep_subtree  # few recipes need it

        whole = f"{name} in the whole"
        taken = keep_subtree(member, self.session, name, whole=whole)
        if taken.fault is not None:
            return taken.fault
        keys = Keys.NONE if member.keys is None else Keys.MERGE
        why = ""
        for body in taken.above:
            here = body == taken.above[0]
            question = Question(body=body, posed=here, keys=keys, tolerance=_ROUNDING, cut=True)
            found = self._ask(name, whole, question)
            if not isinstance(found, Incomparable):
                self.cut[name] = found
                return None
            why = found.why
            if not found.lacks_body:
                break
        return why

    def _compile(self, member: PartRecord, name: str) -> str | None:
        """Compile the source alone and keep it; return MuJoCo's error message or None."""
        if member.subtree is not None:
            return self._take(member, name)
        return keep_source(member, self.session, name)


def _kept(member: PartRecord) -> str:
    """Return a name for the compiled source, shared by all parts with the same source."""
    stands = member.stands or member.source.format != "urdf"
    taken = "" if member.subtree is None else f"{member.subtree} of {member.keys is None} "
    read = f"{member.source.urdf} {member.source.packages} " if member.source.format == "urdf" else ""
    return f"alone {'' if stands else 'and loose '}{taken}{read}{member.source.path}"


def _question(
    member: PartRecord,
    excused: tuple[str, ...],
    replaced_keys: tuple[str, ...],
    merged: Mapping[str, Mapping[str, str]],
    edited: Mapping[str, Mapping[str, str]],
) -> Question:
    pose = member.pose
    renamed = {
        kind: {
            gone.removeprefix(member.prefix): kept
            for gone, kept in names.items()
            if gone.startswith(member.prefix)
        }
        for kind, names in merged.items()
    }
    renamed |= {kind: {**names, **renamed.get(kind, {})} for kind, names in edited.items()}
    keys, key_prefix = Keys.MERGE, None
    if member.keys is None:
        keys = Keys.NONE
    elif member.keys and member.keys == member.prefix:
        keys = Keys.PREFIX
    elif member.keys:
        key_prefix = member.keys
    return Question(
        prefix=member.prefix,
        body=member.body,
        pos=ORIGIN if pose is None else pose.pos,
        quat=IDENTITY_QUAT if pose is None else pose.quat,
        posed=pose is not None,
        keys=keys,
        key_prefix=key_prefix,
        welded=member.welded,
        renamed=renamed,
        ignore=excused,
        replaced_keys=replaced_keys,
    )

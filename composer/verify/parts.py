"""The parts of a compiled composition against their sources compiled alone, in MuJoCo's child process."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from composer import engine
from composer.plan.member import Member
from composer.pose import IDENTITY_QUAT, ORIGIN
from composer.verify.difference import Difference
from composer.verify.keyframes import Keys
from composer.verify.question import Question, ask, told

WHOLE = "whole"
"""The name under which the session keeps the composition."""


@dataclass(frozen=True, slots=True)
class Compared:
    """What came of one part: its differences, or why it could not be compared."""

    member: Member
    differences: tuple[Difference, ...] = ()
    obscure: str | None = None

    @property
    def ok(self) -> bool:
        return self.obscure is None and not self.differences


@dataclass(slots=True)
class Judge:
    """Compares parts with the composition that `session` keeps as `WHOLE`; a source is compiled once."""

    session: engine.Session
    alone: dict[Path, str | None] = field(default_factory=dict)

    def compare(self, member: Member, excused: Iterable[str] = ()) -> Compared:
        """The part as it is in the composition. `excused` are arrays, or ends of their names."""
        if member.obscure is not None:
            return Compared(member, obscure=member.obscure)
        path = member.source.path
        if path not in self.alone:
            self.alone[path] = self._compile(path)
        fault = self.alone[path]
        if fault is not None:
            return Compared(member, obscure=fault)
        question = _question(member, tuple(excused))
        answer = engine.call(self.session, ask, [_kept(path), WHOLE], question.to_json())
        if not answer.ok:
            return Compared(member, obscure=answer.error or answer.crash or "it cannot be compared")
        return Compared(member, tuple(told(answer.value)))

    def _compile(self, path: Path) -> str | None:
        """Keep the source compiled alone; a sentence where MuJoCo refuses it."""
        compiled = engine.compile(path.parent, path.name, keep=_kept(path), session=self.session)
        if compiled.ok:
            return None
        said = " ".join((compiled.error or compiled.crash or "").split())
        return f"MuJoCo does not accept its source alone: {said}"


def _kept(path: Path) -> str:
    return f"alone {path}"


def _question(member: Member, excused: tuple[str, ...]) -> Question:
    pose = member.pose
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
        ignore=excused,
    )

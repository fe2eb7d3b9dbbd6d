"""Compile the merged model, its parts and the recipe's model, and compare them."""

from __future__ import annotations

from pathlib import Path

from composer.dataclass import dataclass
from composer.diff.change import Change, Contrast
from composer.diff.models import contrast, contrast_of
from composer.engine import Session, call, compile
from composer.importing.entries import Names
from composer.importing.likeness import Likeness, is_rounding, likeness_of, numbers, unchanged
from composer.importing.match import Instance, parent_body
from composer.importing.propose import Proposal
from composer.verify.compiles import WHOLE

_TOLERANCE = 1e-7
_MERGED = "merged"


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the recipe's model, B, differs from the merged one, A; names are those of the recipe.

    `rounded` are numbers that are equal to six digits only, which is what MuJoCo writes when it saves a model.
    """

    changes: tuple[Change, ...] = ()
    rounded: tuple[Change, ...] = ()

    @property
    def same(self) -> bool:
        return not self.changes

    @property
    def amount(self) -> int:
        return len(self.changes)

    @property
    def lost_keys(self) -> list[Change]:
        return [each for each in self.changes if each.kind == "key" and each.what == "removed"]


class Trial:
    """The compiled models. The merged model and its parts are compiled once here, the recipe's model by the caller."""

    def __init__(self, merged: Path, parts: list[Path], session: Session) -> None:
        self.parts, self.session = parts, session
        compiled = compile(merged.absolute().parent, merged.name, keep=_MERGED, session=session)
        self.refused = None if compiled.ok else compiled.error
        self.compared = False
        self._parts: dict[int, bool] = {}

    def likeness(self, each: Instance, names: Names) -> Likeness:
        """Return which elements are the same in the part and the merged model; empty if MuJoCo rejects one of them."""
        if self.refused is not None:
            return Likeness()
        name = f"part {each.part}"
        if each.part not in self._parts:
            path = self.parts[each.part].absolute()
            self._parts[each.part] = compile(path.parent, path.name, keep=name, session=self.session).ok
        above = parent_body(each.body)
        body = None if above is None else above.get("name")
        if not self._parts[each.part] or (above is not None and body is None):
            return Likeness()
        given: dict[str, object] = {"prefix": each.prefix, "names": names, "body": body}
        answer = call(self.session, unchanged, [name, _MERGED], argument=given)
        if not answer.ok:
            return Likeness()
        self.compared = True
        return likeness_of(answer.value)

    def outcome(self, proposal: Proposal) -> Outcome | None:
        """Return how the model built last differs from the merged one, or None if they cannot be compared."""
        if self.refused is not None:
            return None
        given = {"tolerance": _TOLERANCE, "names": proposal.renamed}
        answer = call(self.session, contrast, [_MERGED, WHOLE], argument=given)
        if not answer.ok:
            return None
        seen = contrast_of(answer.value)
        found = [each for each in seen.changes if not _only_name(each, proposal)]
        found += _lost_without_name(seen, proposal)
        rounded = [each for each in found if each.what == "changed" and is_rounding(each)]
        return Outcome(tuple(each for each in found if each not in rounded), tuple(rounded))


def _lost_without_name(seen: Contrast, proposal: Proposal) -> list[Change]:
    """Return removals of unnamed keys that the recipe's model lacks; the contrast compares them with nothing."""
    keys = [each.what for each in seen.changes if each.kind == "key"]
    before, after = seen.elements["key"]
    lost = (before - keys.count("removed")) - (after - keys.count("added"))
    numbers = proposal.nameless_keys[: max(lost, 0)]
    return [Change("removed", "key", f"#{number}", index=(number, -1)) for number in numbers]


def _only_name(change: Change, proposal: Proposal) -> bool:
    """Return whether only names or signs differ.

    That is an equal asset under another name, or an additional one, or a negated quaternion.
    """
    if change.field.endswith("quat") and _opposite(change):
        return True
    if change.what == "added":
        return change.kind in _ASSETS and change.name in proposal.alike
    wanted, there = change.before, change.after
    if not isinstance(wanted, str) or not isinstance(there, str):
        return False
    own = proposal.alike.get(there)
    names = [wanted, *(each.out + wanted for each in proposal.found)]
    return there in names or (own is not None and any(proposal.alike.get(name) == own for name in names))


def _opposite(change: Change) -> bool:
    ours, theirs = numbers(change.before), numbers(change.after)
    return bool(ours and theirs) and all(abs(a + b) <= _TOLERANCE for a, b in zip(ours, theirs, strict=True))  # type: ignore[arg-type]


_ASSETS = ("texture", "material", "mesh", "hfield", "skin")

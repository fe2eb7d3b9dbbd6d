"""Describe what a pass or a step did to an element, with the place that is the reason."""

from __future__ import annotations

from composer.bundle.collect import collect
from composer.compose.reference_check import check_names
from composer.explain.explanation import Reason
from composer.explain.pass_words import CHANGES, GONE, MADE, VALUES, PassWords, hung_at, place
from composer.explain.step_words import of_step
from composer.explain.trace import Cause, Change, Life, Move, Trace
from composer.link.bodies import bodies
from composer.link.compiler import compiler
from composer.link.defaults import defaults
from composer.link.files import add_file
from composer.link.keyframes import keyframes
from composer.link.link import row_of
from composer.link.sections import sections


def rewrites(cause: Cause) -> bool:
    """Return whether a cause only rewrites a value or renames it, so that the value keeps its origin."""
    row = row_of(cause.done)
    return row.rewrites if row is not None else cause.function in (add_file, collect, check_names)


class Causes:
    """Words for the changes that one trace recorded."""

    def __init__(self, trace: Trace) -> None:
        self.passes = PassWords(trace)

    def change(self, change: Change, life: Life) -> Reason:
        """Return why an attribute changed."""
        cause = change.cause
        known = CHANGES.get(cause.function)
        if known is not None:
            reason = known(self.passes, change, life)
            if reason is not None:
                return reason
        return of_step(cause, change.owner, change.attribute, node=life.node)

    def made(self, life: Life) -> Reason:
        """Return why an element exists that was read from no file."""
        cause = life.made_by
        assert cause is not None
        known = MADE.get(cause.function)
        if known is not None:
            return known(self.passes, life, cause)
        return of_step(cause, life.owner, None)

    def value(self, life: Life, attribute: str) -> Reason:
        """Return why an element that a pass created has this value of an attribute."""
        cause = life.made_by
        assert cause is not None
        known = VALUES.get(cause.function)
        reason = None if known is None else known(self.passes, life, cause, attribute)
        return reason or self.made(life)

    def gone(self, life: Life) -> Reason:
        """Return why an element no longer exists."""
        cause = life.gone
        assert cause is not None
        known = GONE.get(cause.function)
        return known(self.passes, life, cause) if known is not None else of_step(cause, None, None)

    def move(self, move: Move, life: Life) -> Reason | None:
        """Return why an element moved, or None if the move means nothing, as in a merged section."""
        cause = move.cause
        if cause.function in (sections, defaults, compiler, keyframes):
            return None
        if cause.function is bodies:
            return None if cause.part is None else Reason(f"hung {place(cause.part)}", hung_at(cause.part))
        if (
            move.before is not None
            and move.after is not None
            and move.before.tag == move.after.tag == "mujoco"
        ):
            return None
        return of_step(cause, None, None)

"""What URDF cannot express and `write.py` finds itself: rows of the table that do not change the draft."""

from __future__ import annotations

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome


def _found_in_writing(draft: Draft) -> None:
    """Do nothing: the writer records each loss."""


FLOATING = Limit("roots", Outcome.WRITTEN, _found_in_writing)
SHAPES = Limit("shapes", Outcome.LEFT_OUT, _found_in_writing)
ARMATURE = Limit("armature", Outcome.LEFT_OUT, _found_in_writing)
MIMICS = Limit("equality", Outcome.PARTLY, _found_in_writing)
CONTROL = Limit("actuators", Outcome.PARTLY, _found_in_writing)

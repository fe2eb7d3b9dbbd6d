"""Robots of others as MuJoCo's own reader and Pinocchio read them; `make test-targets` and `make test-oldest` fetch them."""

from __future__ import annotations

import pytest
from targets.environments import is_ready
from urdf import survey


@pytest.mark.slow
@pytest.mark.skipif(not is_ready("robots"), reason="run `make test-targets`, which fetches the robots")
@pytest.mark.parametrize("robot", survey.QUICK)
def test_masses_and_places_are_those_of_other_readers(robot: str) -> None:
    root = survey.robots()
    assert root is not None
    found = list(survey.survey(root, (robot,)))
    assert found
    for each in found:
        assert each.model is not None, each.errors
        assert each.worst < survey.TOLERANCE, (each.name, each.alone, each.pinocchio)

"""Edits of a part alone, in its own names and units."""

from __future__ import annotations

import numpy as np
import pytest
from compose.arm import DEGREES, Case


def test_a_part_is_edited_alone_in_its_own_names(radian: Case) -> None:
    """And in its own unit of angle, whatever that of the model will be."""
    (radian.folder / "deg.xml").write_text(DEGREES)
    model = radian.model(
        "recipe: 1\nbase: ./arm.xml\nattach:\n  d: {model: ./deg.xml, pos: [0, 2, 0], keyframes: none, edit: "
        "[{select: {joint: elbow}, set: {range: [-10deg, 0.1rad]}, offset: {ref: 5deg}}, {select: {geom: lower}, rename: low}]}\n"
    )
    assert model.joint("d/elbow").range == pytest.approx([-np.radians(10), 0.1])
    assert model.joint("d/elbow").qpos0 == pytest.approx([np.radians(15)])
    assert model.geom("d/low").id > model.geom("lower").id
    assert model.joint("elbow").range == pytest.approx([-1.5, 1.5])

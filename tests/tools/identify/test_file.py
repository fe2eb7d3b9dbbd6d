"""The text of a file of measurements is read back as the numbers that were fitted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import pytest
from mjcompose.mujoco.fingerprint import fingerprints
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.identify.file import text_of
from tools.identify import robots


def number(kind: str, names: list[str], attribute: str, value: float, reason: str = "") -> dict[str, Any]:
    return {
        "kind": kind,
        "names": names,
        "attribute": attribute,
        "value": value,
        "std": 0.012345,
        "recipe": 0.0,
        "range": [-1.0, 30.0],
        "verdict": "not_identified" if reason else "",
        "reason": reason,
    }


NUMBERS = [
    number("joint", ["elbow"], "damping", 0.7654321),
    number("joint", ["elbow"], "zero", -0.0212345),
    number("joint", ["shoulder", "elbow"], "frictionloss", 0.3),
    number("actuator", ["elbow"], "kp", 21.0, 'only together with "x": y'),
]


def text(numbers: list[dict[str, Any]]) -> str:
    measured = [{key: each[key] for key in ("kind", "names", "attribute")} for each in numbers]
    fit = {
        "topics": fingerprints(mujoco, robots.model(), {"prefix": "", "numbers": measured})["topics"],
        "recordings": [{"file": "a b: c.csv", "sha256": "12", "seconds": 1.0, "samples": 100}],
        "held_out": [],
        "errors": [{"signal": "qpos elbow", "recipe": 1e-3, "fitted": 1e-4, "correlated": 1.0, "held_out": {}}],
        "numbers": numbers,
        "correlation": [
            [1.0 if row == column else -0.25 for column in range(len(numbers))] for row in range(len(numbers))
        ],
    }
    return text_of("12", Path("arm.yaml"), fit, "4.0.0", {"elbow", "shoulder"})


def test_a_file_is_read_back(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(robots.MODEL.format(**robots.RECIPE))
    (tmp_path / "A12.yaml").write_text(text(NUMBERS), encoding="utf-8")
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nmeasured: A12.yaml\n")
    context = Context(folder=tmp_path)
    built = build(ModelRequest(tmp_path / "recipe.yaml"), context)
    assert built is not None, context.sink.diagnostics
    model = mujoco.MjModel.from_xml_string(built.bundle.files[built.bundle.model].decode())
    elbow = model.joint("elbow")
    assert elbow.damping[0] == pytest.approx(0.7654, abs=1e-4)
    assert model.qpos0[elbow.qposadr[0]] == pytest.approx(-0.0212)
    assert model.dof_frictionloss.tolist() == [0.3, 0.3]
    assert model.actuator("elbow").gainprm[0] == 20  # it is not identified
    assert model.jnt_range[elbow.id] == pytest.approx([-2 - 0.0212, 2 - 0.0212])

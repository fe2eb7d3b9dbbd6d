"""Whatever compiles alone composes, compiles, and is in the composition what it was alone.

`MJCOMPOSE_EXAMPLES=5000 pytest tests/properties` looks further, at other examples every time.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

import mujoco
import pytest
from feature_cases.judging import differences
from feature_cases.members import members
from hypothesis import HealthCheck, given, reject, settings
from mjcompose.bundle.assemble import assemble
from mjcompose.compose.compose import Composer
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write
from properties.compositions import Composition, compositions

EXAMPLES = int(os.environ.get("MJCOMPOSE_EXAMPLES", "60"))

MASSLESS = "mass and inertia of moving bodies"
"""A joint above a part whose root has no mass: not for the linker to mend."""

REFUSED = (
    "nothing that is fixed to the joint has mass",
    "would multiply",
    "keyframes of a model with this `<replicate>`",
    "would take another gain",
    "MuJoCo drops the `<",
)
"""What a replicate takes for replicated by a fault of MuJoCo's, and actuators of several top-level defaults."""


pytestmark = pytest.mark.skipif(
    int(mujoco.mj_versionString().partition(".")[0]) < 4,
    reason="MuJoCo 3 copies keys with a replicate, and reads orientations of classes in another order",
)


@pytest.fixture(autouse=True)
def quiet() -> None:
    """MuJoCo warns of a model on standard error and in a log file."""
    mujoco.set_mju_user_warning(lambda message: None)


@settings(
    max_examples=EXAMPLES,
    derandomize="MJCOMPOSE_EXAMPLES" not in os.environ,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
@given(compositions())
def test_every_part_is_what_it_is_alone(composition: Composition) -> None:
    check(composition)


def check(composition: Composition) -> None:
    with tempfile.TemporaryDirectory() as name:
        recipe = composition.write(Path(name))
        try:
            text, told = composed(recipe)
            model = mujoco.MjModel.from_xml_string(text) if text is not None else None
        except ValueError as error:
            if MASSLESS in str(error) and "joint:" in "".join(composition.recipes):
                reject()
            raise
        if any(each in line for each in REFUSED for line in told):
            reject()
        assert text is not None and model is not None, told
        assert text == composed(recipe)[0]
        found = differences(list(members(recipe)), model)
        assert not found, "\n".join([*found, text])


def composed(recipe: Path) -> tuple[str | None, list[str]]:
    """The text of the model, or None with what is told; MuJoCo measures in this process."""
    context = Context(environment={}, folder=recipe.parent)
    plan = make_plan(recipe, context)
    assert plan is not None, context.sink.diagnostics
    made = Composer(context, measured).compose(plan)
    told = [f"{found.code}: {found.message}" for found in context.sink.diagnostics]
    if made is None:
        return None, told
    bundle = assemble(plan, made.model, made.files, context)
    assert bundle is not None
    return bundle.files[bundle.model].decode(), told


def measured(unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
    try:
        model = mujoco.MjModel.from_xml_string(write(unit.root).decode())
    except ValueError:
        if attempt:
            return {}
        raise
    return {name: [float(value) for value in _list(getattr(model, name))] for name in arrays}


def _list(value: object) -> list[float]:
    if isinstance(value, bytes):  # the names
        return list(value)
    return value.ravel().tolist() if hasattr(value, "ravel") else [value]  # type: ignore[list-item]

"""What other programs read of what is written for them. `make test-targets` installs these programs."""

from __future__ import annotations

import json
import os
from pathlib import Path

import mujoco
import pytest
from mjcompose.cli.main import main
from mjcompose.targets.table import READ_BACK
from targets.environments import is_ready
from targets.models import PROBES, RECIPES
from targets.read_back import READ_WITH, Found, read_in, row

pytestmark = pytest.mark.slow

RECIPES_READ = ("demo", "hoist", "two_arms", "menagerie_table")


@pytest.mark.parametrize("name", RECIPES_READ)
@pytest.mark.parametrize("consumer", READ_WITH)
def test_it_reads_the_recipe(consumer: str, name: str, tmp_path: Path) -> None:
    _ready(consumer)
    if name.startswith("menagerie") and not os.environ.get("MENAGERIE_ROOT"):
        pytest.skip("MENAGERIE_ROOT names no models")
    with pytest.raises(SystemExit) as ended:
        main(["build", str(RECIPES / f"{name}.yaml"), "-o", f"{tmp_path}/truth/", "-q"])
    assert not ended.value.code
    found = read_in(consumer, tmp_path / "truth" / "model.xml", tmp_path)
    if not isinstance(found, Found):
        pytest.skip(f"the build refuses it: {found}")
    assert not found.differences, "\n".join(found.differences)


@pytest.mark.parametrize("consumer", READ_WITH)
def test_the_table_says_what_it_reads(consumer: str) -> None:
    """In the table are the numbers that were compared, in models that have all of them."""
    _ready(consumer)
    assert json.loads(READ_BACK.read_text(encoding="utf-8"))[consumer] == row(consumer), (
        "`python tests/targets/read_back.py` writes it"
    )


def test_the_probes_have_everything() -> None:
    """What no probe has would never be found missing."""
    models = [mujoco.MjModel.from_xml_string(text) for text in PROBES.values()]
    for array in (
        "dof_damping",
        "dof_dampingpoly",
        "dof_frictionloss",
        "dof_armature",
        "jnt_stiffness",
        "jnt_actfrclimited",
        "jnt_limited",
        "actuator_forcelimited",
        "actuator_ctrllimited",
        "actuator_biasprm",
    ):
        assert any(getattr(model, array).any() for model in models), array
    assert {int(kind) for model in models for kind in model.geom_type} >= set(range(8))
    assert {int(kind) for model in models for kind in model.jnt_type} == set(range(4))


def _ready(consumer: str) -> None:
    if not is_ready(READ_WITH[consumer].program):
        pytest.skip(f"{READ_WITH[consumer].program} is not installed: `make test-targets` does that")

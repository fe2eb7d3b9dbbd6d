"""What other programs read of what is written for them. `make test-targets` installs these programs."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest
from targets.environments import is_ready, python_of
from targets.models import RECIPES, SELDOM

from composer.cli.main import main
from composer.targets.checks import placed
from composer.targets.judging import faults, poses
from composer.targets.reading import READERS, Reader, read_back

pytestmark = pytest.mark.slow

READ_WITH: dict[str, Reader] = {**READERS, "urdf in pybullet": READERS["pybullet"]}
MODELS = ("seldom", "demo", "hoist", "two_arms", "menagerie_table")
REFUSED = {("mjx", name) for name in ("demo", "two_arms", "hoist", "menagerie_table")}
"""MJX computes no contacts of a cylinder with a box or a mesh, which is an error of the build."""
FLOATING = {("urdf in pybullet", name) for name in ("demo", "two_arms", "hoist")}
"""PyBullet takes the floating joints of URDF for fixed ones."""


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("consumer", READ_WITH)
def test_it_reads_the_model(consumer: str, name: str, tmp_path: Path) -> None:
    reader = READ_WITH[consumer]
    if not is_ready(reader.program):
        pytest.skip(f"{reader.program} is not installed: `make test-targets` does that")
    if name.startswith("menagerie") and not os.environ.get("MENAGERIE_ROOT"):
        pytest.skip("MENAGERIE_ROOT names no models")
    if (consumer, name) in REFUSED:
        pytest.skip("the build refuses it")
    if (consumer, name) in FLOATING:
        pytest.skip("PyBullet takes the floating joints of URDF for fixed ones")
    recipe = RECIPES / f"{name}.yaml"
    if name == "seldom":
        recipe = tmp_path / "seldom.yaml"
        recipe.write_text("recipe: 1\nbase: ./seldom.xml\n")
        (tmp_path / "seldom.xml").write_text(SELDOM)
    target = consumer.partition(" ")[0]
    truth = _built(recipe, None, tmp_path / "truth")
    made = _built(recipe, target, tmp_path / target)
    model = mujoco.MjModel.from_xml_path(str(truth / "model.xml"))
    asked = poses(model)
    file = next((each.name for each in made.glob("model.urdf")), "model.xml")
    facts = read_back(reader, str(python_of(reader.program)), placed(made, file), asked)
    assert not isinstance(facts, str), facts
    found = list(faults(mujoco, model, facts, asked, reader.single))
    assert not found, "\n".join(found)


def _built(recipe: Path, target: str | None, out: Path) -> Path:
    arguments = ["build", str(recipe), "-o", f"{out}/", "-q", *(["--target", target] if target else [])]
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert not ended.value.code
    return out

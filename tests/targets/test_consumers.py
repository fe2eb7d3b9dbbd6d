"""What other programs read of what is written for them. `make test-targets` installs these programs."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import mujoco
import pytest
from lxml import etree
from targets.environments import PACKAGES, READERS, is_ready, python_of
from targets.judging import faults, poses
from targets.models import RECIPES, SELDOM

from composer.cli.main import main

pytestmark = pytest.mark.slow

READ_WITH = {name: name for name in PACKAGES} | {"urdf": "pinocchio", "urdf in pybullet": "pybullet"}
SINGLE = ("pybullet", "newton")
MODELS = ("seldom", "demo", "hoist", "two_arms", "menagerie_table")
REFUSED = {("mjx", name) for name in ("demo", "two_arms", "hoist", "menagerie_table")}
"""MJX computes no contacts of a cylinder with a box or a mesh, which is an error of the build."""
FLOATING = {("urdf in pybullet", name) for name in ("demo", "two_arms", "hoist")}
"""PyBullet takes the floating joints of URDF for fixed ones."""


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("consumer", READ_WITH)
def test_it_reads_the_model(consumer: str, name: str, tmp_path: Path) -> None:
    reader = READ_WITH[consumer]
    if not is_ready(reader):
        pytest.skip(f"{reader} is not installed: `make test-targets` does that")
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
    facts = _facts(reader, made, asked, tmp_path)
    found = list(faults(model, facts, asked, reader in SINGLE))
    assert not found, "\n".join(found)


def _built(recipe: Path, target: str | None, out: Path) -> Path:
    arguments = ["build", str(recipe), "-o", f"{out}/", "-q", *(["--target", target] if target else [])]
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert not ended.value.code
    if target == "urdf":  # as a package lies in a workspace
        manifest = etree.parse(out / "package.xml")
        out = out.rename(out.with_name(str(manifest.findtext("name"))))
    return out


def _facts(reader: str, made: Path, asked: list[dict[str, Any]], folder: Path) -> dict[str, Any]:
    (folder / "poses.json").write_text(json.dumps(asked))
    model = next(iter(made.glob("model.urdf")), made / "model.xml")
    command = [
        str(python_of(reader)),
        "-I",
        str(READERS / f"{reader}.py"),
        str(model),
        str(folder / "poses.json"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300, cwd=made.parent)
    assert done.returncode == 0, done.stderr[-2000:]
    facts: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return facts

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import ValidationError

from composer.diagnostics import Diagnostic
from composer.recipe import Angle, Base, Recipe

ROOT = Path(__file__).parents[2]


def test_defaults(recipe: Callable[[str], Recipe]) -> None:
    read = recipe("")
    assert (read.name, read.description, read.angle, read.base) == (None, None, None, None)
    assert (read.eulerseq, read.separator, read.conflict) == ("xyz", "/", "error")
    assert (read.attach, read.add, read.sensor, read.option) == ({}, (), (), None)


def test_head(recipe: Callable[[str], Recipe]) -> None:
    read = recipe(
        """
        name: cell
        description: ""
        angle: radian
        eulerseq: ZYX
        separator: "__"
        conflict: merge
        base: ./arm.xml
        """
    )
    assert (read.name, read.description, read.angle, read.eulerseq) == ("cell", "", "radian", "ZYX")
    assert (read.separator, read.conflict) == ("__", "merge")
    assert read.base == Base(model="./arm.xml", keyframes="merge")


def test_base_as_a_mapping(recipe: Callable[[str], Recipe]) -> None:
    assert recipe("base: {model: ./arm.xml, keyframes: none}").base == Base(
        model="./arm.xml", keyframes="none"
    )


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("base: [./arm.xml]", "wrong-type"),
        ("base: 3", "wrong-type"),
        ('base: ""', "wrong-type"),
        ("base: {}", "missing-key"),
        ("name: ''", "wrong-type"),
        ("eulerseq: xy", "wrong-keyword"),
        ("angle: 1", "wrong-type"),
        ("attach: 1", "wrong-type"),
    ],
)
def test_wrong_head(faults: Callable[[str], list[Diagnostic]], text: str, code: str) -> None:
    assert [fault.code for fault in faults(text)] == [code]


def test_frozen(recipe: Callable[[str], Recipe]) -> None:
    with pytest.raises(ValidationError):
        recipe("name: cell").name = "other"  # type: ignore[misc]


def test_python_data_without_places() -> None:
    read = Recipe.model_validate({"recipe": 1, "add": [{"to": "hand", "site": {"euler": [0, 90, "1rad"]}}]})
    assert read.add[0].element.attributes["euler"] == (0, 90, Angle(1.0, "rad"))
    assert read.add[0].element.at == ()


PROBE = """
import sys, time
def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result
def pydantic():
    from pydantic import BaseModel, ValidationError, model_validator
    class Model(BaseModel):
        x: int
    Model(x=1)
def read():
    from composer.recipe import validate
    return validate(node, sink)
base, _ = timed(pydantic)
from composer.document import load
from composer.diagnostics import Sink
sink = Sink()
node = load(open(sys.argv[1]).read(), "recipe.yaml", sink)
own, recipe = timed(read)
assert recipe is not None
unwanted = {"lxml", "numpy", "mujoco", "composer.recipe.schema"}
print(own / base, *unwanted.intersection(sys.modules))
"""


def test_reading_costs_little_beside_pydantic(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(tmp_path)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, "-c", PROBE, str(ROOT / "recipes" / "demo.yaml")]
    ratios = []
    for _ in range(4):  # the first one compiles
        done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True)
        ratio, *heavy = done.stdout.split()
        assert heavy == []
        ratios.append(float(ratio))
    assert min(ratios) < 0.6

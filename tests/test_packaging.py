"""What packages mjcompose elsewhere than on PyPI says the same as `pyproject.toml`."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parent.parent
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())
RECIPE: dict[str, Any] = yaml.safe_load((ROOT / ".github/conda/recipe.yaml").read_text())
ON_CONDA = {"mujoco": "mujoco-python"}
"""Names of packages that conda-forge calls otherwise."""


def _requirement(text: str) -> tuple[str, str]:
    name, bound = re.fullmatch(r"([\w-]+) *(.*)", text).groups()  # type: ignore[union-attr]
    return ON_CONDA.get(name, name), bound


def test_conda_has_the_requirements_of_the_project() -> None:
    expected = {_requirement(text) for text in PROJECT["project"]["dependencies"]}
    expected.add(("python", PROJECT["project"]["requires-python"]))
    assert {_requirement(text) for text in RECIPE["requirements"]["run"]} == expected
    (backend,) = PROJECT["build-system"]["requires"]
    assert _requirement(backend) in {_requirement(text) for text in RECIPE["requirements"]["host"]}
    ((command, function),) = PROJECT["project"]["scripts"].items()
    assert RECIPE["build"]["python"]["entry_points"] == [f"{command} = {function}"]


def test_a_release_has_one_version() -> None:
    initial = (ROOT / "composer/mjcompose/base/__init__.py").read_text()
    version = re.search(r'^__version__ = "(.*)"', initial, re.M)[1]  # type: ignore[index]
    assert RECIPE["context"]["version"] == version
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == version


def test_the_container_image_gets_all_that_the_wheel_needs() -> None:
    lines = (ROOT / ".dockerignore").read_text().splitlines()
    assert lines[0] == "*"
    copied = [Path(line[1:]) for line in lines if line.startswith("!")]
    targets = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    needed = [*targets["packages"], *targets["force-include"], PROJECT["project"]["readme"], "pyproject.toml"]
    missing = [path for path in map(Path, needed) if not any(path.is_relative_to(source) for source in copied)]
    assert missing == []
    assert all((ROOT / path).exists() for path in copied)


def test_pixi_has_the_extras_of_the_project() -> None:
    pixi = tomllib.loads((ROOT / "pixi.toml").read_text())
    assert pixi["dependencies"]["python"] == PROJECT["project"]["requires-python"]
    assert set(pixi["pypi-dependencies"]["mjcompose"]["extras"]) <= set(PROJECT["project"]["optional-dependencies"])

"""A repository for models: recipes, lock, parts, checks before a commit and in CI, and a README."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from importlib import resources
from pathlib import Path

from composer.starting.recipe import yaml_name
from composer.version import __version__

# The path of each template. In templates, PROJECT, MODEL, VERSION and MUJOCO are placeholders.
_FILES = {
    "README.md": "README.md",
    "gitignore": ".gitignore",
    "requirements.txt": "requirements.txt",
    "pre-commit-config.yaml": ".pre-commit-config.yaml",
    "workflow.yml": ".github/workflows/models.yml",
    "recipe.yaml": "recipes/MODEL.yaml",
    "pendulum.xml": "models/pendulum/pendulum.xml",
    "pendulum_license": "models/pendulum/LICENSE",
}
# Files that the lock pins: with another content of one of them the project does not build.
_NEEDED = (
    "recipes/MODEL.yaml",
    "recipes/MODEL.lock",
    "models/pendulum/pendulum.xml",
    "models/pendulum/LICENSE",
)
# Files to which users add lines of their own.
_SHARED = ("requirements.txt", ".gitignore")
_ACTION = ".github/actions/mjcompose/action.yml"


def project(title: str, model: str, mujoco: str, schema: str) -> dict[str, str]:
    """Return the files of a project by path. `model` is the name of its first model, `schema` the schema of recipes."""
    package = resources.files(__package__)
    given = {"PROJECT": title, "VERSION": __version__, "MUJOCO": mujoco}
    files = {
        _filled(path, {"MODEL": model}): _filled(
            package.joinpath("project", name).read_text(encoding="utf-8"),
            {**given, "MODEL": yaml_name(model) if name == "recipe.yaml" else model},
        )
        for name, path in _FILES.items()
    }
    return {**files, _ACTION: _action(), "recipes/recipe.schema.json": schema}


def needed(model: str) -> frozenset[str]:
    r"""Return the paths of files that cannot be kept with another content."""
    return frozenset(_filled(path, {"MODEL": model}) for path in _NEEDED)


def lacking(path: str, there: str, own: str) -> list[str]:
    r"""Return the lines of the project's file that an existing file in its place lacks.

    >>> lacking("requirements.txt", "numpy\n", "mujoco==4.0.0\n")
    ['mujoco==4.0.0']
    """
    known = {line.strip() for line in there.splitlines()}
    return [line for line in own.splitlines() if line not in known] if path in _SHARED else []


def _filled(text: str, given: Mapping[str, str]) -> str:
    """Fill in all placeholders at once, because values may contain one. `MUJOCO_LOG` is another word than `MUJOCO`."""
    return re.sub(rf"\b({'|'.join(given)})\b", lambda found: given[found[0]], text)


def _action() -> str:
    """Return the GitHub action: next to this file in an installed package, at the top of a clone."""
    installed = Path(__file__).with_name("action.yml")
    return (installed if os.path.exists(installed) else Path(__file__).parents[2] / "action.yml").read_text(
        "utf-8"
    )

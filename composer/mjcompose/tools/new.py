"""Starter recipes, projects and examples."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Collection, Mapping
from importlib import resources
from pathlib import Path

from mjcompose.base import __version__
from mjcompose.base.files import read_regular
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import move, resolved_output, staged_folder


def starter(name: str) -> str:
    return _template("starter.yaml", {"MODEL": yaml_name(name)})


def yaml_name(name: str) -> str:
    """Return a name as YAML text, quoted if necessary."""
    plain = re.fullmatch(r"[A-Za-z_][\w-]*", name, re.ASCII) and name.lower() not in ("true", "false", "null")
    return name if plain else json.dumps(name, ensure_ascii=False)


_NOT_MODELS = ("README.md", "make_meshes.py")
"""Files of the repository: pages whose links lead into it, and the program that made the meshes."""


def examples(schema: str) -> dict[str, bytes]:
    """Return the files of the examples by path, with their license; `schema` is the schema of recipes."""
    folder = _shipped("examples", "recipes")
    license = _shipped("examples/LICENSE", "LICENSE")
    paths = (path for path in sorted(folder.rglob("*")) if os.path.isfile(path) and path.name not in _NOT_MODELS)
    files = {path.relative_to(folder).as_posix(): _read(path) for path in paths if "__pycache__" not in path.parts}
    return {**files, "LICENSE": license.read_bytes(), "recipe.schema.json": schema.encode()}


def _shipped(installed: str, cloned: str) -> Path:
    """Return a file or folder: next to this file in an installed package, at the top of a clone."""
    beside = Path(__file__).parent / installed
    return beside if os.path.exists(beside) else Path(__file__).parents[3] / cloned


def _read(path: Path) -> bytes:
    """Return the content, with the schema next to the recipe instead of a folder above."""
    content = path.read_bytes()
    is_recipe = path.suffix == ".yaml"
    return content.replace(b"../schemas/recipe.schema.json", b"recipe.schema.json", 1) if is_recipe else content


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
_NEEDED = ("recipes/MODEL.yaml", "recipes/MODEL.lock", "models/pendulum/pendulum.xml", "models/pendulum/LICENSE")
# Files to which users add lines of their own.
_SHARED = ("requirements.txt", ".gitignore")
_ACTION = ".github/actions/mjcompose/action.yml"


def project(title: str, model: str, mujoco: str, schema: str) -> dict[str, str]:
    """Return the files of a project by path, with its first model, `model`, and the `schema` of recipes."""
    given = {"PROJECT": title, "VERSION": __version__, "MUJOCO": mujoco}
    files = {}
    for name, path in _FILES.items():
        called = yaml_name(model) if name == "recipe.yaml" else model
        files[path.replace("MODEL", model)] = _template(name, {**given, "MODEL": called})
    action = _shipped("action.yml", "action.yml").read_text("utf-8")
    return {**files, _ACTION: action, "recipes/recipe.schema.json": schema}


def needed(model: str) -> frozenset[str]:
    """Return the paths of files that cannot be kept with another content."""
    return frozenset(path.replace("MODEL", model) for path in _NEEDED)


def lacking(path: str, there: str, own: str) -> list[str]:
    r"""Return the lines of the project's file that an existing file in its place lacks.

    >>> lacking("requirements.txt", "numpy\n", "mujoco==4.0.0\n")
    ['mujoco==4.0.0']
    """
    known = {line.strip() for line in there.splitlines()}
    return [line for line in own.splitlines() if line not in known] if path in _SHARED else []


def _template(name: str, given: Mapping[str, str]) -> str:
    """Return a template with all placeholders filled in at once, because values may contain one.

    `MUJOCO_LOG` is a different word from `MUJOCO`.
    """
    text = resources.files(__package__).joinpath("project", name).read_text(encoding="utf-8")
    return re.sub(rf"\b({'|'.join(given)})\b", lambda found: given[found[0]], text)


def write_project(
    files: Mapping[str, bytes], needed: Collection[str], folder: Path, finish: Callable[[Path], object]
) -> tuple[list[str], list[str]]:
    """Write files below `folder`, which may exist; `finish` adds to them before they become visible.

    Return the paths of the written files, and of existing files that are kept. Raises OutputError, even if a `needed`
    file exists with another content; exceptions of `finish` propagate.
    """
    with staged_folder(folder, into=True) as stage:
        for path, content in files.items():
            (stage / path).parent.mkdir(parents=True, exist_ok=True)
            (stage / path).write_bytes(content)
        finish(stage)
        made = sorted(path.relative_to(stage).as_posix() for path in stage.rglob("*") if os.path.isfile(path))
        kept = [path for path in made if _is_kept(folder / path, stage / path, folder, needed=path in needed)]
        written = [path for path in made if path not in kept]
        move(stage, resolved_output(folder), written)
        return written, kept


def _is_kept(place: Path, made: Path, folder: Path, needed: bool) -> bool:
    """Return whether a file exists already. Raises OutputError for anything that blocks the project."""
    above = (each for each in place.parents if each.is_relative_to(folder) and each != folder)
    files = [each for each in above if os.path.lexists(each) and not os.path.isdir(each)]
    exists = os.path.lexists(place)
    blocked = (files or [place])[-1]
    why = "and is a folder" if os.path.isdir(place) else "and is no folder" if files else ""
    if not why and exists and needed and (not os.path.exists(place) or read_regular(place) != read_regular(made)):
        why = "with another content than the project needs"
    if why:
        message = f"`{blocked}` exists already, {why}: nothing is written"
        raise OutputError("output-unwritable", message, "choose another folder, or move it away")
    return exists

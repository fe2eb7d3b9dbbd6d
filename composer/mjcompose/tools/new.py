"""Starter recipes, projects and examples."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Collection, Mapping
from importlib import resources
from pathlib import Path

from mjcompose.base.files import read_regular
from mjcompose.base.version import __version__
from mjcompose.build.bundle.bundle import OutputError
from mjcompose.build.bundle.staging import move, resolved_output, staged_folder

_STARTER = """\
# For completion in your editor: mjcompose schema > recipe.schema.json, and as the first line here:
#   yaml-language-server: $schema=recipe.schema.json
recipe: 1                       # the version of the recipe language

name: {name}
description: A pendulum over a floor; replace it with your own parts.
angle: degree                   # the unit of the angles in this file; `90deg` and `1.57rad` always work

# The model to start from keeps its own names. Without `base` the model starts empty.
# base: menagerie:universal_robots_ur5e/ur5e

# Parts, by the prefix that their names get. A model reference is a path relative to this file,
# package:NAME/path.xml or menagerie:ROBOT/ENTRY; another recipe is a model too.
# attach:
#   gripper:
#     model: menagerie:robotiq_2f85/2f85
#     site: attachment_site     # or body: / frame:; none of them: the world

option: {{timestep: 0.002, integrator: implicitfast}}

add:
  - to: world
    geom: {{name: floor, type: plane, size: [2, 2, 0.1], rgba: [0.8, 0.8, 0.8, 1]}}
  - to: world
    light: {{pos: [0, 0, 3], dir: [0, 0, -1]}}
  - to: world
    body:
      name: pendulum
      pos: [0, 0, 1]
      joint: [{{name: hinge, type: hinge, axis: [0, 1, 0], range: [-90, 90], damping: 0.1}}]
      geom: [{{name: rod, type: capsule, fromto: [0, 0, 0, 0, 0, -0.5], size: [0.02]}}]
      site: [{{name: tip, pos: [0, 0, -0.5]}}]

actuator:
  motor: {{type: motor, joint: hinge, gear: [1], ctrlrange: [-2, 2]}}

sensor:
  angle: {{type: jointpos, joint: hinge}}
  tip_position: {{type: framepos, objtype: site, objname: tip}}
"""


def starter(name: str) -> str:
    """Return the text of a recipe for a model of that name."""
    return _STARTER.format(name=yaml_name(name))


def yaml_name(name: str) -> str:
    """Return a name as YAML text, quoted if necessary."""
    plain = re.fullmatch(r"[A-Za-z_][\w-]*", name, re.ASCII) and name.lower() not in ("true", "false", "null")
    return name if plain else json.dumps(name, ensure_ascii=False)


_SCHEMA_IN_CLONE = b"../schemas/recipe.schema.json"
_SCHEMA_BESIDE = b"recipe.schema.json"
_NOT_MODELS = ("README.md", "make_meshes.py")
"""What belongs to the repository: pages whose links lead into it, and the program that made the meshes."""


def examples(schema: str) -> dict[str, bytes]:
    """Return the files of the examples by path, with their license; `schema` is the schema of recipes."""
    folder, license = _places()
    paths = (path for path in sorted(folder.rglob("*")) if os.path.isfile(path) and path.name not in _NOT_MODELS)
    files = {path.relative_to(folder).as_posix(): _read(path) for path in paths if "__pycache__" not in path.parts}
    return {**files, "LICENSE": license.read_bytes(), "recipe.schema.json": schema.encode()}


def _places() -> tuple[Path, Path]:
    """Return the folder and the license: beside this file in an installed package, at the top of a clone."""
    beside = Path(__file__).with_name("examples")
    root = Path(__file__).parents[3]
    return (beside, beside / "LICENSE") if os.path.isdir(beside) else (root / "recipes", root / "LICENSE")


def _read(path: Path) -> bytes:
    """Return the content. The schema of a recipe is beside it here, and a folder above in the repository."""
    content = path.read_bytes()
    return content.replace(_SCHEMA_IN_CLONE, _SCHEMA_BESIDE, 1) if path.suffix == ".yaml" else content


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
    return (installed if os.path.exists(installed) else Path(__file__).parents[3] / "action.yml").read_text("utf-8")


def write_project(
    files: Mapping[str, bytes], needed: Collection[str], folder: Path, finish: Callable[[Path], object]
) -> tuple[list[str], list[str]]:
    """Write files below `folder`, which may exist; `finish` adds to them before they become visible.

    Return the paths of the written files, and of existing ones that are kept. Raises OutputError, also if a
    `needed` file exists with another content; exceptions of `finish` propagate.
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
    above = place.parent
    while above != folder:
        if os.path.lexists(above) and not os.path.isdir(above):
            raise _in_the_way(above, "and no folder")
        above = above.parent
    if not os.path.lexists(place):
        return False
    if os.path.isdir(place):
        raise _in_the_way(place, "and a folder")
    if needed and (not os.path.exists(place) or read_regular(place) != read_regular(made)):
        raise _in_the_way(place, "with another content than the project needs")
    return True


def _in_the_way(path: Path, what: str) -> OutputError:
    return OutputError(
        "output-unwritable",
        f"`{path}` exists already, {what}: nothing is written",
        "choose another folder, or move it away",
    )

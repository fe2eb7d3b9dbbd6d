"""`mjcompose new`: a starter recipe that builds as it stands."""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from pathlib import Path

import click

from composer.cli.reporting import FINDINGS, report

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


def _yaml(name: str) -> str:
    """A name as YAML text: as it stands where it reads as a name, else quoted."""
    plain = re.fullmatch(r"[A-Za-z_][\w-]*", name, re.ASCII) and name.lower() not in ("true", "false", "null")
    return name if plain else json.dumps(name, ensure_ascii=False)


@click.command()
@click.argument("path", type=click.Path(path_type=Path), default=Path("model.yaml"))
def command(path: Path) -> None:
    """Write a commented starter recipe to PATH (default: model.yaml). It builds as it stands."""
    from composer.bundle.output_error import OutputError, unwritable
    from composer.bundle.staging import staged_file
    from composer.context import Context, as_text

    if path.suffix.lower() not in (".yaml", ".yml"):
        raise click.UsageError(f"a recipe's name ends in .yaml: {path.with_suffix('.yaml')}")
    context = Context()
    if os.path.lexists(path):
        context.sink.error(
            "output-unwritable",
            f"`{path}` is there already and is left as it is",
            help="choose another name, or remove the file",
        )
        report(context, "text")
        sys.exit(FINDINGS)
    try:
        with staged_file(path) as stage:
            stage.write_text(_STARTER.format(name=_yaml(as_text(path.stem))), encoding="utf-8")
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
    except OSError as error:
        told = unwritable(path, error)
        context.sink.error(told.code, told.message, help=told.help)
    report(context, "text")
    if context.sink.has_errors:
        sys.exit(FINDINGS)
    click.echo(f"wrote {path}; build it with: mjcompose build {shlex.quote(str(path))}")

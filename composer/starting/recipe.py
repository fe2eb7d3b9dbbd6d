"""A commented starter recipe that builds as it is."""

from __future__ import annotations

import json
import re

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

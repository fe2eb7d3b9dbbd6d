"""Verb `inertia`: compute mass and inertia of bodies from their geoms."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema, kind_of, or_template, reference, unknown_key
from mjcompose.language.verbs.values import Changed, Selected, Verb, read_mapping, with_values

FROM, DENSITY, GROUP = "from", "density", "group"
SOURCES = ("mesh", "geoms")
_EXAMPLE = "{from: mesh, density: 1000}"


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("inertia", value, _EXAMPLE, selected=selected)
    if given is None:
        return {}
    if selected.kinds and not any(kind.path == "body" for kind in selected.kinds):
        message = f"`inertia` is for bodies, and `{selected.tag}` is not one"
        selected.add(Fault("wrong-type", message, selected.at, help="write `select: {body: NAME}`"))
        return {}
    for name in given:
        if name not in (FROM, DENSITY, GROUP):
            message = f"`inertia` has no key `{name}`"
            selected.add(unknown_key(message, name, (FROM, DENSITY, GROUP), at=(*selected.at, name)))
    for name, example in ((FROM, "mesh"), (DENSITY, "1000")):
        if name not in given:
            help = f"write `{name}: {example}`" + (", in kg/m³" if name == DENSITY else "")
            selected.add(Fault("missing-key", f"`inertia` lacks `{name}`", selected.at, help=help))
    if FROM in given and given[FROM] not in SOURCES:
        message = f"`from` is `mesh` or `geoms`, got {kind_of(given[FROM])}"
        selected.add(Fault("wrong-keyword", message, (*selected.at, FROM), help="write `from: mesh`"))
    density = given.get(DENSITY, 1)
    if isinstance(density, bool) or not isinstance(density, int | float) or not math.isfinite(density):
        message = f"`density` of `inertia` expects a number, got {kind_of(density)}"
        selected.add(Fault("wrong-type", message, (*selected.at, DENSITY)))
    elif density <= 0:
        message = f"`density` of `inertia` is {density:g}, and must be more than 0"
        selected.add(Fault("out-of-range", message, (*selected.at, DENSITY)))
    group = given.get(GROUP, 0)
    if isinstance(group, bool) or not isinstance(group, int):
        message = f"`group` of `inertia` expects a whole number, got {kind_of(group)}"
        selected.add(Fault("wrong-type", message, (*selected.at, GROUP)))
    return dict(given)


def _words(value: Mapping[str, Any]) -> str:
    return f"inertia from {value[FROM]}{with_values(value, FROM)}"


def _changes(tag: str | None, value: Mapping[str, Any]) -> Changed:
    return [("inertial", name) for name in ("mass", "pos", "quat", "diaginertia")]


def _schema() -> Schema:
    return {
        "type": "object",
        "properties": {
            FROM: or_template(
                {
                    "enum": [*SOURCES],
                    "description": "from the geoms that are meshes, or from all geoms of the body",
                }
            ),
            DENSITY: {**reference("number"), "exclusiveMinimum": 0, "description": "in kg/m³"},
            GROUP: {**reference("integer"), "description": "from the geoms of this group alone"},
        },
        "required": [FROM, DENSITY],
        "additionalProperties": False,
    }


VERB = Verb(
    "inertia",
    "mass and inertia from the geoms, at a density",
    _read,
    words=_words,
    changes=_changes,
    schema=_schema,
)

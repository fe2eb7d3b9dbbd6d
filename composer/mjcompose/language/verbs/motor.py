"""Verb `motor`: give an actuator and its joint the values of a motor's data sheet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import EXCLUSIVE, Schema, kind_of, or_template, reference, unknown_key
from mjcompose.language.verbs.values import Changed, Selected, Verb, read_mapping, with_values

MODEL, BANDWIDTH, ERROR = "model", "bandwidth", "error"
_NUMBERS = {
    BANDWIDTH: "how fast it follows, in Hz: `kp` and `kv` follow from this and from the inertia at the output",
    ERROR: "in place of `bandwidth`: the error in rad at which it gives its greatest torque",
    "damping_ratio": "1 without it: how fast it comes to rest, with `bandwidth`",
    "inertia": "what it moves besides its own armature, in kg·m², with `bandwidth`",
}
EFFORTS = ("peak", "rated")
_KEYS = (MODEL, *_NUMBERS, "effort")
_CHANGED = (
    *(
        ("actuator", name)
        for name in ("kp", "kv", "dampratio", "forcerange", "forcelimited", "delay", "nsample")
    ),
    *(("joint", name) for name in ("armature", "frictionloss", "damping")),
)


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("motor", value, "{model: NAME, bandwidth: 5}", selected=selected)
    if given is None:
        return {}
    if selected.kinds and not any(kind.path.startswith("actuator/") for kind in selected.kinds):
        message = f"`motor` is for actuators, and `{selected.tag}` is not one"
        help = "select the actuator of the joint: `select: {actuator: NAME}`"
        selected.add(Fault("wrong-type", message, selected.at, help=help))
        return {}
    for name in given:
        if name not in _KEYS:
            selected.add(unknown_key(f"`motor` has no key `{name}`", name, _KEYS, at=(*selected.at, name)))
    model = given.get(MODEL)
    if not isinstance(model, str) or not model:
        written = MODEL in given
        message = (
            f"`model` expects the name of a motor, got {kind_of(model)}"
            if written
            else "`motor` lacks `model`"
        )
        at = (*selected.at, MODEL) if written else selected.at
        selected.add(
            Fault("wrong-type" if written else "missing-key", message, at, help="write `model: NAME`")
        )
    for name in _NUMBERS:
        if name in given and (fault := _fault(name, given[name])) is not None:
            selected.add(Fault(fault[0], fault[1], (*selected.at, name)))
    if BANDWIDTH in given and ERROR in given:
        message = "`motor` has both `bandwidth` and `error`"
        selected.add(Fault(EXCLUSIVE, message, (*selected.at, ERROR), key=True, help="leave one of them out"))
    if given.get("effort", EFFORTS[0]) not in EFFORTS:
        message = f"`effort` is `peak` or `rated`, got {kind_of(given['effort'])}"
        selected.add(Fault("wrong-keyword", message, (*selected.at, "effort"), help="write `effort: rated`"))
    return dict(given)


def _fault(name: str, value: Any) -> tuple[str, str] | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return "wrong-type", f"`{name}` of `motor` expects a number, got {kind_of(value)}"
    if value < 0 or (value == 0 and name in (BANDWIDTH, ERROR)):
        least = "more than 0" if name in (BANDWIDTH, ERROR) else "at least 0"
        return "out-of-range", f"`{name}` of `motor` is {value:g}, and must be {least}"
    return None


def _words(value: Mapping[str, Any]) -> str:
    return f"motor {value[MODEL]}{with_values(value, MODEL)}"


def _changes(tag: str | None, value: Mapping[str, Any]) -> Changed:
    return _CHANGED


def _schema() -> Schema:
    numbers: dict[str, Schema] = {
        name: {**reference("number"), "minimum": 0, "description": about} for name, about in _NUMBERS.items()
    }
    model: Schema = {
        "type": "string",
        "minLength": 1,
        "description": "a motor of the section `motors`, or one that comes with mjcompose",
    }
    effort = or_template(
        {
            "enum": [*EFFORTS],
            "description": "whether it gives its peak or its rated torque",
            "default": EFFORTS[0],
        }
    )
    return {
        "type": "object",
        "properties": {MODEL: model, **numbers, "effort": effort},
        "required": [MODEL],
        "additionalProperties": False,
    }


VERB = Verb(
    "motor",
    "the torque, gains and armature of a motor, from its data sheet",
    _read,
    words=_words,
    changes=_changes,
    schema=_schema,
)

"""Verb `move`: move elements to another body or frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema, kind_of, unknown_key
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.language.verbs.values import Selected, Verb, read_mapping, with_values
from mjcompose.model.grammar import GRAMMAR

TO = "to"
_POSE = ("pos", *ORIENTATIONS)


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("move", value, "{to: NAME}", selected=selected)
    if given is None:
        return {}
    at = selected.at
    tops = [GRAMMAR.element(top) for top in ("body", "worldbody")]
    inside = {child.path for top in tops for child in top.children.values()}
    if selected.kinds and not any(kind.path in inside for kind in selected.kinds):
        message = f"`move` is for the body tree, and `{selected.tag}` is not in it"
        selected.add(Fault("wrong-type", message, at))
        return {}
    to = given.get(TO)
    if isinstance(to, dict):
        to = to.get("frame") if list(to) == ["frame"] else None
    if not isinstance(to, str) or not to:
        where = "write `to: NAME` of a body, `to: world`, or `to: {frame: NAME}`"
        written = TO in given
        message = f"`to` expects a name, got {kind_of(given[TO])}" if written else "`move` lacks `to`"
        code = "wrong-type" if written else "missing-key"
        selected.add(Fault(code, message, (*at, TO) if written else at, help=where))
    pose = {name: item for name, item in given.items() if name != TO}
    for name in [name for name in pose if name not in _POSE]:
        selected.add(unknown_key(f"`{name}` is not a key of `move`", name, (TO, *_POSE), at=(*at, name)))
        del pose[name]
    selected.checker.attributes("set", pose, selected.selector, at=at)
    return dict(given)


def _words(value: Mapping[str, Any]) -> str:
    to = value[TO]
    place = f"the frame {to['frame']}" if isinstance(to, dict) else to
    return f"move to {place}{with_values(value, TO)}"


def _schema() -> Schema:
    named: Schema = {"type": "string", "minLength": 1}
    frame = {
        "type": "object",
        "properties": {"frame": {**named, "description": "the name of a frame"}},
        "required": ["frame"],
    }
    place: Schema = {"anyOf": [named, frame], "description": "a body, `world`, or `{frame: NAME}`"}
    pose = {
        name: {"type": ["array", "string"], "description": f"`{name}` in what it then stands in"}
        for name in _POSE
    }
    return {
        "type": "object",
        "properties": {TO: place, **pose},
        "required": [TO],
        "additionalProperties": False,
    }


VERB = Verb(
    "move",
    "another body or frame to stand in, and the pose there",
    _read,
    words=_words,
    changes=None,
    schema=_schema,
)

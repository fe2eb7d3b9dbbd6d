"""Verb `simplify`: reduce the faces of meshes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema
from mjcompose.language.verbs.collision import Method, Setting, in_words, read_settings, settings_schema
from mjcompose.language.verbs.values import Selected, Verb, read_mapping

_METHOD = Method("fewer faces", {"faces": Setting("the most faces", None, 4)}, needed=("faces",))


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("simplify", value, "{faces: 500}", selected=selected)
    if given is None:
        return {}
    if selected.kinds and any(kind.path not in ("geom", "mesh") for kind in selected.kinds):
        message = f"`simplify` is for meshes and their geoms, and `{selected.tag}` is neither"
        selected.add(Fault("wrong-type", message, selected.at))
        return {}
    return read_settings(given, "simplify", _METHOD, at=selected.at, add=selected.add) or {}


def _words(value: Mapping[str, Any]) -> str:
    return in_words("simplify", value)


def _schema() -> Schema:
    return settings_schema(_METHOD)


VERB = Verb(
    "simplify",
    "fewer faces for its mesh",
    _read,
    words=_words,
    changes=None,
    schema=_schema,
)

"""Verb `convert`: make an actuator one of another kind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.language.element_schema import attribute_schema
from mjcompose.language.form import Schema, kind_of
from mjcompose.language.select import unknown_attribute
from mjcompose.language.verbs.values import Selected, Verb, read_mapping, with_values
from mjcompose.model.grammar import GRAMMAR

TO = "to"
CONVERTIBLE = ("general", "motor", "pid", "position", "velocity")
FROM = "from-"
_KIND: Schema = {"enum": [*CONVERTIBLE], "description": "the kind of actuator that it becomes"}


def _read(value: Any, selected: Selected) -> dict[str, Any]:
    given = read_mapping("convert", value, "{to: motor}", selected=selected)
    if given is None:
        return {}
    if selected.kinds and not any(kind.path.startswith("actuator/") for kind in selected.kinds):
        message = f"`convert` is for actuators, and `{selected.tag}` is not one"
        selected.add(Fault("wrong-type", message, selected.at))
        return {}
    to = given.get(TO)
    if to not in CONVERTIBLE:
        selected.add(_no_target(to, selected.at, TO in given))
        return {}
    kind = GRAMMAR.element(f"actuator/{to}")
    for name, item in given.items():
        path = (*selected.at, name)
        if name == TO:
            continue
        if name not in kind.attributes or name == "name":
            selected.add(unknown_attribute(name, str(to), (kind,), at=path))
        elif isinstance(item, str) and item.startswith(FROM):
            source = item.removeprefix(FROM)
            if source not in GRAMMAR.element("actuator/general").attributes:
                help = "write for instance `ctrlrange: from-forcerange`"
                message = f"`{item}` names no attribute of an actuator"
                selected.add(Fault("unknown-attribute", message, path, help=help))
        else:
            selected.checker.value("set", [kind.attributes[name]], None, value=item, tag=str(to), at=path)
    return dict(given)


def _no_target(to: Any, at: Path, written: bool) -> Fault:
    known = ", ".join(f"`{name}`" for name in CONVERTIBLE)
    if not written:
        return Fault("missing-key", "`convert` lacks `to`", at, help=f"write `to:` and one of {known}")
    near = closest(str(to), CONVERTIBLE)
    note = exists_note("kind", CONVERTIBLE, str(to))
    return Fault(
        "wrong-keyword",
        f"an actuator cannot be converted to {kind_of(to)}",
        (*at, TO),
        notes=(note,),
        help=f"write `to: {near[0]}`" if near else None,
        fix=renaming(str(to), CONVERTIBLE),
    )


def _words(value: Mapping[str, Any]) -> str:
    return f"convert to {value[TO]}{with_values(value, TO)}"


def _schema() -> Schema:
    """Return the schema: the kind, and conditions on the attributes that belong to it."""
    return {"type": "object", "properties": {TO: _KIND}, "required": [TO], "allOf": _conditions()}


def _conditions() -> list[Schema]:
    taken: Schema = {"type": "string", "pattern": f"^{FROM}"}
    found: list[Schema] = []
    for kind in CONVERTIBLE:
        attributes = GRAMMAR.element(f"actuator/{kind}").attributes.values()
        given = {
            each.name: _either(attribute_schema(each), taken) for each in attributes if each.name != "name"
        }
        target: Schema = {"properties": {TO: {"const": kind}}, "required": [TO]}
        then: Schema = {"properties": {TO: _KIND, **given}, "additionalProperties": False}
        found.append({"if": target, "then": then})
    return found


def _either(schema: Schema, other: Schema) -> Schema:
    both: Schema = {"anyOf": [{key: each for key, each in schema.items() if key != "description"}, other]}
    return {**both, "description": schema["description"]} if "description" in schema else both


VERB = Verb(
    "convert",
    "another kind of actuator, and attributes of it",
    _read,
    words=_words,
    changes=None,
    schema=_schema,
)

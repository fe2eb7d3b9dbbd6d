"""The form of the verb `convert`: replace an actuator by another kind with the same behavior in MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.language.assign import Checker
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.element_schema import attribute_schema
from mjcompose.language.forms.context import ByGrammar, Schema, Settings
from mjcompose.language.forms.model import IT, WHOLE
from mjcompose.language.select import unknown_attribute
from mjcompose.language.value import kind_of
from mjcompose.tree.grammar import GRAMMAR

_KINDS = ("general", "motor", "pid", "position", "velocity")
FROM = "from-"
_TO = "to"
_KIND: Schema = {"enum": [*_KINDS], "description": "the new kind of actuator"}


class _Conversion(ByGrammar):
    """A kind of actuator in `to`, with its attributes, each a value or `from-ATTRIBUTE`."""

    def schema(self) -> Schema:
        found: list[Schema] = []
        for kind in _KINDS:
            attributes = GRAMMAR.element(f"actuator/{kind}").attributes.values()
            given = {each.name: _or_taken(attribute_schema(each, kind)) for each in attributes if each.name != "name"}
            target: Schema = {"properties": {_TO: {"const": kind}}, "required": [_TO]}
            found.append({"if": target, "then": {"properties": {_TO: _KIND, **given}, "additionalProperties": False}})
        return {"type": "object", "properties": {_TO: _KIND}, "required": [_TO], "allOf": found}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> dict[str, Any]:
        if not isinstance(value, dict) or not value:
            message = f"{IT} expects a mapping, got {kind_of(value) if value != {} else 'an empty one'}"
            faults.append(Fault("wrong-type", message, help="write `convert: {to: motor}`"))
            return {}
        faults += _attribute_faults(value, settings.bare_angles) if value.get(_TO) in _KINDS else [_no_target(value)]
        return dict(value)


def _attribute_faults(value: Mapping[str, Any], bare_angles: bool) -> list[Fault]:
    faults: list[Fault] = []
    checker = Checker(bare_angles, faults)
    to = str(value[_TO])
    kind = GRAMMAR.element(f"actuator/{to}")
    for name, item in value.items():
        if name == _TO:
            continue
        if name not in kind.attributes or name == "name":
            faults.append(unknown_attribute(name, to, (kind,), at=(name,)))
        elif isinstance(item, str) and item.startswith(FROM):
            if item.removeprefix(FROM) not in GRAMMAR.element("actuator/general").attributes:
                help = "write for instance `ctrlrange: from-forcerange`"
                message = f"`{item}` names no attribute of an actuator"
                faults.append(Fault("unknown-attribute", message, (name,), help=help))
        else:
            checker.value("set", [(to, kind.attributes[name])], None, value=item, tag=to, at=(name,))
    return faults


def _no_target(value: Mapping[str, Any]) -> Fault:
    known = ", ".join(f"`{name}`" for name in _KINDS)
    if _TO not in value:
        return Fault("missing-key", f"{IT} lacks `to`", key=True, help=f"write `to:` and one of {known}", lacks=_TO)
    to = str(value[_TO])
    near = closest(to, _KINDS)
    return Fault(
        "wrong-keyword",
        f"an actuator cannot be converted to {kind_of(value[_TO])}",
        (_TO,),
        notes=(exists_note("kind", _KINDS, to),),
        help=f"write `to: {near[0]}`" if near else None,
        fix=renaming(to, _KINDS),
    )


def _or_taken(schema: Schema) -> Schema:
    taken: Schema = {"type": "string", "pattern": f"^{FROM}"}
    about = {key: each for key, each in schema.items() if key == "description"}
    return {"anyOf": [{key: each for key, each in schema.items() if key not in about}, taken], **about}


class Convert(Verb):
    """another kind of actuator, and its attributes"""

    rules: ClassVar = (For("actuator/", what="for actuators, and `{tag}` is not an actuator"),)
    reshapes: ClassVar = True

    written: Annotated[dict[str, Any], _Conversion()] = Field(alias=WHOLE)
    """the kind, and its attributes"""

    @property
    def to(self) -> str:
        return str(self.written[_TO])

    def words(self) -> str:
        return f"convert to {self.to}{listed({name: each for name, each in self.written.items() if name != _TO})}"


VERB = Convert

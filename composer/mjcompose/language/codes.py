"""The key `allow`: codes of warnings that are meant to be there."""

from __future__ import annotations

from typing import Any

from mjcompose.base.codes import CODES
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Fix, Note, Path
from mjcompose.base.suggest import advised
from mjcompose.language.form import Form, Schema, Settings, definition, kind_of, reference

ALLOW = "allow"


@dataclass(frozen=True, slots=True)
class Allowed(Form):
    """Form of a field `allow`: a list of codes, read as a tuple of texts."""

    def schema(self) -> Schema:
        return codes_schema()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[str, ...]:
        return read_codes(value, (), faults)


def read_codes(value: Any, at: Path, faults: list[Fault]) -> tuple[str, ...]:
    """Return the codes of a list. Anything else in it is a fault."""
    if not isinstance(value, list) or not value:
        got = "an empty list" if value == [] else kind_of(value)
        help = f"write `{ALLOW}: [{value}]`" if isinstance(value, str) else f"write `{ALLOW}: [convert-loss]`"
        message = f"`{ALLOW}` expects a list of codes of warnings, got {got}"
        fix = Fix(f"[{value}]") if isinstance(value, str) and value in CODES else None
        faults.append(Fault("wrong-type", message, at, help=help, fix=fix))
        return ()
    for index, code in enumerate(value):
        if not isinstance(code, str):
            message = f"`{ALLOW}` expects codes of warnings, got {kind_of(code)}"
            faults.append(Fault("wrong-type", message, (*at, index)))
        elif code not in CODES:
            near, fix = advised(code, CODES)
            note = Note("`mjcompose explain --codes` lists all codes")
            message = f"the code `{code}` does not exist"
            faults.append(Fault("wrong-keyword", message, (*at, index), notes=(note,), help=near, fix=fix))
        elif code in value[:index]:
            faults.append(Fault("name-clash", f"`{code}` is allowed twice", (*at, index), help="take one out"))
    return tuple(each for each in value if isinstance(each, str))


@definition("code")
def code(_: str) -> Schema:
    """Return the schema of a warning's code."""
    return {"enum": list(CODES)}


def codes_schema() -> Schema:
    return {"type": "array", "items": reference("code"), "minItems": 1, "uniqueItems": True}

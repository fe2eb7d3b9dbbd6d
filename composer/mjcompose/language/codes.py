"""The key `allow`: codes of warnings that you accept."""

from __future__ import annotations

from typing import Annotated

from pydantic import WithJsonSchema

from mjcompose.base.codes import CODES
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.suggest import advised
from mjcompose.language.forms.context import Schema, definition, reference
from mjcompose.language.forms.scalars import Checked, Expects, Items

ALLOW = "allow"


def _code_fault(code: str) -> Fault | None:
    if code in CODES:
        return None
    help, fix = advised(code, CODES)
    note = Note("`mjcompose explain --codes` lists all codes")
    return Fault("wrong-keyword", f"the code `{code}` does not exist", notes=(note,), help=help, fix=fix)


@definition("code")
def code(_: str) -> Schema:
    """Return the schema of a warning's code."""
    return {"enum": list(CODES)}


Code = Annotated[str, Checked(_code_fault), Expects("the code of a warning"), WithJsonSchema(reference("code"))]
Codes = Annotated[tuple[Code, ...], Items(1, unique=True), Expects("a list of codes of warnings", "[convert-loss]")]

"""Split a message of MuJoCo into its text and the line and element that it names."""

from __future__ import annotations

import re

from composer.dataclass import dataclass

CRASHES = {"timeout": "mujoco-timeout", "missing": "mujoco-missing"}
"""The diagnostic codes for a `crash` of `engine.Compiled`; every other crash is `mujoco-crash`."""

_CRASH_HELP = {
    "mujoco-timeout": "give it more time with `--timeout`, or look for huge counts in `replicate` and `flexcomp`",
    "mujoco-missing": "install it: `python -m pip install --upgrade mujoco`; or do without it: `--no-verify`",
    "mujoco-crash": "load each part alone in MuJoCo to find the one at fault",
}

_PREFIX = re.compile(r"^(?:(?:XML )?Error: |ParseXML: )+")
# "Element name 'left/X', id 0, line 38": from the compiler, about an object of the model
_OBJECT = re.compile(
    r"\s*^Element name '(?P<name>.*)', id (?P<id>-?\d+)(?:, line (?P<line>-?\d+))?[ \t]*$", re.M | re.S
)
# "Element 'geom', line 3, column 7": from the reader, about an element of the file
_ELEMENT = re.compile(
    r"\s*^Element '(?P<element>[^'\n]*)', line (?P<line>-?\d+)(?:, column (?P<column>-?\d+))?\s*\Z", re.M
)
# precedes that line if a `<flexcomp>` cannot be created: there is no object yet
_NO_OBJECT = re.compile(r"^Element name '', id -1[ \t]*\n(?=Element ')", re.M)
# TinyXML's message about a file that is not well-formed
_XML = re.compile(
    r"^XML parse error (?P<number>\d+):\s*Error=(?P<error>\w+).*?"
    r"Line number=(?P<line>\d+)(?::\s*(?P<rest>.*))?\Z",
    re.S,
)


@dataclass(frozen=True, slots=True)
class Fault:
    """One message of MuJoCo, split into its parts.

    `message` is its text without the other fields, which are None if MuJoCo does not name them. `line` (and
    `column`) count from 1, in the bundle's MJCF. `element` is the tag, `name` the object's name.
    """

    message: str
    line: int | None = None
    column: int | None = None
    element: str | None = None
    name: str | None = None


def crash_help(code: str) -> str | None:
    """Return advice for the case that MuJoCo gave no verdict."""
    return _CRASH_HELP.get(code)


def parse(text: str) -> Fault:
    r"""Split one message of MuJoCo into its parts.

    >>> parse("Error: size 0 must be positive in geom\nElement name 'left/pad', id 3, line 38")
    Fault(message='size 0 must be positive in geom', line=38, column=None, element=None, name='left/pad')
    """
    text = _NO_OBJECT.sub("", text.strip())
    broken = _XML.match(text)
    if broken:
        return _not_well_formed(broken)
    trailer = _OBJECT.search(text) or _ELEMENT.search(text)
    if trailer is None:
        return Fault(_PREFIX.sub("", text).strip())
    fields = trailer.groupdict()
    message = _PREFIX.sub("", text[: trailer.start()]).strip()
    if rest := text[trailer.end() :].strip():  # MuJoCo 3.12 puts the reason why a file cannot be read last
        message = f"{message}: {rest}"
    return Fault(
        message,
        line=_positive(fields["line"]),
        column=_positive(fields.get("column")),
        element=fields.get("element") or None,
        name=fields.get("name") or None,
    )


def _not_well_formed(found: re.Match[str]) -> Fault:
    what = found["error"].removeprefix("XML_ERROR_").replace("_", " ").lower()
    rest = " ".join((found["rest"] or "").split())
    element = re.fullmatch(r"XMLElement name=(\S+)", rest)
    detail = f": {rest}" if rest and not element else ""
    return Fault(
        f"not well-formed XML: {what}{detail}",
        _positive(found["line"]),
        element=element[1] if element else None,
    )


def _positive(number: str | None) -> int | None:
    """Return a line or column from MuJoCo, which writes 0 or -1 for an unknown one."""
    return int(number) if number is not None and int(number) > 0 else None

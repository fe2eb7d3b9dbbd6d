"""Whether a bundle compiles in MuJoCo, and what MuJoCo says where it does not."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import unwritable
from composer.bundle.staging import write_files

CRASHES = {"timeout": "mujoco-timeout", "missing": "mujoco-missing"}
"""Codes of the reasons for which MuJoCo gave no verdict; of all others it is `mujoco-crash`."""

_CRASH_HELP = {
    "mujoco-timeout": "give it more time with `--timeout`, or look for huge counts in `replicate` and `flexcomp`",
    "mujoco-missing": "install it: `python -m pip install mujoco`; or do without it: `--no-verify`",
    "mujoco-crash": "load each part alone in MuJoCo to find the one at fault",
}

_PREFIX = re.compile(r"^(?:(?:XML )?Error: |ParseXML: )+")
# "Element name 'left/X', id 0, line 38": by the compiler, about an object of the model
_OBJECT = re.compile(
    r"\s*^Element name '(?P<name>.*)', id (?P<id>-?\d+)(?:, line (?P<line>-?\d+))?[ \t]*$", re.M | re.S
)
# "Element 'geom', line 3, column 7": by the reader, about an element of the file
_ELEMENT = re.compile(
    r"\s*^Element '(?P<element>[^'\n]*)', line (?P<line>-?\d+)(?:, column (?P<column>-?\d+))?\s*\Z", re.M
)
# what TinyXML says about a file that is not well-formed
_XML = re.compile(
    r"^XML parse error (?P<number>\d+):\s*Error=(?P<error>\w+).*?"
    r"Line number=(?P<line>\d+)(?::\s*(?P<rest>.*))?\Z",
    re.S,
)


@dataclass(frozen=True, slots=True)
class Fault:
    """One message of MuJoCo, taken apart.

    `message` is its text without what stands in the other fields, which are None where MuJoCo did not tell.
    `line` (and `column`) are 1-based, in the bundle's MJCF. `element` is the tag, `name` the object's name.
    """

    message: str
    line: int | None = None
    column: int | None = None
    element: str | None = None
    name: str | None = None


@dataclass(frozen=True, slots=True)
class Verified:
    """What MuJoCo said about a bundle; `compiled` has the sizes and the index.

    `error` is why the model was refused. `crash` is set when MuJoCo gave no verdict (see `engine.Compiled`);
    `error` is then a sentence about that. `code` is the diagnostic's code for `error`.
    """

    compiled: engine.Compiled
    error: Fault | None = None
    crash: str | None = None
    warnings: tuple[Fault, ...] = ()

    @property
    def ok(self) -> bool:
        return self.error is None

    @property
    def code(self) -> str | None:
        """The code of the diagnostic that tells `error`; None when all is well."""
        if self.error is None:
            return None
        if self.crash is None:
            return "mujoco-rejects"
        return CRASHES.get(self.crash, "mujoco-crash")


def verify(
    bundle: Bundle,
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
    keep: str | None = None,
) -> Verified:
    """Compile the bundle as a user would, from a folder of its own, and run one mj_forward.

    A model that compiles and whose first forward step fails is not well: that is an error too. With a
    `session`, `keep` names the compiled model for what is run on it later. Raises OutputError when the bundle
    cannot be put into a temporary folder.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="mjcompose-", ignore_cleanup_errors=True) as name:
            write_files(bundle, Path(name))
            compiled = engine.compile(
                Path(name), bundle.model, wants=("index",), keep=keep, limits=limits, session=session
            )
    except OSError as error:
        raise unwritable("a temporary folder", error) from error
    warnings = tuple(parse(text) for text in compiled.warnings)
    if compiled.crash is not None:
        return Verified(compiled, Fault(compiled.error or compiled.crash), compiled.crash, warnings)
    if compiled.error is not None:
        return Verified(compiled, parse(compiled.error), None, warnings)
    if compiled.forward is not None:
        fault = Fault(f"the model compiles, but its first forward step fails: {compiled.forward}")
        return Verified(compiled, fault, None, warnings)
    return Verified(compiled, None, None, warnings)


def crash_help(code: str) -> str | None:
    """What to do where MuJoCo gave no verdict."""
    return _CRASH_HELP.get(code)


def parse(text: str) -> Fault:
    r"""One message of MuJoCo, taken apart.

    >>> parse("Error: size 0 must be positive in geom\nElement name 'left/pad', id 3, line 38")
    Fault(message='size 0 must be positive in geom', line=38, column=None, element=None, name='left/pad')
    """
    text = text.strip()
    broken = _XML.match(text)
    if broken:
        return _not_well_formed(broken)
    trailer = _OBJECT.search(text) or _ELEMENT.search(text)
    if trailer is None:
        return Fault(_PREFIX.sub("", text).strip())
    told = trailer.groupdict()
    message = _PREFIX.sub("", text[: trailer.start()]).strip()
    if rest := text[trailer.end() :].strip():  # MuJoCo 3.12 tells last why a file cannot be read
        message = f"{message}: {rest}"
    return Fault(
        message,
        line=_positive(told["line"]),
        column=_positive(told.get("column")),
        element=told.get("element") or None,
        name=told.get("name") or None,
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
    """A line or column as MuJoCo writes it; it writes 0 or -1 where it knows none."""
    return int(number) if number is not None and int(number) > 0 else None

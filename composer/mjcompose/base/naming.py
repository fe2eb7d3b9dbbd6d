"""Names from data: as file names that are valid on every system, and the characters that no new name may have.

A name is never a path. Code that makes a file name from data (a model, a cell, a mesh, a part) calls `file_name` or
`portable_path`: no other function decides which names are safe.
"""

from __future__ import annotations

import re

_DEVICES = r"con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³]|conin\$|conout\$"
_FORBIDDEN = r'[\x00-\x1f\x7f<>:"|?*\\\ud800-\udfff]'
_RESERVED = re.compile(rf"({_DEVICES})[ .]*(\..*)?", re.IGNORECASE | re.DOTALL)
"""The names of Windows' devices. With any suffix, they are the device, too: `NUL.obj`."""
_NOT_PORTABLE = re.compile(rf"{_FORBIDDEN}|[ .]$")
"""The characters that a name cannot have on Windows, and the endings that Windows removes."""
_NOT_IN_NAME = re.compile(r"[^\w.+-]+")


def file_name(name: str) -> str:
    """Return a name as a file name, which cannot lead out of its folder and is valid on every system. No I/O.

    >>> file_name("cell 1/left"), file_name(".."), file_name("../../home/arm"), file_name("con"), file_name("-rf")
    ('cell_1_left', 'model', '_.._home_arm', 'con_', '_rf')
    """
    plain = _NOT_IN_NAME.sub("_", name).lstrip(".")
    if plain.startswith("-"):  # which other programs would take for an option
        plain = f"_{plain[1:]}"
    return portable_step(plain) if plain else "model"


def portable_step(step: str) -> str:
    """Return a file's or folder's name with `_` instead of everything that some system cannot have. No I/O.

    >>> portable_step("NUL.obj"), portable_step("wood: oak."), portable_step("link.obj")
    ('NUL_.obj', 'wood_ oak_', 'link.obj')
    """
    step = _NOT_PORTABLE.sub("_", step)
    if _RESERVED.fullmatch(step):
        stem, dot, suffix = step.partition(".")
        step = f"{stem.rstrip()}_{dot}{suffix}"
    return step


_SUSPECT = re.compile(rf"{_FORBIDDEN}|[ .](?:/|$)|(?:^|/)(?:{_DEVICES})[ .]*(?:[./]|$)", re.IGNORECASE)


def is_portable(path: str) -> bool:
    """Return whether every system can have all steps of a path. No I/O.

    >>> is_portable("assets/arm/link.obj"), is_portable("assets/NUL/link.obj"), is_portable("assets/wood:oak.png")
    (True, False, False)
    """
    return _SUSPECT.search(path) is None


def portable_path(path: str) -> str:
    """Return a path of a bundle whose steps every system can have. Paths that need no change stay. No I/O.

    >>> portable_path("assets/arm/aux/wood:oak.png"), portable_path("assets/arm/link.obj")
    ('assets/arm/aux_/wood_oak.png', 'assets/arm/link.obj')
    """
    return path if is_portable(path) else "/".join(map(portable_step, path.split("/")))


BIDIRECTIONAL = "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
"""Characters that reorder text, as a part of a regular expression."""
UNSEEN = "\u00ad\u200b\u2060-\u2064\ufeff\U000e0000-\U000e0fff"
"""Characters without a shape, which hide text from people, likewise; not those that join letters of some scripts."""
_ODD = re.compile(f"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff{BIDIRECTIONAL}{UNSEEN}]")
_LINE_BREAKS = "\n\r\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029"


def odd_character(name: str) -> str | None:
    r"""Return the first character that no new name may have, in words; None without any. No I/O.

    >>> odd_character("arm\n::error::"), odd_character("arm\u202e"), odd_character("bras_é")
    ('a line break', 'the character U+202E', None)
    """
    match = _ODD.search(name)
    if match is None:
        return None
    character = match[0]
    if character in _LINE_BREAKS:
        return "a line break"
    return "a tab" if character == "\t" else f"the character U+{ord(character):04X}"


def checked_name(name: str) -> str:
    """Return a name from a file that a program wrote, if it is one line. Raises ValueError. No I/O."""
    if not name:
        raise ValueError("it is empty")
    character = odd_character(name)
    if character is not None:
        raise ValueError(f"it has {character} in it")
    return name


def without_odd(name: str) -> str:
    r"""Return the name of a file as a name that fits on one line; bytes that are not text stay for `as_text`. No I/O.

    >>> without_odd("arm\n2"), without_odd("arm 2")
    ('arm_2', 'arm 2')
    """
    return _ODD.sub(lambda found: found[0] if "\ud800" <= found[0] <= "\udfff" else "_", name)

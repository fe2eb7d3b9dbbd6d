"""The bytes of a file as text that a YAML 1.1 parser reads as YAML 1.2."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.limits import advice, in_force, written
from mjcompose.base.sink import Sink

_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_UNPRINTABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x80-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")
_UTF_16_OR_32 = ((b"\xff\xfe\0\0", "UTF-32"), (b"\xff\xfe", "UTF-16"), (b"\xfe\xff", "UTF-16"))


def refuse_size(file: str, sink: Sink) -> None:
    """Report a file that is larger than a recipe may be."""
    message = f"`{file}` is larger than the {written('recipe-size', in_force().recipe_size)} that a recipe may have"
    notes = [Note("put meshes and other data into files, which a recipe names")]
    sink.error("yaml-too-large", message, Span(file, 1, 1), notes=notes, help=advice("recipe-size"))


def decode(source: str | bytes, file: str, sink: Sink) -> str | None:
    """Return the text without its byte order mark, or None after an error: no UTF-8, control characters, too large."""
    if len(source) > in_force().recipe_size:
        refuse_size(file, sink)
        return None
    text = _utf8(source, file, sink) if isinstance(source, bytes) else source
    if text is None:
        return None
    text = text.removeprefix("\ufeff")
    bad = _UNPRINTABLE.search(text)
    if bad is None:
        return text
    line, column = position(text, bad.start())
    others, code = len(_UNPRINTABLE.findall(text)) - 1, ord(bad.group())
    notes = [Note(f"the file has {others} more such characters; it may not be a text file")] if others else ()
    help = "remove it" if 0xD800 <= code <= 0xDFFF else f'remove it, or write "\\u{code:04x}" inside double quotes'
    span = Span(file, line, column, end_line=line, end_column=column + 1)
    sink.error("yaml-syntax", f"YAML cannot contain the character U+{code:04X}", span, notes=notes, help=help)
    return None


def position(text: str, index: int) -> tuple[int, int]:
    r"""Return the line and the column, both from 1, of the character at `index`.

    >>> position("ab\r\ncd", 5)
    (2, 2)
    """
    line, begin = 1, 0
    for found in _LINE_BREAK.finditer(text):
        if found.end() > index:
            break
        line, begin = line + 1, found.end()
    return line, index - begin + 1


def _utf8(source: bytes, file: str, sink: Sink) -> str | None:
    for mark, encoding in _UTF_16_OR_32:
        if source.startswith(mark):
            sink.error("yaml-not-utf8", f"`{file}` is {encoding} text", Span(file, 1, 1), help="save the file as UTF-8")
            return None
    try:
        return source.decode("utf-8")
    except UnicodeDecodeError as fault:
        before = source[: fault.start].decode("utf-8").removeprefix("\ufeff")
        line, column = position(before, len(before))
        message = f"the byte 0x{source[fault.start]:02x} is not part of UTF-8 text"
        span = Span(file, line, column, end_line=line, end_column=column + 1)
        sink.error("yaml-not-utf8", message, span, help="save the file as UTF-8")
        return None


_LINE_BREAKS_OF_YAML_1_1 = "\x85\u2028\u2029"
_HARMFUL = frozenset("{}[],:#\"'&*!|>%@`?-\t\\")


class Mask:
    """A text with some characters replaced one for one: all positions stay the same.

    The replacements are private-use characters that do not occur in the text, literally or as an escape. Characters
    that are line breaks in YAML 1.1 but not in 1.2 are masked from the start.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self._original = text
        self._stand_ins: dict[str, str] = {}
        self._originals: dict[int, str] = {}
        self._pool: Iterator[str] | None = None
        for character in _LINE_BREAKS_OF_YAML_1_1:
            if character in text and (stand_in := self._stand_in(character)) is not None:
                self.text = self.text.replace(character, stand_in)

    def hide(self, start: int, end: int) -> bool:
        """Make a stretch readable as part of a plain scalar. Return False if that changes nothing."""
        before = self.text[start:end]
        hidden = "".join((self._stand_in(each) or each) if each in _HARMFUL else each for each in before)
        self.text = self.text[:start] + hidden + self.text[end:]
        return hidden != before

    @property
    def active(self) -> bool:
        """Whether any character is replaced."""
        return bool(self._originals)

    def restore(self, value: str) -> str:
        """Return the original of a text that was read from the masked text."""
        return value.translate(self._originals)

    def _stand_in(self, character: str) -> str | None:
        found = self._stand_ins.get(character)
        if found is None:
            if self._pool is None:
                text, lowered = self._original, self._original.lower()
                codes = (code for code in range(0xE000, 0xF900) if f"{code:x}" not in lowered)
                self._pool = (chr(code) for code in codes if chr(code) not in text)
            found = next(self._pool, None)
            if found is not None:
                self._stand_ins[character] = found
                self._originals[ord(found)] = character
        return found

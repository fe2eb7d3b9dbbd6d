"""Replace characters that YAML 1.1 readers misinterpret by harmless ones."""

from __future__ import annotations

from collections.abc import Iterator

_LINE_BREAKS_OF_YAML_1_1 = "\x85\u2028\u2029"
_HARMFUL = frozenset("{}[],:#\"'&*!|>%@`?-\t\\")


class Mask:
    """A text with some characters replaced one for one, so that all positions stay the same.

    The replacements are private-use characters that do not occur in the text, literally or as an escape. From the
    start, characters are masked that are line breaks in YAML 1.1 but not in 1.2.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self._original = text
        self._stand_ins: dict[str, str] = {}
        self._originals: dict[int, str] = {}
        self._pool: Iterator[str] | None = None
        if any(character in text for character in _LINE_BREAKS_OF_YAML_1_1):
            for character in _LINE_BREAKS_OF_YAML_1_1:
                stand_in = self._stand_in(character)
                if stand_in is not None:
                    self.text = self.text.replace(character, stand_in)

    def hide(self, start: int, end: int) -> bool:
        """Make a stretch readable as part of a plain scalar. Return False if that changes nothing."""
        hidden = "".join(
            (self._stand_in(character) or character) if character in _HARMFUL else character
            for character in self.text[start:end]
        )
        changed = hidden != self.text[start:end]
        self.text = self.text[:start] + hidden + self.text[end:]
        return changed

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
                self._pool = _unused(self._original)
            found = next(self._pool, None)
            if found is not None:
                self._stand_ins[character] = found
                self._originals[ord(found)] = character
        return found


def _unused(text: str) -> Iterator[str]:
    lowered = text.lower()
    return (
        chr(code) for code in range(0xE000, 0xF900) if chr(code) not in text and f"{code:x}" not in lowered
    )

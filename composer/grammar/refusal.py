"""The reason why a value does not fit an attribute, as fields for messages."""

from __future__ import annotations

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Refusal:
    """The reason why a value is not valid, and what to write instead.

    `message` is a lowercase fragment that continues "`size`…": `expects 3 numbers, got 2`. `is_length` says that
    only the number of items or characters is wrong. `unknown` is an unknown keyword; `lists_keywords` says that the
    message lists the existing ones. `instead` is the value to write, in YAML; `hint` is any other advice.

    >>> str(Refusal("expects numbers, got text", instead="[1, 2]"))
    'expects numbers, got text; write [1, 2]'
    """

    message: str
    is_length: bool = False
    unknown: str | None = None
    lists_keywords: bool = False
    instead: str | None = None
    hint: str | None = None

    @property
    def advice(self) -> str | None:
        return self.hint if self.instead is None else f"write {self.instead}"

    def __str__(self) -> str:
        return self.message if self.advice is None else f"{self.message}; {self.advice}"

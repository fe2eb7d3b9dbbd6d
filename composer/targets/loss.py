"""Something that a target cannot express."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Loss:
    """What is done about an element that a target cannot express, as data.

    `feature` is a row of the table of features; `kind` and `number` say which element of the compiled model it is,
    `tag` and `name` what it is called. With `refused` no model is written.
    """

    feature: str
    kind: str
    number: int
    tag: str
    name: str
    message: str
    refused: bool = False
    help: str | None = None

    @property
    def shown(self) -> str:
        return f"{self.tag} `{self.name}`" if self.name else self.tag

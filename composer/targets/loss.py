"""The loss of something that a target cannot express."""

from __future__ import annotations

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Loss:
    """An element that a target cannot express, and what happens to it.

    `feature` is a row of the table of features. `kind` and `number` identify the element in the compiled model,
    `tag` and `name` are for messages. If it is `refused`, no model is written.
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

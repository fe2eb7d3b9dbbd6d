"""What a target is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from composer.targets.draft import Draft
from composer.targets.limit import Limit


@dataclass(frozen=True, slots=True)
class Target:
    """A program that reads models, or a form of model.

    `words` says which, `package` what it is tested with from PyPI, None where it is not. `limits` are what it cannot
    express, in the order in which they change the model; `write` makes the text and the files of what is left.
    """

    name: str
    words: str
    limits: tuple[Limit, ...]
    write: Callable[[Draft], dict[str, bytes]]
    package: str | None = None

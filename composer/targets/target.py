"""The definition of a target."""

from __future__ import annotations

from collections.abc import Callable

from composer.dataclass import dataclass
from composer.targets.draft import Draft
from composer.targets.limit import Limit


@dataclass(frozen=True, slots=True)
class Target:
    """A program that reads models, or a form in which models are written.

    `words` describe it. `package` is the package on PyPI with which it is tested, or None. `limits` are what it
    cannot express, in the order in which they change the model. `write` returns the text and the files of what
    remains, by path.
    """

    name: str
    words: str
    limits: tuple[Limit, ...]
    write: Callable[[Draft], dict[str, bytes]]
    package: str | None = None

    @property
    def title(self) -> str:
        """Return the name of the program in sentences: `MuJoCo Warp`."""
        return self.words.partition(",")[0]

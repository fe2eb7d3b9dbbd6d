"""What all verbs of `edit` have in common, as a recipe writes them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema, Settings, shown
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.select import kinds_of
from mjcompose.language.verbs.values import Changed


class For:
    """A verb is for elements of these paths of the grammar alone, or of paths that begin so.

    `what` says it: "for bodies, and `{tag}` is not one".
    """

    alone = True

    def __init__(self, *paths: str, what: str, help: str | None = None) -> None:
        self.paths, self.what, self.help = paths, what, help

    def fits(self, path: str) -> bool:
        return any(path == each or (each.endswith("/") and path.startswith(each)) for each in self.paths)

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        kinds = kinds_of(context.selected.tag) if context.selected is not None else ()
        if kinds and context.selected is not None and not any(self.fits(kind.path) for kind in kinds):
            message = f"{IT} is {self.what.format(tag=context.selected.tag)}"
            yield Fault("wrong-type", message, help=self.help)

    def schema(self) -> Iterator[Schema]:
        yield from ()  # what may stand beside which tag is a condition of the whole entry


class Verb(Model):
    """What an entry of `edit` does with each element that it selects.

    A verb that `reshapes` makes, removes or moves elements, after which a part cannot be compared with its source. One
    that is `alone` cannot be combined with others.
    """

    reshapes: ClassVar[bool] = False
    alone: ClassVar[bool] = False

    def words(self) -> str:
        """Return what it does on one line, as `plan` and `explain` print it."""
        raise NotImplementedError

    def changes(self, tag: str | None) -> Changed:
        """Return the attributes that it changes, if the selector has a tag."""
        return ()


def listed(values: Mapping[str, Any]) -> str:
    """Return the values that are written, as the end of a line.

    >>> listed({"gear": [2], "group": None}), listed({})
    (' with gear = [2]', '')
    """
    given = [f"{name} = {shown(each)}" for name, each in values.items() if each is not None]
    return f" with {', '.join(given)}" if given else ""

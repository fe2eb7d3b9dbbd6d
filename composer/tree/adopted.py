"""A setting of a composition that its parts agree on, and who they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

from composer.diagnostics.span import Span

_NAMED = 4


class Adopted(NamedTuple):
    """The value of a setting that neither the base nor the recipe writes.

    `path` is that of the attribute (`option/cone`), `parts` are the prefixes of those that write it, and `at` finds
    where the first of them does. A value that is MuJoCo's default is not written into the model (`is_written`): it
    only counts as what the composition asks for, where that is a part itself.
    """

    path: str
    value: str
    parts: tuple[str, ...]
    at: Callable[[], Span]
    is_written: bool

    @property
    def span(self) -> Span:
        return self.at()

    def located(self) -> Adopted:
        """The same, without the model in whose text the place has to be looked for."""
        return self._replace(at=partial(known, self.span))

    @property
    def setting(self) -> str:
        """What messages call it: `option.cone`."""
        return self.path.replace("/", ".")


def known(span: Span) -> Span:
    """A place that need not be looked for."""
    return span


def in_words(adopted: Iterable[Adopted]) -> Iterator[str]:
    """The settings that are in the model and from whom, a line for all of the same parts."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for each in adopted:
        if each.is_written:
            groups.setdefault(each.parts, []).append(f"{each.setting} {each.value}")
    for parts, settings in groups.items():
        yield f"{', '.join(settings)}, from {_few(parts)}"


def _few(parts: tuple[str, ...]) -> str:
    if len(parts) <= _NAMED:
        return ", ".join(parts)
    return f"{', '.join(parts[:_NAMED])} and {len(parts) - _NAMED} more"

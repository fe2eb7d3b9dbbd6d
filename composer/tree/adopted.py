"""A setting of a composition that its parts agree on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

from composer.diagnostics.span import Span

_NAMED = 4


class Adopted(NamedTuple):
    """The value of a setting that neither the base nor the recipe writes.

    `path` is the path of the attribute (`option/cone`), `parts` are the prefixes of the parts that write it, and
    `at` returns where the first of them does. A value equal to MuJoCo's default is not written into the model
    (`is_written`); it counts only if the composition is itself a part.
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
        """Return the same with a known place, independent of the model's text."""
        return self._replace(at=partial(known, self.span))

    @property
    def setting(self) -> str:
        """Its name in messages: `option.cone`."""
        return self.path.replace("/", ".")


def known(span: Span) -> Span:
    """Return the place itself; the counterpart of a function that looks it up."""
    return span


def in_words(adopted: Iterable[Adopted]) -> Iterator[str]:
    """Yield the settings that are written into the model, a line for all with the same parts."""
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

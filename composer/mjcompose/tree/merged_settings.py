"""Settings on which parts agree, the copying of their keys, and facts about a source that is not MJCF."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Literal, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span

_NAMED = 4


class Adopted(NamedTuple):
    """The value of a setting that neither the base nor the recipe writes.

    `path` is the path of the attribute (`option/cone`), `parts` are the prefixes of the parts that write it, and `at`
    returns the place where the first of them writes it. A value equal to MuJoCo's default is not written into the model
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
        """Return the same setting with a known place, independent of the model's text."""
        return self._replace(at=partial(known, self.span))

    @property
    def setting(self) -> str:
        """Its name in messages: `option.cone`."""
        return self.path.replace("/", ".")


def known(span: Span) -> Span:
    """Return the place itself; a function that looks up the place is the alternative."""
    return span


def in_words(adopted: Iterable[Adopted]) -> Iterator[str]:
    """Yield the settings that are written into the model, with one line for all settings with the same parts."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for each in adopted:
        if each.is_written:
            groups.setdefault(each.parts, []).append(f"{each.setting} {each.value}")
    for parts, settings in groups.items():
        more = f" and {len(parts) - _NAMED} more" if len(parts) > _NAMED else ""
        yield f"{', '.join(settings)}, from {', '.join(parts[:_NAMED])}{more}"


class ReadRow(Struct):
    """`count` elements of the kind `what`, with the elements that they `became`, or `why` the model lacks them.

    `what` is a path of tags, such as `joint/limit`, followed by an attribute if the row is about it
    (`joint/limit velocity`), or by the missing tag (`link without inertial`). `span` is the place of the first
    element. A row that nearly every file has `is_minor`.
    """

    what: str
    count: int
    became: str
    why: str
    span: Span
    is_minor: bool = False

    @property
    def called(self) -> str:
        """Its name in messages.

        >>> ReadRow("joint/limit velocity", 6, "", "", Span("arm.urdf", 1, 1)).called
        '`<joint><limit>` `velocity` (6)'
        >>> ReadRow("link without inertial", 1, "", "", Span("arm.urdf", 1, 1)).called
        '`<link>` without `<inertial>` (1)'
        """
        tags, _, more = self.what.partition(" ")
        lacks = more.removeprefix("without ")
        inside = f" without `<{lacks}>`" if lacks != more else f" `{more}`" if more else ""
        return f"`{''.join(f'<{tag}>' for tag in tags.split('/'))}`{inside} ({self.count})"


KeyPolicy = Literal["merge", "prefix", "none"]
"""Merged by name, kept apart by their prefix, or not at all."""

"""What a build was asked for: whatever besides the contents of files its outcome depends on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from composer.cache import values
from composer.sources.blobs import key_of


@dataclass(frozen=True, slots=True)
class Question:
    """`subject` is what is built, whatever of: the last build of it tells why another one is needed.

    `parts` has all values that count by what a person calls them.
    """

    subject: str
    parts: Mapping[str, str]

    @property
    def key(self) -> str:
        return key_of([self.subject, sorted(self.parts.items())])

    @property
    def subject_key(self) -> str:
        return key_of([self.subject])


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    """What is asked for otherwise than before, a line for each, by name. No I/O.

    >>> differences({"`payload`": "1", "mjcompose": "a"}, {"`payload`": "2", "`--dedup`": "yes", "mjcompose": "a"})
    ('`--dedup` is given', '`payload` was 1, is 2')
    """
    return tuple(_changes(before, after))


def _changes(before: Mapping[str, str], after: Mapping[str, str]) -> Iterable[str]:
    for name in sorted({*before, *after}):
        was, now = before.get(name), after.get(name)
        if was == now:
            continue
        if values.is_file(name):
            yield from values.changes(name, was, now)
        elif was is None:
            yield f"{name} is given" if now == GIVEN else f"{name} is {now}"
        elif now is None:
            yield f"{name} is no longer given" if was == GIVEN else f"{name} was {was}"
        else:
            yield f"{name} was {was}, is {now}"


GIVEN = "yes"
"""The value of an option that has none."""

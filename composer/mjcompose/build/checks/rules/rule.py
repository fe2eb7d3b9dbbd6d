"""A rule of the check `lint`, and the common code of rules."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, failed, unmet
from mjcompose.language.check import CheckPart

SHOWN = 8


class Rule(CheckPart):
    """The settings of a rule.

    `kinds` are the kinds of element that `except` can name. A rule with `limits` runs only if a recipe writes one of
    them. The module of a rule has a function `check`, which returns the findings for the settings.
    """

    word: ClassVar[str]
    kinds: ClassVar[tuple[str, ...]]
    limits: ClassVar[tuple[str, ...]] = ()
    example: ClassVar = "{}"


def chosen(scope: Scope, kind: str, settings: Mapping[str, Any]) -> list[int] | Fault | None:
    """Return the elements that the setting of their kind names, or None if it is not written."""
    globs: Sequence[str] = settings[kind]
    if (nothing := unmet(scope, (kind,), globs, kind)) is not None:
        return nothing
    return list(dict.fromkeys(each for glob in globs for each in scope.matching(kind, glob))) if globs else None


def excepted(scope: Scope, kinds: Sequence[str], settings: Mapping[str, Any]) -> set[tuple[str, int]] | Fault:
    """Return the elements that `except` names, by kind and id, or a finding that a glob names nothing."""
    if (nothing := unmet(scope, kinds, settings["except"], "except")) is not None:
        return nothing
    return {(kind, each) for glob in settings["except"] for kind in kinds for each in scope.matching(kind, glob)}


def listed(lines: Sequence[str], expected: str, actual: str, *at: str | int, help: str | None = None) -> list[Fault]:
    """Return one finding for lines, the first of them as its message; nothing without lines."""
    if not lines:
        return []
    more = [*lines[1:SHOWN], *([f"and {len(lines) - SHOWN} more"] if len(lines) > SHOWN else [])]
    return [failed(lines[0], expected, actual, *at, more=more, help=help)]

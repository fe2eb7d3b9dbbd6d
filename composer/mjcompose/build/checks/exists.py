"""The check `exists`: how many elements a selector matches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, failed, unknown, words_of
from mjcompose.build.checks.equal import equal, expected_of, value_of
from mjcompose.mujoco.attributes import holder


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report each selector that matches nothing, or another number of elements than expected."""
    found: list[Fault] = []
    for index, selector in enumerate(asked["selectors"]):
        tag, glob, expect = selector["tag"], selector["glob"], selector["expect"]
        matched = [
            each for each in scope.matching(tag, glob) if _stands_there(scope, tag, each, selector=selector)
        ]
        fitting = [
            _fits(scope, tag, each, selector=selector, angle=asked["angle"], place=index) for each in matched
        ]
        if faults := [each for each in fitting if isinstance(each, Fault)]:
            found.append(faults[0])
            continue
        matched = [each for each, fits in zip(matched, fitting, strict=True) if fits]
        scope.found(f"{tag} {glob}", len(matched))
        if len(matched) == expect or (expect is None and matched):
            continue
        count = "at least one" if expect is None else str(expect)
        seen = unknown(tag, glob, scope.names(tag))
        if matched:
            message = f"`{glob}` names {len(matched)} elements `{tag}`, not {expect}"
            names = ", ".join(scope.written(tag, each) for each in matched[:8])
            more = [f"they are: {names}" + (", …" if len(matched) > 8 else "")]
        else:
            message, more = f"{seen.message}{_there(selector)}", [note.message for note in seen.notes]
        help = None if matched else seen.help
        found.append(failed(message, count, str(len(matched)), index, tag, more=more, help=help))
    return found


def _stands_there(scope: Scope, kind: str, index: int, selector: dict[str, Any]) -> bool:
    """Return whether the bodies around an element are those that the selector names."""
    if not (selector["parent"] or selector["inside"]):
        return True
    around = list(_bodies_around(scope, kind, index))
    asked = ((selector["parent"], around[:1]), (selector["inside"], around))
    return all(glob is None or set(bodies) & set(scope.matching("body", glob)) for glob, bodies in asked)


def _fits(
    scope: Scope, kind: str, index: int, selector: dict[str, Any], angle: str | None, place: int
) -> bool | Fault:
    """Return whether an element has the values in `where`, or a finding if they cannot be looked up."""
    for each in selector["where"]:
        if each["word"] is not None:
            words = set(words_of(scope, kind, index, attr=each["attr"]))
            if not scope.fitting(each["word"], words):
                return False
            continue
        actual = value_of(scope, kind, index, attr=each["attr"])
        expected = expected_of(scope, kind, index, asked={**each, "angle": angle})
        if isinstance(actual, Fault) or isinstance(expected, Fault):
            fault = actual if isinstance(actual, Fault) else expected
            assert isinstance(fault, Fault)
            return replace(fault, at=(place, "where", each["key"]))
        if each["index"] is not None:
            actual = actual[each["index"] : each["index"] + 1]
        wanted = [number.value for number in expected]
        if len(wanted) != actual.size or not equal(actual, wanted, None):
            return False
    return True


def _bodies_around(scope: Scope, kind: str, index: int) -> Iterator[int]:
    """Yield the bodies around an element, from the nearest to the world."""
    body = holder(scope.model, kind, index)
    while body:
        yield body
        body = holder(scope.model, "body", body)
    yield 0


def _there(selector: dict[str, Any]) -> str:
    words = (("parent", "right on"), ("inside", "in"))
    there = "".join(f" {word} a body `{selector[key]}`" for key, word in words if selector[key])
    keys = ", ".join(f"`{each['key']}`" for each in selector["where"])
    return f"{there} with such {keys}" if keys else there

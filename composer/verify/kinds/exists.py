"""The check `exists`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.verify.kinds.finding import Finding, failed, unknown
from composer.verify.kinds.scope import Scope
from composer.verify.matching import ON_BODIES


def check(scope: Scope, asked: dict[str, Any]) -> list[Finding]:
    """One finding for each selector that names nothing, or another number than it expects."""
    found: list[Finding] = []
    for index, selector in enumerate(asked["selectors"]):
        tag, glob, expect = selector["tag"], selector["glob"], selector["expect"]
        matched = [each for each in scope.matching(tag, glob) if _stands_there(scope, tag, each, selector)]
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
            message, more = f"{seen.message}{_there(selector)}", list(seen.notes)
        finding = failed(message, count, str(len(matched)), index, tag, more=more)
        found.append(Finding(finding.message, finding.at, finding.notes, help=None if matched else seen.help))
    return found


def _stands_there(scope: Scope, kind: str, index: int, selector: dict[str, Any]) -> bool:
    """Whether the bodies around an element are those that are asked for."""
    if not (selector["parent"] or selector["inside"]):
        return True
    around = list(_bodies_around(scope, kind, index))
    asked = ((selector["parent"], around[:1]), (selector["inside"], around))
    return all(glob is None or set(bodies) & set(scope.matching("body", glob)) for glob, bodies in asked)


def _bodies_around(scope: Scope, kind: str, index: int) -> Iterator[int]:
    """From the nearest to the world."""
    body = int(
        getattr(scope.model, ON_BODIES[kind])[index] if kind != "body" else scope.model.body_parentid[index]
    )
    while body:
        yield body
        body = int(scope.model.body_parentid[body])
    yield 0


def _there(selector: dict[str, Any]) -> str:
    words = (("parent", "right on"), ("inside", "in"))
    return "".join(f" {word} a body `{selector[key]}`" for key, word in words if selector[key])

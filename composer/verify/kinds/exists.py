"""The check `exists`."""

from __future__ import annotations

from typing import Any

from composer.verify.kinds.finding import Finding, failed, unknown
from composer.verify.kinds.scope import Scope


def check(scope: Scope, asked: dict[str, Any]) -> list[Finding]:
    """One finding for each selector that names nothing, or another number than it expects."""
    found: list[Finding] = []
    for index, selector in enumerate(asked["selectors"]):
        tag, glob, expect = selector["tag"], selector["glob"], selector["expect"]
        matched = scope.matching(tag, glob)
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
            message, more = seen.message, list(seen.notes)
        finding = failed(message, count, str(len(matched)), index, tag, more=more)
        found.append(Finding(finding.message, finding.at, finding.notes, help=None if matched else seen.help))
    return found

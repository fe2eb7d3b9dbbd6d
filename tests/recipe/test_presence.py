from __future__ import annotations

import pytest

from composer.grammar.element import Constraint
from composer.recipe.fault import Fault
from composer.recipe.presence import report_clashing


def told(kind: str, bundles: str, present: str) -> list[Fault]:
    faults: list[Fault] = []
    rule = Constraint(kind, tuple(tuple(bundle.split("+")) for bundle in bundles.split()))  # type: ignore[arg-type]
    report_clashing([rule], present.split(), "`e`", (), faults)
    return faults


@pytest.mark.parametrize(
    ("kind", "bundles", "present"),
    [
        ("exclusive", "a b c", "b"),
        ("exclusive", "a+b c+d", "a b"),
        ("oneof", "a+b c", "c"),
        ("oneof", "a+b c", "a b"),
        ("together", "a b", ""),
        ("together", "a b", "b a"),
        ("requires", "a b+c", "b"),
        ("requires", "a b+c", "a b c"),
    ],
)
def test_kept(kind: str, bundles: str, present: str) -> None:
    assert told(kind, bundles, present) == []


@pytest.mark.parametrize(
    ("kind", "bundles", "present", "code", "at"),
    [
        ("exclusive", "a b c", "c a", "wrong-type", ("a",)),
        ("exclusive", "a+b c+d", "b d a", "wrong-type", ("a",)),
        ("oneof", "a+b c", "a", "missing-key", ()),
        ("together", "a b", "b", "missing-key", ("b",)),
        ("requires", "a b+c", "a c", "missing-key", ("a",)),
    ],
)
def test_broken(kind: str, bundles: str, present: str, code: str, at: tuple[str, ...]) -> None:
    (fault,) = told(kind, bundles, present)
    assert (fault.code, fault.at) == (code, at)


def test_the_first_of_two_is_shown_too() -> None:
    (fault,) = told("exclusive", "a b", "b a")
    assert fault.related[0][1] == ("b",)

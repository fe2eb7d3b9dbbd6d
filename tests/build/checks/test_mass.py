from __future__ import annotations

import pytest

from tests.build.checks.conftest import notes


@pytest.mark.parametrize(
    ("check", "prefix"),
    [
        ("range: [10, 11]", ""),
        ("value: 10.5", ""),
        ("subtree: left/base, value: 6", ""),
        ("body: left/base, value: 5", ""),
        ("body: left/base, value: 5.3, tol: 0.31", ""),
        ("subtree: base, range: [6, 6]", "left/"),
        ("value: 6", "left/"),
        ("value: 4", "right/"),
    ],
)
def test_holds(ask, arm: str, check: str, prefix: str) -> None:
    assert ask(arm, f"mass: {{{check}}}", prefix=prefix) == []


@pytest.mark.parametrize(
    ("check", "at", "message", "expected"),
    [
        ("range: [1, 2]", "range", "the mass of the model is 10.5 kg", "1 to 2 kg"),
        (
            "body: left/base, value: 5.3, tol: 0.2",
            "value",
            "the mass of `left/base` is 5 kg",
            "5.3 kg ± 0.2 kg",
        ),
        (
            "subtree: left/base, value: 6.001",
            "value",
            "the mass of `left/base` with all below it is 6 kg",
            "6.001 kg",
        ),
    ],
)
def test_does_not_hold(ask, arm: str, check: str, at: str, message: str, expected: str) -> None:
    (finding,) = ask(arm, f"mass: {{{check}}}")
    assert (finding.at, finding.message) == ((at,), message)
    assert notes(finding)[0] == f"expected: {expected}"
    assert finding.code == "check-failed"


def test_a_body_that_is_not_there(ask, arm: str) -> None:
    (finding,) = ask(arm, "mass: {body: bse, value: 1}", prefix="left/")
    assert (finding.code, finding.at) == ("unknown-name", ("body",))
    assert finding.message == "the body `bse` does not exist"
    assert finding.help == "did you mean `base`?"

from __future__ import annotations

from collections.abc import Callable

import pytest

from composer.diagnostics import Diagnostic
from composer.recipe.checks.unchanged import Unchanged
from composer.recipe.recipe import Recipe


def test_a_check_knows_its_name_and_place(recipe: Callable[[str], Recipe]) -> None:
    found = recipe("""
        check:
          whole: {unchanged: {}}
          hand: {unchanged: {part: left/hand, except: [gravcomp, friction]}}
    """).check
    assert found == (
        Unchanged("whole", None, (), ("check", "whole")),
        Unchanged("hand", "left/hand", ("gravcomp", "friction"), ("check", "hand")),
    )


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("[{unchanged: {}}]", "wrong-type", "expects a mapping from names"),
        ("{a: {}}", "missing-key", "checks nothing"),
        ("{a: unchanged}", "wrong-type", "is a mapping"),
        ("{a: {unchange: {}}}", "unknown-key", "not a kind of check"),
        ("{a: {unchanged: gripper}}", "wrong-type", "is a mapping"),
        ("{a: {unchanged: {parts: gripper}}}", "unknown-key", "has no key `parts`"),
        ("{a: {unchanged: {part: [gripper]}}}", "wrong-type", "the prefix of a part"),
        ("{a: {unchanged: {except: gravcomp}}}", "wrong-type", "a list of attributes"),
        ("{a: {unchanged: {except: [gravcom]}}}", "unknown-attribute", "no attribute `gravcom`"),
        ("{a: {unchanged: {except: [1]}}}", "wrong-type", "attributes of MJCF"),
        ("{a: {unchanged: {except: [class]}}}", "unknown-attribute", "could be excepted"),
    ],
)
def test_one_fault_at_its_place(
    faults: Callable[[str], list[Diagnostic]], text: str, code: str, told: str
) -> None:
    (fault,) = faults(f"check: {text}")
    assert fault.code == code
    assert told in fault.message
    assert fault.span is not None
    assert fault.span.line == 2


def test_of_a_misspelt_attribute_the_right_one_is_named(faults: Callable[[str], list[Diagnostic]]) -> None:
    (fault,) = faults("check: {a: {unchanged: {part: arm, except: [gravcom]}}}")
    assert fault.help == "write `gravcomp`"
    assert fault.span is not None
    assert fault.span.column == 45

from __future__ import annotations

from collections.abc import Callable

import pytest

from composer.diagnostics import Diagnostic
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.recipe import Recipe
from composer.recipe.unsupported import UNSUPPORTED, is_unsupported


@pytest.mark.parametrize(
    ("path", "told"),
    [
        (("randomize",), True),
        (("sensor",), False),
        (("attach", "randomize"), False),
        (("sensor", "randomize"), False),
    ],
)
def test_by_path(path: tuple[str | int, ...], told: bool) -> None:
    assert is_unsupported(path) is told


def test_no_key_is_in_the_table_and_works() -> None:
    for kind, model in (("recipe", Recipe), ("attach", Attachment), ("base", Base)):
        assert not UNSUPPORTED[kind] & set(model.model_fields)


def test_what_is_below_is_not_told(faults: Callable[[str], list[Diagnostic]]) -> None:
    (fault,) = faults("randomize: {reach: {default: null, foo: '${a}'}}")
    assert fault.message == "`randomize` is not supported by this version"


def test_expressions_that_nobody_evaluated(faults: Callable[[str], list[Diagnostic]]) -> None:
    found = faults(
        'name: "${a}"\nsensor: {"${b}": {type: clock}}\noption: {gravity: [0, 0, "${g}"], cone: "${c}"}'
    )
    assert [fault.code for fault in found] == ["expression"] * 4

"""A pass says what it needs and what it leaves; an order that breaks a need is an error that names both passes."""

from __future__ import annotations

from itertools import pairwise

import pytest

from composer.link.contract import AT_THE_START, Fact, Pass, PassOrderError, check_order
from composer.link.link import FINISHING, PASSES, row_of
from composer.link.names import names

ALL = (*PASSES, *FINISHING)
# The neighbours whose order changes a model or a fault: measured by swapping them, on all models of the tests.
NOT_TO_BE_SWAPPED = {
    ("note_flexes", "flex_turns"),
    ("replicates", "layouts"),
    ("body_reduction", "choose_classes"),
    ("lengthranges", "angles"),
    ("submodel_options", "agreement"),
    ("files", "submodels"),
    ("submodels", "names"),
    ("names", "defaults"),
    ("defaults", "bodies"),
    ("bodies", "check_replicates"),
}


def swapped(first: Pass, second: Pass) -> list[Pass]:
    return [second if row is first else first if row is second else row for row in ALL]


@pytest.mark.parametrize("pair", sorted(NOT_TO_BE_SWAPPED))
def test_neighbours_whose_order_matters_cannot_be_swapped(pair: tuple[str, str]) -> None:
    first, second = next(each for each in pairwise(PASSES) if (each[0].name, each[1].name) == pair)
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(first, second))
    assert f"`{first.name}`" in str(raised.value) and f"`{second.name}`" in str(raised.value)


def test_the_sentence_of_an_order_that_breaks_a_need() -> None:
    by_name = {row.name: row for row in ALL}
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(by_name["names"], by_name["defaults"]))
    assert str(raised.value) == (
        "the pass `defaults` must stand after `names`: it needs that every name is the one that it has in the model"
    )
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(by_name["lengthranges"], by_name["angles"]))
    assert str(raised.value) == (
        "the pass `lengthranges` must stand before `angles`: it needs that MuJoCo can compile each unit alone, "
        "with its own settings, files and angles"
    )


def test_a_need_that_no_pass_meets() -> None:
    with pytest.raises(PassOrderError, match="the pass `names` cannot run: it needs that "):
        check_order([Pass(names, "words", needs=frozenset({Fact.JOINED}))])


def test_a_pass_without_words_is_refused() -> None:
    with pytest.raises(ValueError, match="the pass `names` has no words for `mjcompose explain`"):
        Pass(names, " ")
    with pytest.raises(TypeError):
        Pass(names)  # type: ignore[call-arg]


def test_every_fact_is_needed_and_left_by_somebody() -> None:
    assert frozenset().union(*(row.needs for row in ALL)) == set(Fact)
    assert AT_THE_START.union(*(row.leaves for row in ALL)) == set(Fact)


def test_rows_are_found_by_their_function() -> None:
    assert all(row_of(row.run) is row for row in ALL)
    assert row_of(names) in PASSES
    assert row_of("names") is None

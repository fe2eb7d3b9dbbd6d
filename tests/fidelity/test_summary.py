from __future__ import annotations

import pytest
from fidelity.judging import Verdict
from fidelity.roundtrip import Trip
from fidelity.summary import BEGIN, END, Row, between_markers, of_compositions, of_trips, text, together


def test_compositions_are_counted() -> None:
    verdicts = [
        Verdict("a", compiled=True, built=True, rival="right"),
        Verdict("b", compiled=True, built=True, parts={"x/": ["different"]}, rival="fails: so"),
        Verdict("c", refused="why", diagnostics="error: so"),
    ]
    wanted, refused = of_compositions("pairs", verdicts)
    assert (wanted.size, wanted.ours, wanted.mjspec) == (2, 1, 1)
    assert (refused.size, refused.ours, refused.mjspec) == (1, 1, None)


def test_files_that_do_not_load_are_not_counted() -> None:
    row = of_trips("files", [Trip("a", mjspec=True), Trip("b", loads=False), Trip("c", different=("qpos0",))])
    assert (row.size, row.ours, row.mjspec) == (2, 1, 1)


def test_a_table_never_rounds_up_to_all() -> None:
    table = text(together([Row("pairs", 1000, 999, 1000), Row("nothing", 0, 0)]))
    assert "| pairs | 1000 | 999 (99 %) | 1000 (100 %) | – |" in table
    assert "nothing" not in table


def test_the_table_goes_between_its_markers() -> None:
    page = f"a\n{BEGIN}\nold\n{END}\nb\n"
    assert between_markers(page, "new") == f"a\n{BEGIN}\nnew\n{END}\nb\n"
    with pytest.raises(ValueError, match="has no"):
        between_markers("a", "new")

from __future__ import annotations

from dataclasses import replace

import pytest
from mjcompose.base.diagnostic import Cause, CellName, Diagnostic, Note, Severity, Span
from mjcompose.base.sink import Sink

SPAN = Span("a.yaml", 2, 5, 2, 9)


def test_keeps_the_order_and_drops_repetitions() -> None:
    sink = Sink()
    sink.error("bad-name", "b", Span("f", 2, 1), notes=[Note("n")], help="h")
    sink.warning("bad-name", "a", Span("f", 1, 1))
    sink.error("bad-name", "b", Span("f", 2, 1), notes=(Note("n"),), help="h")
    sink.note("bad-name", "c")
    assert [each.message for each in sink.diagnostics] == ["b", "a", "c"]
    assert sink.diagnostics[0] == Diagnostic("bad-name", "b", Span("f", 2, 1), Severity.ERROR, (Note("n"),), "h")
    assert [each.severity for each in sink.diagnostics] == ["error", "warning", "note"]


def test_same_message_in_another_place_is_another_diagnostic() -> None:
    sink = Sink()
    sink.error("bad-name", "b", Span("f", 2, 1))
    sink.error("bad-name", "b", Span("f", 3, 1))
    assert len(sink.diagnostics) == 2


def test_findings_of_one_cause_are_one_diagnostic_with_all_their_places() -> None:
    sink = Sink()
    for line in (3, 7, 9, 9):
        sink.error("bad-name", f"line {line}", Span("f", line, 1), help="h", cause=Cause("x", f"at {line}"))
    sink.warning("bad-name", "line 3", Span("f", 3, 1), cause=Cause("x", "at 3"))  # not as bad
    sink.error("bad-name", "other", Span("f", 4, 1), cause=Cause("y", "other"))
    first, warned, other = sink.diagnostics
    assert (first.message, first.span) == ("line 3", Span("f", 3, 1))
    assert first.others == (Note("at 7", Span("f", 7, 1)), Note("at 9", Span("f", 9, 1)))
    assert (warned.others, other.others) == ((), ())
    assert sink.errors == [first, other] and first in sink.sorted()
    assert sink.error_count == 5


def test_sorted_by_place_with_unplaced_last() -> None:
    sink = Sink()
    for span in (None, Span("b", 1, 1), Span("a", 10, 1), Span("a", 9, 5), Span("a", 9, 2)):
        sink.error("bad-name", "x", span)
    assert [str(each.span) for each in sink.sorted()] == ["a:9:2", "a:9:5", "a:10:1", "b:1:1", "None"]


def test_errors_come_first_and_those_of_a_recipe_before_those_of_models() -> None:
    sink = Sink()
    sink.note("bad-name", "x", Span("a.yaml", 1, 1))
    sink.warning("bad-name", "x", Span("a.yaml", 1, 1))
    sink.warning("bad-name", "x")
    sink.error("bad-name", "x", Span("gripper.XML", 1, 1))
    sink.error("bad-name", "x")
    sink.error("bad-name", "x", Span("robot.yaml", 9, 1))
    sink.error("bad-name", "x", Span("--set mass", 1, 1))
    assert [(str(each.severity), str(each.span)) for each in sink.sorted()] == [
        ("error", "--set mass:1:1"),
        ("error", "robot.yaml:9:1"),
        ("error", "gripper.XML:1:1"),
        ("error", "None"),
        ("warning", "a.yaml:1:1"),
        ("warning", "None"),
        ("note", "a.yaml:1:1"),
    ]


def test_only_errors_are_errors() -> None:
    sink = Sink()
    assert not sink.has_errors
    sink.warning("bad-name", "w")
    sink.note("bad-name", "n")
    assert not sink.has_errors
    assert sink.errors == []
    sink.error("bad-name", "e")
    assert sink.has_errors
    assert [each.message for each in sink.errors] == ["e"]


def test_unknown_code_is_a_bug() -> None:
    with pytest.raises(KeyError):
        Sink().error("no-such-code", "x")


def test_what_it_gives_out_is_a_copy() -> None:
    sink = Sink()
    sink.error("bad-name", "x")
    sink.diagnostics.clear()
    assert len(sink.diagnostics) == 1


def test_what_lacks_a_lost_name_is_not_told_but_counts() -> None:
    sink = Sink()
    sink.error("unknown-key", "`left` is wrong")
    sink.suppress_about(["left", "cup"])
    sink.error("unknown-name", "the site `left/tip` does not exist", subjects=["left/tip"])
    sink.error("unknown-name", "the body `cup` does not exist", subjects=["cup"])
    sink.error("unknown-name", "the body `cups` does not exist", subjects=["cups"])
    sink.error("unknown-name", "the word `cup` in a message means nothing")
    sink.warning("option-conflict", "`right/` wants more")
    sink.error("source-fetch", "the repository `https://host/left/cup` cannot be fetched")
    assert [each.message for each in sink.diagnostics] == [
        "`left` is wrong",
        "the body `cups` does not exist",
        "the word `cup` in a message means nothing",
        "the repository `https://host/left/cup` cannot be fetched",
    ]
    assert sink.error_count == 6


ONE = CellName("a-1", "a-1")
TWO = CellName("a-2", "a-2")


def test_equal_faults_of_several_cells_are_one_that_names_them_all() -> None:
    sink = Sink()
    fault = Diagnostic("bad-name", "x")
    for cell in (ONE, TWO, ONE):
        sink.add_of_cell(cell, fault)
    sink.add_of_cell(TWO, Diagnostic("bad-name", "y"))
    told = [(each.message, each.cells) for each in sink.diagnostics]
    assert told == [("x", (ONE, TWO)), ("y", (TWO,))]
    assert sink.sorted() == sink.diagnostics == sink.errors
    assert sink.has_errors


def test_a_fault_of_the_whole_recipe_is_not_one_of_a_cell() -> None:
    sink = Sink()
    sink.warning("bad-name", "x")
    sink.add_of_cell(ONE, sink.diagnostics[0])
    assert [each.cells for each in sink.diagnostics] == [()]


def test_a_warning_is_dropped_with_all_of_its_cause() -> None:
    sink = Sink()
    for subject in ("a", "b"):
        sink.warning("bad-name", subject, cause=Cause("same", subject))
    sink.error("bad-name", "an error")
    error, warning = sink.sorted()
    sink.drop(warning)
    assert sink.diagnostics == [error]
    sink.warning("bad-name", "c", cause=Cause("same", "c"))
    assert [each.message for each in sink.diagnostics] == ["an error", "c"]
    with pytest.raises(ValueError, match="error"):
        sink.drop(error)


def test_promoted_warnings_are_errors() -> None:
    sink = Sink()
    sink.add_of_cell(CellName("x"), Diagnostic("bad-name", "a", severity=Severity.WARNING))
    sink.note("bad-name", "n")
    assert not sink.has_errors
    sink.promote()
    assert [(each.severity, each.cells) for each in sink.sorted()] == [
        (Severity.ERROR, (CellName("x"),)),
        (Severity.NOTE, ()),
    ]
    assert sink.has_errors


def test_findings_of_cells_at_one_place_are_one_with_what_each_says() -> None:
    at = Span("r.yaml", 3, 1)
    other = Span("r.yaml", 4, 1)
    sink = Sink()
    for number in range(19):
        cell = CellName(f"s{number}", None, number)
        sink.add_of_cell(cell, Diagnostic("check-failed", f"{number} kg", at, notes=(Note("at most 3 kg"),)))
        sink.add_of_cell(cell, Diagnostic("check-failed", "the same", other))
        sink.add_of_cell(cell, Diagnostic("check-failed", "second", other))  # of one cell both count
    first, same, second = sink.diagnostics
    assert [each.message for each in sink.diagnostics] == ["0 kg", "the same", "second"]
    assert all(len(each.cells) == 19 for each in sink.diagnostics)
    assert first.others == tuple(Note(f"s{number}: {number} kg") for number in range(1, 19))
    assert same.others == second.others == () and sink.error_count == 57


def test_what_exists_instead_in_another_cell_is_kept() -> None:
    sink = Sink()
    at = Span("r.yaml", 3, 1)
    for name in "abc":
        fault = Diagnostic("attach-place", "no site `x`", at, notes=(Note("a hint"), Note(f"sites: {name}")))
        sink.add_of_cell(CellName(name), fault)
    (found,) = sink.diagnostics
    assert found.notes == (Note("a hint"), Note("sites: a"))
    assert found.others == (Note("b: sites: b"), Note("c: sites: c"))


def test_a_severity_and_a_code_of_its_own_are_another_finding() -> None:
    sink = Sink()
    at = Span("r.yaml", 3, 1)
    sink.add_of_cell(CellName("a"), Diagnostic("bad-name", "x", at))
    sink.add_of_cell(CellName("b"), Diagnostic("bad-name", "y", at, Severity.WARNING))
    sink.add_of_cell(CellName("c"), Diagnostic("unknown-name", "z", at))
    sink.add_of_cell(CellName("d"), Diagnostic("bad-name", "without a place"))
    for cell in "ef":
        sink.add_of_cell(CellName(cell), Diagnostic("bad-name", f"of {cell}", help="the same helps"))
    assert [(each.message, len(each.cells)) for each in sink.diagnostics] == [
        ("x", 1),
        ("y", 1),
        ("z", 1),
        ("without a place", 1),
        ("of e", 2),
    ]


def test_equal_findings_of_several_recipes_are_one() -> None:
    sink = Sink()
    at = Span("part.xml", 3, 1)
    for recipe in ("a.yaml", "b.yaml"):
        sink.add_of_recipe(recipe, Diagnostic("bad-name", "x", at))
        sink.add_of_recipe(recipe, Diagnostic("bad-name", recipe, at))
    assert [(each.message, each.recipes) for each in sink.diagnostics] == [
        ("x", ("a.yaml", "b.yaml")),
        ("a.yaml", ("a.yaml",)),
        ("b.yaml", ("b.yaml",)),
    ]


def test_faults_of_turns_at_one_place_are_one_but_two_faults_of_one_turn_are_two() -> None:
    sink = Sink()
    for message, turn in (
        ("no `a0`", "`i` is 0"),
        ("no `b0`", "`i` is 0"),
        ("no `a1`", "`i` is 1"),
        ("no `a2`", "`i` is 2"),
    ):
        sink.error("unknown-name", message, replace(SPAN, turn=turn))
    first, second = sink.diagnostics
    assert (first.message, second.message, sink.error_count) == ("no `a0`", "no `b0`", 4)
    assert [each.message for each in first.notes] == ["where `i` is 0"]
    assert [each.message for each in first.others] == ["where `i` is 1", "where `i` is 2"]
    again = Sink()
    again.extend(sink.diagnostics)
    assert again.diagnostics == sink.diagnostics


def test_a_fault_of_a_value_from_a_table_is_told_there() -> None:
    sink = Sink()
    row = Span("motors.csv", 3, 6)
    sink.error("wrong-type", "no number", replace(SPAN, source=row))
    (found,) = sink.diagnostics
    assert found.span == row and found.notes == (Note("the value is used here", SPAN),)

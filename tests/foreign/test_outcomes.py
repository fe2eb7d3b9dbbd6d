from __future__ import annotations

from pathlib import Path

import pytest
from foreign.outcomes import Group, Outcome, intended, run_tests, surprises

TESTS = """
import unittest
import beside

class ThingTest(unittest.TestCase):
  def test_good(self):
    self.assertEqual(beside.ONE, 1)
  def test_bad(self):
    self.assertEqual(1, 2, 'why not')
  def test_worse(self):
    raise KeyError('lost')
"""


def test_tests_are_run_and_told_by_name(tmp_path: Path) -> None:
    (tmp_path / "beside").mkdir()
    (tmp_path / "beside" / "beside.py").write_text("ONE = 1\n")
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "thing_test.py").write_text(TESTS)
    found = {outcome.id: outcome for outcome in run_tests(tmp_path / "tests", [tmp_path / "beside"])}
    names = {name: found[f"thing_test.py::ThingTest::test_{name}"] for name in ("good", "bad", "worse")}
    assert len(found) == 3
    assert [each.passed for each in names.values()] == [True, False, False]
    assert "1 != 2 : why not" in names["bad"].said and "lost" in names["worse"].said


def test_a_run_that_comes_to_no_end_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "broken_test.py").write_text("import nowhere_to_be_found\n")
    with pytest.raises(RuntimeError, match="nowhere_to_be_found"):
        run_tests(tmp_path, [])


def test_only_what_is_not_listed_is_a_surprise() -> None:
    found = [Outcome("good", True), Outcome("meant", False, "so"), Outcome("bad", False, "no"), Outcome("mended", True)]
    assert surprises(found, [Group("reason", "page", ("meant", "mended", "gone"))]) == [
        "bad fails: no",
        "mended passes, and is listed as an intended difference",
        "gone is listed as an intended difference, and is no test",
    ]


def test_no_test_is_listed_twice() -> None:
    tests = [test for group in intended() for test in group.tests]
    assert len(tests) == len(set(tests))


def test_the_page_says_how_many_fail() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "from_dm_control.md").read_text(encoding="utf-8")
    number = sum(len(group.tests) for group in intended())
    assert f"of 124 tests {124 - number} pass, and {number} fail on purpose" in page

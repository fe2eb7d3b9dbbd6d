from __future__ import annotations

from xml.etree import ElementTree as Xml

from composer.diagnostics import Diagnostic, Note, Span
from composer.diagnostics.cell_name import CellName
from composer.diagnostics.junit import Case, Suite, report

FAULT = Diagnostic(
    "check-failed", "`nu` is 8, not <7>", Span("a.yaml", 2, 3, 2, 5), notes=(Note("expected: 7"),)
)


def test_a_suite_for_each_file_and_a_case_for_each_check() -> None:
    cases = [Case("dims", "size", [FAULT], "a.yaml", 2), Case("left/reach", "reachable", [], "b.yaml", 9)]
    root = Xml.fromstring(report([Suite("a.yaml", cases), Suite("c.yaml", [])], lambda _: "x\n  dims: 1"))
    first, second = root.findall("testsuite")
    assert (first.get("name"), first.get("tests"), first.get("failures")) == ("a.yaml", "2", "1")
    assert (second.get("tests"), second.get("failures")) == ("0", "0")
    failed, passed = first.findall("testcase")
    assert (failed.get("classname"), failed.get("name"), failed.get("line")) == ("a.yaml.size", "dims", "2")
    assert (passed.get("name"), passed.get("file"), len(passed)) == ("left/reach", "b.yaml", 0)
    failure = failed.find("failure")
    assert failure is not None and failure.text is not None
    assert (failure.get("type"), failure.get("message")) == ("check-failed", "`nu` is 8, not <7>")
    assert failure.text.startswith("a.yaml:2:3: error[check-failed]: `nu` is 8, not <7>")
    assert "expected: 7" in failure.text


def test_what_xml_cannot_hold_is_replaced() -> None:
    fault = Diagnostic("check-failed", "a\x00b\x1b", None)
    root = Xml.fromstring(report([Suite("a", [Case("n", "k", [fault])])], lambda _: None))
    failure = root.find(".//failure")
    assert failure is not None and failure.get("message") == "a␀b␛"


def test_the_cell_of_a_suite_is_a_property() -> None:
    root = Xml.fromstring(report([Suite("a.yaml", [], CellName("a-1-s0002", "a-1", 2))], lambda _: None))
    found = {each.get("name"): each.get("value") for each in root.iter("property")}
    assert found == {"name": "a-1-s0002", "cell": "a-1", "sample": "2"}

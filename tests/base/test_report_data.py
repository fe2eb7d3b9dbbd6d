"""SARIF 2.1.0: the fields that its schema requires, and positions as GitHub and editors read them."""

from __future__ import annotations

import json
from typing import Any

from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Severity, Span
from mjcompose.base.report_data import render_sarif

SPAN = Span("my arm.yaml", 3, 5, 3, 9)


def check_document(text: str) -> list[dict[str, Any]]:
    """Check the fields that the schema requires; return the results."""
    document = json.loads(text)
    assert document["version"] == "2.1.0" and document["$schema"].endswith("/sarif-schema-2.1.0.json")
    (run,) = document["runs"]
    driver = run["tool"]["driver"]
    assert driver["name"] == "mjcompose"
    ids = [rule["id"] for rule in driver["rules"]]
    assert len(set(ids)) == len(ids)
    for result in run["results"]:
        assert ids[result["ruleIndex"]] == result["ruleId"]
        assert result["level"] in ("none", "note", "warning", "error")
        assert isinstance(result["message"]["text"], str)
        for place in (*result["locations"], *result.get("relatedLocations", ())):
            physical = place["physicalLocation"]
            assert " " not in physical["artifactLocation"]["uri"]
            region = physical["region"]
            assert all(isinstance(value, int) and value >= 1 for value in region.values())
        for fix in result.get("fixes", ()):
            for change in fix["artifactChanges"]:
                assert change["artifactLocation"]["uri"]
                assert all("deletedRegion" in each for each in change["replacements"])
    results: list[dict[str, Any]] = run["results"]
    return results


def test_a_document_without_diagnostics() -> None:
    assert check_document(render_sarif([])) == []


def test_every_field() -> None:
    whole = Diagnostic(
        "unknown-name",
        "no `senser`",
        SPAN,
        notes=(Note("it is here", Span("/a/b.xml", 1, 2)), Note("names: sensor")),
        help="write `sensor`",
        fix=Fix("sensor"),
    )
    found = check_document(render_sarif([whole, Diagnostic("bad-name", "b", severity=Severity.NOTE), whole]))
    assert [each["level"] for each in found] == ["error", "note", "error"]
    assert [each["ruleIndex"] for each in found] == [0, 1, 0]
    text = found[0]["message"]["text"]
    assert text == "no `senser`\nnote: /a/b.xml:1:2: it is here\nnote: names: sensor\nhelp: write `sensor`"
    physical = found[0]["locations"][0]["physicalLocation"]
    assert physical["artifactLocation"] == {"uri": "my%20arm.yaml"}
    assert physical["region"] == {"startLine": 3, "startColumn": 5, "endLine": 3, "endColumn": 9}
    (related,) = found[0]["relatedLocations"]
    assert related["physicalLocation"]["artifactLocation"] == {"uri": "file:///a/b.xml"}
    (replacement,) = found[0]["fixes"][0]["artifactChanges"][0]["replacements"]
    assert replacement["insertedContent"] == {"text": "sensor"} and found[1]["locations"] == []


def test_a_fix_of_a_name_without_its_quotes_is_left_to_the_help() -> None:
    (found,) = check_document(render_sarif([Diagnostic("bad-name", "a", SPAN, fix=Fix("b", "a"))]))
    assert "fixes" not in found

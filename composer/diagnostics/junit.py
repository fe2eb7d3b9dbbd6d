"""Test results as JUnit XML, which CI systems show as a table: one suite for each recipe, one case for each check."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from xml.etree import ElementTree as Xml

from composer.dataclass import dataclass
from composer.diagnostics.cell_name import CellName
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.text import ReadSource, printable, render

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True)
class Case:
    """One test: `kind` says what it tests, `errors` are its failures; none means that it passes."""

    name: str
    kind: str
    errors: Sequence[Diagnostic] = ()
    file: str | None = None
    line: int | None = None


@dataclass(frozen=True, slots=True)
class Suite:
    """The tests of one file, or of one of its cells."""

    name: str
    cases: Sequence[Case]
    cell: CellName | None = None

    def properties(self) -> dict[str, str]:
        """Return the cell and its components by name."""
        found = {} if self.cell is None else asdict(self.cell)
        return {name: str(value) for name, value in found.items() if value is not None}


def report(suites: Iterable[Suite], read: ReadSource) -> str:
    """Return the text of the whole file. No I/O except `read`."""
    root = Xml.Element("testsuites", {"name": "mjcompose"})
    for suite in suites:
        failures = sum(bool(case.errors) for case in suite.cases)
        counts = {"tests": str(len(suite.cases)), "failures": str(failures), "errors": "0", "skipped": "0"}
        element = Xml.SubElement(root, "testsuite", {"name": _text(suite.name), **counts})
        if properties := suite.properties():
            listed = Xml.SubElement(element, "properties")
            for name, value in properties.items():
                Xml.SubElement(listed, "property", {"name": name, "value": _text(value)})
        for case in suite.cases:
            place = {"file": case.file, "line": None if case.line is None else str(case.line)}
            about = {"classname": f"{suite.name}.{case.kind}", "name": case.name, **place}
            row = Xml.SubElement(
                element, "testcase", {key: _text(value) for key, value in about.items() if value is not None}
            )
            if case.errors:
                first = case.errors[0]
                failure = Xml.SubElement(
                    row, "failure", {"type": first.code, "message": _text(first.message)}
                )
                failure.text = _text("\n\n".join(render(each, read) for each in case.errors))
    Xml.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{Xml.tostring(root, encoding="unicode")}\n'


def _text(text: str) -> str:
    """Replace characters that act on whoever shows them, and those that XML does not allow."""
    return _NO_XML.sub("\ufffd", printable(text))

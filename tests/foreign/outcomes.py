"""What came of the rewritten tests, against the list of intended differences."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

LIST = Path(__file__).with_name("intended.toml")
_INI = "[pytest]\npython_files = *_test.py\n"


@dataclass(frozen=True, slots=True)
class Outcome:
    """A test: whether it passed, and the first line of what it says if not."""

    id: str
    passed: bool
    said: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """Tests that fail for one reason; `page` is what docs/how-to/from_dm_control.md says of it."""

    reason: str
    page: str
    tests: tuple[str, ...]


def intended(path: Path = LIST) -> list[Group]:
    rows = tomllib.loads(path.read_text(encoding="utf-8"))["group"]
    return [Group(row["reason"], row["page"], tuple(row["tests"])) for row in rows]


def run_tests(folder: Path, paths: list[Path]) -> list[Outcome]:
    """Runs the tests of a folder in a process of its own, in which `paths` are looked for modules."""
    (folder / "pytest.ini").write_text(_INI, encoding="utf-8")
    report = folder / "report.xml"
    search = os.pathsep.join([*map(str, paths), os.environ.get("PYTHONPATH", "")])
    options = ("-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--import-mode=importlib", f"--junitxml={report}")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, "."],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": search},
        capture_output=True,
        text=True,
        check=False,
    )
    # 0 and 1: all were run. Others mean that pytest itself did not come to the end.
    if done.returncode not in (0, 1) or not report.exists():
        raise RuntimeError(f"pytest came to no end:\n{done.stdout}{done.stderr}")
    return list(outcomes(report))


def outcomes(report: Path) -> Iterator[Outcome]:
    """The tests of a report in JUnit's format."""
    for case in ElementTree.parse(report).getroot().iter("testcase"):
        module, _, name = case.attrib["classname"].rpartition(".")
        fault = next((each for each in case if each.tag in ("failure", "error")), None)
        said = "" if fault is None else fault.attrib.get("message", "").partition("\n")[0]
        yield Outcome(f"{module.replace('.', '/')}.py::{name}::{case.attrib['name']}", fault is None, said)


def surprises(found: list[Outcome], groups: list[Group]) -> list[str]:
    """Every test that does not do what the list says, and every line of the list that is of no test."""
    reasons: Mapping[str, str] = {test: group.reason for group in groups for test in group.tests}
    told = []
    for outcome in found:
        if outcome.passed and outcome.id in reasons:
            told.append(f"{outcome.id} passes, and is listed as an intended difference")
        if not outcome.passed and outcome.id not in reasons:
            told.append(f"{outcome.id} fails: {outcome.said}")
    missing = sorted(reasons.keys() - {outcome.id for outcome in found})
    return told + [f"{test} is listed as an intended difference, and is no test" for test in missing]

"""dm_control's tests, rewritten to test mjcompose.mjcf: a table of replacements, and nothing else."""

from __future__ import annotations

import re
import shutil
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

TABLE = Path(__file__).with_name("renames.toml")


@dataclass(frozen=True, slots=True)
class Rename:
    """What is looked for, and what is put in its place.

    `page` is the text of docs/how-to/from_dm_control.md that tells users the same; where there is none, `why` says what the
    replacement is for.
    """

    before: re.Pattern[str]
    after: str
    page: str
    why: str


def renames(table: Path = TABLE) -> list[Rename]:
    return [_rename(**row) for row in tomllib.loads(table.read_text(encoding="utf-8"))["rename"]]


def left_out(table: Path = TABLE) -> dict[str, str]:
    """Test files that are not run, with the reason."""
    found: dict[str, str] = tomllib.loads(table.read_text(encoding="utf-8"))["left_out"]
    return found


def _rename(*, after: str, text: str = "", pattern: str = "", page: str = "", why: str = "") -> Rename:
    if bool(text) == bool(pattern) or not (page or why):
        raise ValueError(f"a rename has a text or a pattern, and a page or a reason: {text or pattern}")
    before = pattern or _as_it_stands(text)
    return Rename(re.compile(before, re.MULTILINE), after if pattern else after.replace("\\", r"\\"), page, why)


def _as_it_stands(text: str) -> str:
    """A pattern for the text, where it begins and ends with whole words."""
    return re.sub(r"^(?=\w)", r"(?<!\\w)", re.escape(text)) + (r"(?!\w)" if text[-1].isidentifier() else "")


def rewrite(sources: Mapping[str, str], table: Iterable[Rename]) -> tuple[dict[str, str], list[Rename]]:
    """The rewritten files by name, and the renames that nothing needed."""
    rewritten = dict(sources)
    idle = []
    for rename in table:
        count = 0
        for name, text in rewritten.items():
            rewritten[name], found = rename.before.subn(rename.after, text)
            count += found
        if not count:
            idle.append(rename)
    return rewritten, idle


def write_tests(package: Path, folder: Path) -> list[Rename]:
    """The rewritten tests with the files that they read, in a folder of their own; gives the idle renames."""
    skipped = left_out()
    sources = {
        path.name: path.read_text(encoding="utf-8")
        for path in sorted(package.glob("*_test.py"))
        if path.name not in skipped
    }
    rewritten, idle = rewrite(sources, renames())
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(package / "test_assets", folder / "test_assets")
    shutil.copy(package / "schema.xml", folder)
    for name, text in rewritten.items():
        (folder / name).write_text(text, encoding="utf-8")
    return idle

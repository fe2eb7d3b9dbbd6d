from __future__ import annotations

from pathlib import Path

import pytest
from foreign import outcomes, rewriting

PAGE = " ".join(
    (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "from_dm_control.md").read_text(encoding="utf-8").split()
)


def table(folder: Path, text: str) -> list[rewriting.Rename]:
    path = folder / "renames.toml"
    path.write_text(text, encoding="utf-8")
    return rewriting.renames(path)


def test_a_text_is_replaced_where_it_stands_as_whole_words(tmp_path: Path) -> None:
    found = table(tmp_path, '[[rename]]\ntext = "a.b(c"\nafter = "x\\\\1"\nwhy = "why"\n')
    assert rewriting.rewrite({"one": "a.b(c) aa.b(c) a.b(cc)", "two": "axb(c"}, found) == (
        {"one": "x\\1) aa.b(c) a.b(cc)", "two": "axb(c"},
        [],
    )


def test_a_pattern_is_replaced_with_its_groups(tmp_path: Path) -> None:
    found = table(tmp_path, "[[rename]]\npattern = '^import (\\w+)$'\nafter = 'from x import \\1'\nwhy = 'why'\n")
    assert rewriting.rewrite({"one": "import a\n import b\nimport c"}, found)[0] == {
        "one": "from x import a\n import b\nfrom x import c"
    }


def test_what_nothing_needs_is_reported(tmp_path: Path) -> None:
    found = table(tmp_path, '[[rename]]\ntext = "b"\nafter = "c"\nwhy = "why"\n')
    assert rewriting.rewrite({"one": "a"}, found) == ({"one": "a"}, found)


@pytest.mark.parametrize("row", ['text = "a"', 'text = "a"\npattern = "a"\nwhy = "why"', 'why = "why"'])
def test_a_rename_says_what_and_why(row: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="a rename has a text or a pattern, and a page or a reason"):
        table(tmp_path, f'[[rename]]\n{row}\nafter = "b"\n')


@pytest.mark.parametrize(
    "quoted",
    sorted(
        {rename.page for rename in rewriting.renames() if rename.page} | {group.page for group in outcomes.intended()}
    ),
)
def test_what_the_lists_quote_stands_on_the_page(quoted: str) -> None:
    assert " ".join(quoted.split()) in PAGE


def test_tests_are_written_with_their_files(tmp_path: Path) -> None:
    package = tmp_path / "package"
    (package / "test_assets").mkdir(parents=True)
    (package / "test_assets" / "arm.xml").write_text("<mujoco/>")
    (package / "schema.xml").write_text("<schema/>")
    (package / "one_test.py").write_text("from dm_control import mjcf\n")
    (package / "skin_test.py").write_text("from dm_control import mjcf\n")
    idle = rewriting.write_tests(package, tmp_path / "out")
    found = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*.*")}
    assert found == {"one_test.py", "schema.xml", "test_assets/arm.xml"}
    assert (tmp_path / "out" / "one_test.py").read_text() == "from mjcompose import mjcf\n"
    assert len(idle) == len(rewriting.renames()) - 1

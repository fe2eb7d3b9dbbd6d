"""The pages of the YAML errors show what they say: their example has the error, what mends it has none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from mjcompose.base.sink import Sink
from mjcompose.text.load import load

PAGES = sorted((Path(__file__).parents[2] / "docs" / "errors").glob("*.md"))


def blocks(page: Path) -> tuple[list[str], list[str]]:
    """The YAML of the example, and of what mends it."""
    example, mended = page.read_text(encoding="utf-8").split("## How to fix it")
    find = re.compile(r"^```yaml\n(.*?)^```", re.MULTILINE | re.DOTALL).findall
    return find(example), find(mended)


def codes(text: str) -> set[str]:
    sink = Sink()
    load(text, "r.yaml", sink)
    return {each.code for each in sink.diagnostics}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_examples_have_the_error_and_no_other(page: Path) -> None:
    examples, mended = blocks(page)
    expected = {page.stem} if page.stem.startswith("yaml-") and page.stem != "yaml-too-large" else set()
    assert [codes(text) for text in examples] == [expected] * len(examples)
    assert [codes(text) for text in mended] == [set()] * len(mended)


def test_most_yaml_pages_have_an_example_in_yaml() -> None:
    assert sum(bool(blocks(page)[0]) for page in PAGES if page.stem.startswith("yaml-")) >= 10

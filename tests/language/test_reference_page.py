from __future__ import annotations

import re
from pathlib import Path

from mjcompose.language.recipe import Recipe
from mjcompose.language.reference_page import page, text
from mjcompose.model.grammar import GRAMMAR
from mjcompose.text import key_order

FILE = Path(key_order.__file__).with_name("key_order.json")


def test_the_file_is_what_the_language_says() -> None:
    """`make schemas` writes it anew."""
    assert FILE.read_text(encoding="utf-8") == text()


def test_each_path_is_found() -> None:
    assert key_order.WHOLE[()][0] == "recipe" and key_order.WHOLE["attach", "*", "edit", "*"][1] == "select"
    assert key_order.FIRST["add", "*"] == ("id", "to")


REFERENCE_PAGE_FILE = Path(__file__).resolve().parents[2] / "docs" / "reference.md"


def test_is_current() -> None:
    assert REFERENCE_PAGE_FILE.read_text(encoding="utf-8") == page(), "run `make schemas`"


def test_every_key_of_the_models_has_a_row() -> None:
    rows = set(re.findall(r"^\| \**`([^`]+)`\** \|", page(), re.MULTILINE))
    assert rows >= set(Recipe.model_fields)
    assert rows >= {
        "attach.PREFIX.mate",
        "base.keys",
        "check.NAME.exists",
        "randomize.fields.FIELD",
        "rename",
    }


def test_a_row_has_type_default_and_meaning() -> None:
    text = page()
    assert "| `option.timestep` | number | `0.002` | timestep, s |" in text
    assert "| `conflict` | `error`, `base`, `mujoco` | `error` |" in text
    assert (
        "| **`attach.PREFIX.model`** | text or any of the [top-level keys](#top-level-keys) |  | A model reference"
        in text
    )


def test_every_element_is_there() -> None:
    text = page()
    for section in ("actuator", "sensor", "equality", "tendon", "asset", "contact"):
        for kind in GRAMMAR.section(section).children.values():
            assert f"[`{kind.path}`]" in text


def test_every_link_inside_leads_to_a_chapter() -> None:
    text = page()
    chapters = {
        re.sub(r"[^a-z -]", "", title.lower()).replace(" ", "-")
        for title in re.findall("^#+ (.*)$", text, re.MULTILINE)
    }
    assert set(re.findall(r"\]\(#([^)]*)\)", text)) <= chapters

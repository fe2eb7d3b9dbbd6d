from __future__ import annotations

import re
from pathlib import Path

from mjcompose.language.recipe import Recipe
from mjcompose.language.reference_page import page, pages, text
from mjcompose.text import key_order
from mjcompose.tree.grammar import GRAMMAR

FILE = Path(key_order.__file__).with_name("key_order.json")


def test_the_file_is_what_the_language_says() -> None:
    """`make schemas` writes it anew."""
    assert FILE.read_text(encoding="utf-8") == text()


def test_each_path_is_found() -> None:
    assert key_order.WHOLE[()][0] == "recipe" and key_order.WHOLE["attach", "*", "edit", "*"][1] == "select"
    assert key_order.FIRST["add", "*"] == ("id", "to")


REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "keys"
OF_MJCF = re.compile(r"^## (?:Elements of MJCF|Sections of MJCF|Attributes of )", re.MULTILINE)
ROW = re.compile(r"^\| \[?\**`([^`]+)`\**", re.MULTILINE)


def test_is_current() -> None:
    found = {path.name: path.read_text(encoding="utf-8") for path in REFERENCE.glob("*.md")}
    assert found == pages(), "run `make schemas`"


def test_the_language_is_small_enough_to_read() -> None:
    """MJCF's own elements and attributes do not count."""
    own = [OF_MJCF.split(each)[0] for name, each in pages().items() if name != "model_references.md"]
    assert sum(len(ROW.findall(each)) for each in own) <= 348


def test_every_key_of_the_models_has_a_row() -> None:
    rows = {name: set(ROW.findall(each)) for name, each in pages().items()}
    assert rows["index.md"] >= set(Recipe.model_fields)
    assert rows["attach.md"] >= {"mate", "keys"} and "| text or [part](attach.md) |" in pages()["index.md"]
    assert rows["randomize.md"] >= {"fields.FIELD", "param"} and rows["edit.md"] >= {"rename", "parent"}


def test_a_row_has_type_default_and_meaning() -> None:
    text = page()
    assert "| `timestep` | number | `0.002` | timestep, s |" in text
    assert "| `conflict` | `error`, `base`, `mujoco` | `error` |" in text
    assert "| **`model`** | text or any of the [top-level keys](index.md) |  | A model reference" in text


def test_every_element_is_there() -> None:
    text = page()
    for section in ("actuator", "sensor", "equality", "tendon", "asset", "contact"):
        for kind in GRAMMAR.section(section).children.values():
            assert f"[`{kind.path}`]" in text


def test_every_link_inside_leads_to_a_page() -> None:
    found = pages()
    for target, anchor in re.findall(r"\]\((\w+\.md)(?:#([^)]*))?\)", page()):
        assert not anchor or re.search(rf"^## {anchor}$", found[target], re.MULTILINE | re.IGNORECASE)

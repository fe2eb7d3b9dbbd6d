from __future__ import annotations

from pathlib import Path

from composer.formatting import order
from composer.recipe.key_order import text

FILE = Path(order.__file__).with_name("key_order.json")


def test_the_file_is_what_the_language_says() -> None:
    """`make schemas` writes it anew."""
    assert FILE.read_text(encoding="utf-8") == text()


def test_each_path_is_found() -> None:
    assert order.WHOLE[()][0] == "recipe" and order.WHOLE["attach", "*", "edit", "*"][1] == "select"
    assert order.FIRST["add", "*"] == ("id", "to")

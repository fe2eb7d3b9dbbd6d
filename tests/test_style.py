"""The style of the code, where a rule is mechanical. Contracts of imports are in `test_contracts.py`."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CODE = "composer/mjcompose/"
FOLDERS = ("composer", "tests", "bench", "recipes", ".ci")

TABLES = {
    "composer/mjcompose/base/sandbox.py": 1,
    "composer/mjcompose/language/element_schema.py": 1,
    "composer/mjcompose/language/value.py": 1,
    "composer/mjcompose/link/link.py": 1,
    "composer/mjcompose/mujoco/addresses.py": 1,
    "composer/mjcompose/mujoco/arrays.py": 1,
    "composer/mjcompose/mujoco/attributes.py": 2,
    "composer/mjcompose/sources/license.py": 1,
    "composer/mjcompose/targets/read_back.py": 1,
    "composer/mjcompose/text/expression.py": 1,
    "composer/mjcompose/text/faults.py": 1,
    "composer/mjcompose/tools/migrate/changes.py": 1,
    "composer/mjcompose/tools/open/decoder.py": 2,
    "composer/mjcompose/tree/values.py": 1,
    "composer/mjcompose/tree/xml_faults.py": 1,
    "tests/cli/test_files_that_are_none.py": 1,
    "tests/cli/test_main.py": 1,
    "tests/compose/test_compiler.py": 1,
    "tests/compose/verbs/test_convert.py": 1,
    "tests/fuzz/targets/quantity.py": 1,
    "tests/fuzz/targets/serving.py": 1,
    "tests/kills/project.py": 1,
    "tests/lint/test_cases.py": 1,
    "tests/lint/test_contact.py": 1,
    "tests/lint/test_portable.py": 1,
    "tests/lint/test_units.py": 1,
    "tests/targets/refused.py": 2,
    "tests/tools/diff/test_breaking.py": 1,
    "tests/tools/importing/test_changes.py": 1,
    "tests/tools/importing/test_folding.py": 1,
    "tests/tools/migrate/features.py": 1,
    "tests/tools/view/test_silhouettes.py": 1,
    "tests/trace/test_effective.py": 1,
}
"""Tables whose rows are read one below the other, by file: the formatter would put each value on a line of its own."""
MOST_TABLES = 20
"""The most tables of the package itself."""

SHARED_NAMES: dict[str, str] = {
    "Struct": "`base.dataclass` declares it twice: once for type checkers, and once for Python",
}
"""Public class names that several classes have, each with the reason."""


def is_swap(targets: list[ast.expr], values: list[ast.expr]) -> bool:
    """Return whether two statements would have another effect: a value is read after its target is written."""
    for number, target in enumerate(targets):
        written = ast.unparse(target)
        later = [ast.unparse(node) for value in values[number + 1 :] for node in ast.walk(value)]
        if written in later:
            return True
    return False


def is_packed(node: ast.AST) -> bool:
    """Return whether a node is an assignment such as `a, b = x, y`, except a swap, in which the order matters."""
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Tuple):
        return False
    targets = node.targets[0]
    return isinstance(targets, ast.Tuple) and not is_swap(targets.elts, node.value.elts)


def is_loop_over_a_choice(node: ast.AST) -> bool:
    """Return whether a node is a loop such as `for x in (a if c else b):`."""
    return isinstance(node, ast.For | ast.AsyncFor) and isinstance(node.iter, ast.IfExp)


def unformatted(text: str) -> list[str]:
    """Return the lines that switch the formatter off. The pattern is in pieces, or this line would be one."""
    return [line.strip() for line in text.splitlines() if re.search(r"#\s*fmt" + r":\s*(skip|off)", line)]


class Style:
    """The places that the rules are about, in one walk through each file: the trees of all files are large."""

    def __init__(self, texts: Iterable[tuple[str, str]]) -> None:
        self.packed: list[str] = []
        self.choices: list[str] = []
        self.unformatted: dict[str, list[str]] = {}
        self.classes: dict[str, list[str]] = defaultdict(list)
        for path, text in texts:
            if marks := unformatted(text):
                self.unformatted[path] = marks
            for node in ast.walk(ast.parse(text)):
                self._note(path, node)

    def _note(self, path: str, node: ast.AST) -> None:
        if is_packed(node):
            self.packed.append(f"{path}:{node.lineno}")
        elif is_loop_over_a_choice(node):
            self.choices.append(f"{path}:{node.lineno}")
        elif isinstance(node, ast.ClassDef) and path.startswith(CODE) and not node.name.startswith("_"):
            self.classes[node.name].append(f"{path}:{node.lineno}")

    def shared_names(self) -> dict[str, list[str]]:
        """Return the places of each public class name that several classes have."""
        return {name: places for name, places in self.classes.items() if len(places) > 1}


@pytest.fixture(scope="module")
def style() -> Style:
    files = [file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*.py"))]
    return Style((file.relative_to(ROOT).as_posix(), file.read_text(encoding="utf-8")) for file in files)


def test_one_assignment_a_line(style: Style) -> None:
    assert not style.packed, "write one assignment a line; only a swap needs both at once"


def test_a_loop_has_one_iterable(style: Style) -> None:
    assert not style.choices, "name the iterable above the loop, or put the loop below an `if`"


def test_only_tables_have_a_layout_of_their_own(style: Style) -> None:
    counts = {path: len(marks) for path, marks in style.unformatted.items()}
    assert counts == TABLES, "let the formatter decide; for a real table, add the file here"
    wrong = [
        (path, mark) for path, marks in style.unformatted.items() for mark in marks if not re.match(r"[\])}]+ ", mark)
    ]
    assert not wrong, "the mark belongs to the last line of a table"
    assert sum(count for path, count in counts.items() if path.startswith(CODE)) <= MOST_TABLES


def test_a_public_class_name_means_one_class(style: Style) -> None:
    shared = style.shared_names()
    assert set(shared) == set(SHARED_NAMES), f"give each class a noun of its own: {shared}"


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("a, b = 1, 2", ["a.py:1"]),
        ("x = 0\nself.a, self.b = f(), g()", ["a.py:2"]),
        ("a, b = b, 1", ["a.py:1"]),  # two statements in this order do the same
        ("a, b = pair()", []),
        ("a, b = b, a", []),
        ("a, b = a + b, a - b", []),
        ("rows[i], rows[j] = rows[j], rows[i]", []),
    ],
)
def test_how_a_packed_assignment_is_found(text: str, places: list[str]) -> None:
    assert Style([("a.py", text)]).packed == places


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("for x in a if c else b:\n    pass", ["a.py:1"]),
        ("if c:\n    for x in (a if c else ()):\n        pass", ["a.py:2"]),
        ("for x in a:\n    pass", []),
        ("for x in (y if y else 0 for y in a):\n    pass", []),
    ],
)
def test_how_a_loop_over_a_choice_is_found(text: str, places: list[str]) -> None:
    assert Style([("a.py", text)]).choices == places


@pytest.mark.parametrize("word", ["skip", "off"])
def test_how_a_mark_for_the_formatter_is_found(word: str) -> None:
    mark = ")  # fmt" + f": {word}"
    assert unformatted(f"TABLE = (\n    1,   2,\n{mark}\n") == [mark]


def test_how_a_name_of_several_classes_is_found() -> None:
    files = {
        f"{CODE}a.py": "class Part: ...",
        f"{CODE}b.py": "def f():\n    class Part: ...",
        f"{CODE}c.py": "class _Part: ...",
        "tests/test_a.py": "class Part: ...",
    }
    assert Style(files.items()).shared_names() == {"Part": [f"{CODE}a.py:1", f"{CODE}b.py:2"]}

"""A package names only packages below it, in strings, too: import-linter reads imports alone."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "composer" / "mjcompose"
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
LAYERS = [re.split(r" [|:] ", layer) for contract in CONTRACTS for layer in contract.get("layers", ())]
FLOOR = {name: -number for number, names in enumerate(LAYERS) for name in names}

TABLES = {"homes.py"}
"""Modules that are only a table of modules, as entry points are."""


def _docstrings(tree: ast.Module) -> set[int]:
    holders = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    bodies = [node.body for node in ast.walk(tree) if isinstance(node, holders) and node.body]
    return {id(body[0].value) for body in bodies if isinstance(body[0], ast.Expr)}


def named_modules(text: str) -> Iterator[str]:
    """Yield the strings of a program that are the address of a module, or of a name in it."""
    tree = ast.parse(text)
    docstrings = _docstrings(tree)
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or id(node) in docstrings:
            continue
        if re.fullmatch(r"mjcompose\.[\w.]+(:\w+)?", str(node.value)):
            yield str(node.value)


def goes_up(path: str, module: str) -> bool:
    """Return whether a file names a package that is not below its own."""
    own = path.split("/")[0].removesuffix(".py")
    other = re.split(r"[.:]", module)[1]
    if own == other or other not in FLOOR or own not in FLOOR:  # `mjcompose.verbs` is a group of entry points
        return False
    return FLOOR[other] >= FLOOR[own]


def test_no_string_names_a_module_above() -> None:
    found = [
        (path, module)
        for file in sorted(PACKAGE.rglob("*.py"))
        if (path := file.relative_to(PACKAGE).as_posix()) not in TABLES
        for module in named_modules(file.read_text(encoding="utf-8"))
        if goes_up(path, module)
    ]
    assert not found


@pytest.mark.parametrize(
    ("path", "text", "is_found"),
    [
        ("language/check.py", 'MODULES = {"expect": "mjcompose.verify.checks.expect"}', True),
        ("link/link.py", 'Lazy("mjcompose.urdf.read:UrdfReader")', True),  # beside it
        ("verify/draws.py", 'Lazy("mjcompose.language.check:Check")', False),
        ("language/check.py", '"""Read by mjcompose.verify."""', False),
    ],
)
def test_how_such_a_string_is_found(path: str, text: str, is_found: bool) -> None:
    assert any(goes_up(path, module) for module in named_modules(text)) == is_found


def test_no_contract_has_exceptions() -> None:
    assert len(CONTRACTS) >= 9
    assert not [contract["id"] for contract in CONTRACTS if "ignore_imports" in contract]
    floors = [contract for contract in CONTRACTS if contract["type"] == "layers"]
    assert [contract.get("exhaustive") for contract in floors] == [True]

"""Completion of model references: files beside the recipe, models of MuJoCo Menagerie, and packages."""

from __future__ import annotations

import os
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from composer.lsp.answers import Item
from composer.lsp.question import Question
from composer.sources.kinds import KINDS
from composer.sources.source import FORMATS
from composer.sources.suggest import model_files

_MENAGERIE = "menagerie:"
_SCHEMES = tuple(form for kind in KINDS for form in kind.forms)


def takes_reference(path: tuple[str | int, ...]) -> bool:
    """Return whether the value at a path is a model reference."""
    return path == ("extends",) or path == ("base",) or (len(path) > 1 and path[-1] == "model")


def offer(question: Question) -> Iterator[Item]:
    """Yield the continuations of the reference at the cursor."""
    cursor = question.cursor
    if cursor.role not in ("value", "either") or not takes_reference(cursor.path):
        return
    only_recipes = cursor.path == ("extends",)
    if cursor.word.startswith(_MENAGERIE) and not only_recipes:
        yield from _robots(cursor.word)
        return
    folder = question.analysis.path.parent
    for at, reference in enumerate(_files(folder, cursor.word)):
        kind = FORMATS[Path(reference).suffix.lower()]
        if (not only_recipes or kind == "recipe") and reference != f"./{question.analysis.path.name}":
            yield Item(reference, "file", kind if kind == "recipe" else kind.upper(), rank=10 + at / 1000)
    for form in _SCHEMES:
        scheme = form.scheme
        if scheme and not only_recipes:
            yield Item(f"{scheme}:", "scheme", form.example, form.meaning, 30, again=scheme == "menagerie")


def _files(folder: Path, word: str) -> Iterator[str]:
    """Yield the model files below the recipe's folder, or below the folder that the text so far leads to."""
    if word.startswith("../"):
        above = word.rpartition("/")[0]
        yield from (f"{above}/{each}" for each in model_files(Path(os.path.normpath(folder / above))))
    else:
        yield from (f"./{each}" for each in model_files(folder))


def _robots(word: str) -> Iterator[Item]:
    try:
        library: Any = import_module("mujoco_menagerie")
    except ImportError:
        return
    name, slash, _ = word.removeprefix(_MENAGERIE).partition("/")
    robots: list[str] = library.names()
    if slash and name in robots:
        robot = library.get(name)
        for entry in robot.entry_points:
            usual = entry.name == robot.default_model
            yield Item(f"{_MENAGERIE}{name}/{entry.name}", "model", "the robot's own model" if usual else "",
                       rank=5 if usual else 10)  # fmt: skip
        return
    for robot_name in robots:
        yield Item(f"{_MENAGERIE}{robot_name}", "model", "MuJoCo Menagerie", rank=10)

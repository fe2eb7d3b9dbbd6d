"""The words below fields and classes of models, read from their source: they are there without docstrings, too."""

from __future__ import annotations

import ast
import inspect
import sys
from functools import cache
from itertools import pairwise


def texts_below(model: type) -> dict[str, str]:
    """Return the text below each field of a class, by the name of the field."""
    declared = _declaration(model)
    return {
        field.target.id: inspect.cleandoc(text.value.value)
        for field, text in pairwise([] if declared is None else declared.body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }


def text_of(model: type) -> str:
    """Return the docstring of a class, also under `python -OO`. A made class has the text of its base."""
    declared = _declaration(model)
    if declared is not None:
        return ast.get_docstring(declared) or ""
    return text_of(model.__bases__[0]) if model.__bases__[0] is not object else ""


def _declaration(model: type) -> ast.ClassDef | None:
    """Return the class in the source of its module, or None if a function made it."""
    if model.__module__ not in sys.modules:
        return None
    classes = (each for each in ast.walk(_syntax_tree(model.__module__)) if isinstance(each, ast.ClassDef))
    return next((each for each in classes if each.name == model.__name__), None)


@cache
def _syntax_tree(module: str) -> ast.Module:
    return ast.parse(inspect.getsource(sys.modules[module]))

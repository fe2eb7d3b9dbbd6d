"""No function has more than six parameters, and none is called with more than three arguments by position.

What is left is written here, by name, and may only shrink. Callbacks of Click take as many as a command has options;
what libraries define is called as they want it.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1] / "composer"
MOST_PARAMETERS, MOST_BY_POSITION = 6, 3
Function = ast.FunctionDef | ast.AsyncFunctionDef

FUNCTIONS_LEFT = Counter(
    """
    Correspondence Workshop _give _given between check_fragment compare compile
    convert_urdf diff element error load load_cell parse_text render render_sheet unknown unknown_attribute
    unknown_name unresolved warning
    """.split()
)
# fmt: off
CALLS_LEFT = Counter(
    ActuatorModel=1, Converter=1, Diagnostic=1, Document=1, Item=1, Key=1, Known=1, Lens=2, Model=1, Names=1,
    Selection=1, Selector=1, Settable=2, Traced=1, Use=2, _Download=1, _Frame=1, _about=1, _analysed=1,
    _angles=1, _apart=1, _composed=1, _count=1, _error=4, _in_recipe=2, _insert=4, _line=1,
    _rename_parameter=1, _rename_part=1, _span=1, _up_to_the_next=1, _where=1, add=2, added_key=2, carried=1,
    check=1, drop=4, element=11, failed=11, fetch=2, finish=1, in_brackets=2, items=1, listed=1, names_of=1,
    open=1, pack=5, read_selector=2, rename=1, row=1, step=1, syscall=3, unknown=1, unknown_attribute=1,
    unread_in=1, with_item=1, with_key=1, word=3, write_whole=1,
)
# fmt: on


@cache
def _left() -> tuple[Counter[str], Counter[str]]:
    paths = sorted(path for path in ROOT.rglob("*.py") if "node_modules" not in path.parts)
    assert len(paths) > 100
    return _look(path.read_text(encoding="utf-8") for path in paths)


def _look(texts: Iterable[str]) -> tuple[Counter[str], Counter[str]]:
    """Return the functions with too many parameters, and the functions of ours that calls give too many by position."""
    ours: set[str] = set()
    functions, calls = Counter[str](), Counter[str]()
    for text in texts:
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef):
                ours.add(node.name)
                for each in node.body:
                    if isinstance(each, Function) and each.name == "__init__" and _is_long(each):
                        functions[node.name] += 1
            elif isinstance(node, Function):
                ours.add(node.name)
                functions[node.name] += node.name != "__init__" and _is_long(node)
            elif isinstance(node, ast.Call) and _by_position(node) > MOST_BY_POSITION:
                calls[node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)] += 1
    return +functions, Counter({name: count for name, count in calls.items() if name in ours})


def _by_position(call: ast.Call) -> int:
    return sum(not isinstance(each, ast.Starred) for each in call.args)


def _is_long(function: Function) -> bool:
    given = function.args
    names = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"])) > MOST_PARAMETERS


def test_no_function_has_more_than_six_parameters() -> None:
    assert _left()[0] == FUNCTIONS_LEFT, "split the function, or take one that is mended off the list"


def test_no_function_is_called_with_more_than_three_arguments_by_position() -> None:
    assert _left()[1] == CALLS_LEFT, "name the arguments, or take a call that is mended off the list"


def test_one_more_is_seen() -> None:
    text = "def f(self, a, b, c, d, e, f, *, g): f(1, 2, 3, 4)\ndef g(a): g(1, 2, 3, *a, b=4)\n"
    assert _look([text]) == ({"f": 1}, {"f": 1})

"""`link` and `compose` change models through the journal alone, so that `explain` knows every change."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import mjcompose
import pytest

ROOT = Path(mjcompose.__file__).parent
MODULES = sorted(path for room in ("link", "compose") for path in (ROOT / room).rglob("*.py"))
# Functions that write copies and other trees that are no part of a model.
SCRATCH = {
    "link/excerpt": {"root", "_shell", "_reduced", "_path"},
    "link/measure": {"strip", "_alone", "compile_unaligned", "_mark"},
    "link/unit_keys": {"bare_model", "_default", "_worldbody", "_tree", "_tendon", "_actuators", "_actuator", "_name"},
}
_ON_ELEMENTS = {"set", "append", "insert", "extend", "remove", "replace", "addnext", "addprevious", "clear"}
_ON_ATTRIBUTES = {"pop", "update", "clear", "setdefault", "popitem"}
_COLLECTIONS = {"list", "dict", "set", "defaultdict", "deque", "Counter", "sorted"}


def raw_writes(tree: ast.Module) -> Iterator[tuple[str, int]]:
    """Yield the function and the line of each statement that changes an element, or may change one."""
    holders: list[ast.Module | ast.ClassDef] = [tree]
    holders += (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    for function in (node for holder in holders for node in holder.body if isinstance(node, ast.FunctionDef)):
        known = _collections_in(function)
        for node in ast.walk(function):
            if _changes(node, known):
                yield function.name, node.lineno  # type: ignore[attr-defined]  # only statements and calls


def _changes(node: ast.AST, known: set[str]) -> bool:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        receiver = node.func.value
        if isinstance(receiver, ast.Attribute) and receiver.attr == "attrib":
            return node.func.attr in _ON_ATTRIBUTES
        texts = (
            any(isinstance(each, ast.Constant | ast.JoinedStr) for each in node.args) and node.func.attr == "replace"
        )
        if texts or ast.unparse(receiver) in ("journal", "etree") or ast.unparse(receiver).endswith("sink"):
            return node.func.attr == "SubElement"
        if node.func.attr == "insert" and len(node.args) == 1:  # of a unit
            return False
        return node.func.attr in _ON_ELEMENTS and not (_names_collection(receiver, known) or _is_collection(receiver))
    targets = node.targets if isinstance(node, ast.Assign | ast.Delete) else []
    return any(_is_of_element(each, known) for each in targets)


def _is_of_element(target: ast.expr, known: set[str]) -> bool:
    """Return whether a target of an assignment or of `del` is an attribute, the tag or children of an element."""
    if isinstance(target, ast.Subscript) and isinstance(target.slice, ast.Slice | ast.Constant | ast.UnaryOp):
        is_number = isinstance(target.slice, ast.Slice) or not isinstance(getattr(target.slice, "value", 0), str)
        if is_number and not (_names_collection(target.value, known) or _is_collection(target.value)):
            return True
    written = target.value if isinstance(target, ast.Subscript) else target
    is_own = isinstance(written, ast.Attribute) and ast.unparse(written.value) == "self"
    return isinstance(written, ast.Attribute) and not is_own and written.attr in ("attrib", "tag", "tail")


def _names_collection(receiver: ast.expr, known: set[str]) -> bool:
    if isinstance(receiver, ast.IfExp):
        return all(_names_collection(each, known) for each in (receiver.body, receiver.orelse))
    value = receiver.value if isinstance(receiver, ast.Subscript) else receiver
    return ast.unparse(value) in known


def _collections_in(function: ast.FunctionDef) -> set[str]:
    """Return the names that are bound to lists, sets and dictionaries."""
    found = {
        each.arg
        for each in (*function.args.args, *function.args.kwonlyargs)
        if each.annotation is not None and _is_type(each.annotation)
    }
    for node in ast.walk(function):
        if isinstance(node, ast.AnnAssign) and _is_type(node.annotation):
            found.add(ast.unparse(node.target))
        if isinstance(node, ast.Assign | ast.NamedExpr) and _is_collection(node.value):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {ast.unparse(each) for each in targets}
    return found


def _is_type(annotation: ast.expr) -> bool:
    return ast.unparse(annotation).partition("[")[0] in _COLLECTIONS


def _is_collection(value: ast.expr) -> bool:
    if isinstance(value, ast.Call):
        called = ast.unparse(value.func)
        return called.partition("[")[0] in _COLLECTIONS or called.endswith(".setdefault")
    if isinstance(value, ast.Attribute | ast.Subscript):
        base = value.value if isinstance(value, ast.Subscript) else value
        return isinstance(base, ast.Attribute) and (base.attr == "sink" or base.attr in _fields())
    return isinstance(value, ast.List | ast.Set | ast.Dict | ast.ListComp | ast.SetComp | ast.DictComp | ast.BinOp)


@cache
def _fields() -> set[str]:
    """Return the attributes of the composer's classes that are lists, sets or dictionaries."""
    found: set[str] = set()
    for path in (*MODULES, ROOT / "tree/unit.py", ROOT / "base/sink.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.AnnAssign) and _is_type(node.annotation):
                found.add(ast.unparse(node.target).rpartition(".")[2])
    return found


@pytest.mark.parametrize("module", MODULES, ids=lambda path: path.relative_to(ROOT).with_suffix("").as_posix())
def test_elements_are_changed_through_the_journal(module: Path) -> None:
    scratch = SCRATCH.get(module.relative_to(ROOT).with_suffix("").as_posix(), set())
    found = [each for each in raw_writes(ast.parse(module.read_text(encoding="utf-8"))) if each[0] not in scratch]
    assert found == [], "write through `mjcompose.tree.journal`"


@pytest.mark.parametrize(
    "statement",
    [
        'node.set("pos", "0 0 0")',
        'node.attrib["pos"] = "0 0 0"',
        'node.attrib.pop("pos", "")',
        'del node.attrib["pos"]',
        "node.attrib.clear()",
        "node.attrib.update(texts)",
        'node.tag = "frame"',
        "holder.append(node)",
        "holder.insert(0, node)",
        "holder.extend(nodes)",
        "holder.remove(node)",
        "holder.replace(old, new)",
        'etree.SubElement(holder, "geom")',
        "self.parent.append(node)",
        'linking.base.section("asset").append(node)',
        "del holder[0]",
        "holder[:] = nodes",
        "old.addnext(new)",
    ],
)
def test_a_raw_write_is_found(statement: str) -> None:
    assert list(raw_writes(ast.parse(f"def write(node, nodes, holder, old, new, texts):\n    {statement}")))


@pytest.mark.parametrize(
    "statement",
    [
        'found = []; found.append("a")',
        "linking.files.append(use)",
        'text = name.replace("a", "b")',
        "sink.extend(aside.errors)",
        "journal.remove(node)",
        "unit.insert(section)",
        'known = {}; known["a"] = node; del known["a"]',
        "given[name] = text",
        "found = [1]; found[:] = [2]",
    ],
)
def test_what_changes_no_element_is_none(statement: str) -> None:
    assert not list(raw_writes(ast.parse(f"def write(node, name, text, given: dict[str, str]):\n    {statement}")))

"""xacro in the child process: what it may calculate, what it may not, and where its faults are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from composer.urdf.expanding import Stopped, check_expression, expand

pytest.importorskip("xacro")
HEAD = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">\n'


def expanded(folder: Path, text: str, *, elements: int = 10_000, **arguments: str) -> dict[str, Any]:
    (folder / "r.xacro").write_text(f"{HEAD}{text}\n</robot>\n", encoding="utf-8")
    given = {
        "path": str(folder / "r.xacro"),
        "roots": [str(folder)],
        "sees_all": False,
        "packages": {"arm": str(folder)},
        "arguments": arguments,
        "elements": elements,
    }
    return expand(None, given)


@pytest.mark.parametrize(
    "expression",
    [
        "().__class__",
        "(x for x in [1]).gi_frame",
        "'{0.__class__}'.format(1)",
        "python.str.mro()",
        "[x._y for x in z]",
        "__import__('os')",
        "(lambda: 1).__globals__",
        "dict(__x__=1)",
    ],
)
def test_what_leads_out_of_a_value_is_refused(expression: str) -> None:
    with pytest.raises(Stopped):
        check_expression(expression)


@pytest.mark.parametrize(
    "text", ["${python.type('')}", "${python.vars(math)}", "$(eval ().__class__)", "${''.__doc__}"]
)
def test_no_way_to_a_class(tmp_path: Path, text: str) -> None:
    answer = expanded(tmp_path, f'<link name="{text}"/>')
    assert "text" not in answer


def test_values_are_calculated(tmp_path: Path) -> None:
    (tmp_path / "v.yaml").write_text("arm: {length: 0.4}\nturn: !degrees 90\n")
    answer = expanded(
        tmp_path,
        """<xacro:arg name="n" default="2"/><xacro:property name="v" value="${xacro.load_yaml('v.yaml')}"/>
        <link name="l${round(v.arm.length * int('$(arg n)') + sin(pi), 3)}" turn="${round(v.turn, 4)}"/>""",
    )
    assert 'name="l0.8"' in answer["text"] and 'turn="1.5708"' in answer["text"]
    assert [Path(each).name for each in answer["files"]] == ["r.xacro", "v.yaml"]


def test_every_element_keeps_its_place_through_macros_and_includes(tmp_path: Path) -> None:
    (tmp_path / "m.xacro").write_text(
        f'{HEAD}<xacro:macro name="pair" params="n">\n  <link name="${{n}}_a"/>\n  <link name="${{n}}_b"/>\n</xacro:macro></robot>'
    )
    answer = expanded(
        tmp_path, '<xacro:include filename="$(find arm)/m.xacro"/>\n<xacro:pair n="x"/><link name="own"/>'
    )
    files = [Path(each).name for each in answer["files"]]
    placed = [(files[file], line, column, tag) for file, line, column, tag in answer["places"]]
    assert placed[1:] == [("m.xacro", 3, 2, "link"), ("m.xacro", 4, 2, "link"), ("r.xacro", 3, 19, "link")]


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ('<link name="${1 / 0}"/>', "xacro", 2),
        ('<link/>\n<link name="${nothing}"/>', "property", 3),
        ("<link/>\n<xacro:nothing/>", "macro", 3),
        ('<xacro:macro name="m" params="a"><a/></xacro:macro>\n<xacro:m/>', "xacro", 3),
        ('<xacro:macro name="m" params="a"><a/></xacro:macro>\n<xacro:m a="1" b="2"/>', "xacro", 3),
        ('\n<xacro:include filename="no.xacro"/>', "file", 3),
        ('<link name="$(env HOME)"/>', "environment", 2),
        ('<link name="$(optenv HOME x)"/><link name="$(cwd)"/>', "environment", 2),
        ('<link name="$(find other)"/>', "package", 2),
        ('<link name="$(arg size)"/>', "argument", 2),
        ('<xacro:include filename="/etc/passwd"/>', "refused", 2),
        ('<xacro:include filename="/etc/passwd" optional="true"/>', "refused", 2),
        (
            '<xacro:property name="p" value="${xacro.load_yaml(\'/etc/passwd\')}"/><link name="${p}"/>',
            "refused",
            2,
        ),
        ('<xacro:macro name="m"><xacro:m/></xacro:macro>\n<xacro:m/>', "xacro", 2),
        ('<xacro:macro name="m"><a/><xacro:m/><xacro:m/></xacro:macro>\n<xacro:m/>', "limit", 2),
        ("<link", "syntax", 3),
    ],
)
def test_a_fault_has_its_line(tmp_path: Path, text: str, code: str, line: int) -> None:
    answer = expanded(tmp_path, text, elements=300 if code == "limit" else 100_000)
    assert answer["error"]["code"] == code, answer["error"]
    assert answer["error"]["at"][1] == line


def test_a_fault_in_a_macro_says_who_called_it(tmp_path: Path) -> None:
    answer = expanded(tmp_path, '<xacro:macro name="m">\n<link name="${no}"/></xacro:macro>\n<xacro:m/>')
    assert answer["error"]["at"][1] == 3
    assert [each[1] for each in answer["error"]["calls"]] == [4]


def test_entities_are_refused(tmp_path: Path) -> None:
    (tmp_path / "d.xacro").write_text('<!DOCTYPE r [<!ENTITY a "b">]>\n<robot>&a;</robot>')
    assert expanded(tmp_path, '<xacro:include filename="d.xacro"/>')["error"]["code"] == "unsafe"


def test_xacro_is_as_before(tmp_path: Path) -> None:
    import xacro

    before = dict(vars(xacro))
    expanded(tmp_path, '<link name="${no}"/>')
    assert {name: vars(xacro)[name] for name in ("safe_eval", "eval_all", "parse", "warning")} == {
        name: before[name] for name in ("safe_eval", "eval_all", "parse", "warning")
    }
    assert "open" not in vars(xacro) and "type" in xacro._global_symbols["python"]


def test_an_argument_that_nobody_asks_for(tmp_path: Path) -> None:
    answer = expanded(tmp_path, '<xacro:arg name="size" default="1"/><link name="a"/>', siz="2")
    assert answer["unused"] == ["siz"] and answer["arguments"] == ["size"]

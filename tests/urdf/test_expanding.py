"""xacro in the child process: what it may calculate, what it may not, and where its faults are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mjcompose.urdf import expanding
from mjcompose.urdf.expanding import expand

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
    return expand(given)


@pytest.mark.parametrize(
    "text",
    [
        "${python.type('')}",
        "${python.vars(math)}",
        "$(eval ().__class__)",
        "${''.__doc__}",
        "$(eval open('/etc/hostname').read())",
        "$(eval __import__('os').getcwd())",
        "${xacro.parent}",
        "$(eval (lambda: 1)())",
        "${" + "-" * 2949 + "1}",
    ],
    ids=range(9),
)
def test_no_way_to_python(tmp_path: Path, text: str) -> None:
    answer = expanded(tmp_path, f'<link name="{text}"/>')
    assert answer["error"]["code"] in ("unsafe", "xacro"), answer


def test_yaml_cannot_run_anything_either(tmp_path: Path) -> None:
    (tmp_path / "u.yaml").write_text("a: !degrees ().__class__\n")
    (tmp_path / "o.yaml").write_text("a: !!python/object/apply:os.getcwd []\n")
    for name in ("u", "o"):
        assert "error" in expanded(tmp_path, f"<link name=\"${{xacro.load_yaml('{name}.yaml').a}}\"/>")


def test_yaml_that_grows_is_stopped(tmp_path: Path) -> None:
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 10)]
    (tmp_path / "laughs.yaml").write_text("\n".join(lines))
    answer = expanded(tmp_path, "<link name=\"${xacro.load_yaml('laughs.yaml')}\"/>")
    assert answer["error"]["code"] == "costly"


@pytest.mark.parametrize("hook", [*expanding._HOOKS, *expanding._SUBSTITUTIONS])
def test_a_xacro_that_lacks_what_is_replaced_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hook: str
) -> None:
    monkeypatch.setattr(expanding, "_HOOKS" if hook in expanding._HOOKS else "_SUBSTITUTIONS", (f"no_{hook}",))
    assert expanded(tmp_path, "<link/>") == {"other": f"no_{hook}"}


def test_nothing_of_xacro_evaluates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a function of xacro is not replaced, its own finds no `eval`."""
    take_over = expanding._Work.take_over

    def forgets(self: Any, substitution: Any) -> None:
        kept = self.xacro.safe_eval, substitution._eval
        take_over(self, substitution)
        self.xacro.safe_eval, substitution._eval = kept

    monkeypatch.setattr(expanding._Work, "take_over", forgets)
    for text in ("${1 + 1}", "$(eval 1 + 1)"):
        assert expanded(tmp_path, f'<link name="{text}"/>')["error"]["code"] == "unsafe"


@pytest.mark.parametrize("error", [RecursionError, MemoryError, OSError, UnicodeError])
@pytest.mark.parametrize("guard", ["evaluated", "substituted", "read", "globbed", "found"])
def test_a_fault_in_a_guard_gives_no_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, guard: str, error: type[Exception]
) -> None:
    def fails(*_: Any) -> Any:
        raise error("inside")

    monkeypatch.setattr(expanding._Work, guard, fails)
    parts = '<a b="${1}"/><a b="$(eval 1)"/><a b="$(find arm)"/><xacro:include filename="*.nothing" optional="true"/>'
    assert "text" not in expanded(tmp_path, parts)


def test_texts_and_parameters_that_grow_are_stopped(tmp_path: Path) -> None:
    doubled = "".join(f'<xacro:property name="p{i}" value="${{p{i - 1}}}${{p{i - 1}}}"/>' for i in range(1, 40))
    for text in (
        f'<xacro:property name="p0" value="abcdefgh"/>{doubled}<link name="${{p39}}"/>',
        f'<link name="{"$" * 300_000}"/>',
        f"""<xacro:macro name="m" params="a={"x" * 60}'"/>""",
        f"""<xacro:macro name="m" params="a={"'b" * 61}"/>""",
    ):
        assert expanded(tmp_path, text)["error"]["code"] in ("costly", "unsafe")
    text = """<xacro:macro name="m" params="a:='x y' b:=${1 + 1} c:=^|it's'z"><a b="${a}${b}${c}"/></xacro:macro><xacro:m/>"""
    assert """b="x y2it's'z\"""" in expanded(tmp_path, text)["text"]


def test_a_namespace_has_its_properties_and_nothing_of_its_class(tmp_path: Path) -> None:
    (tmp_path / "n.xacro").write_text(
        f'{HEAD}<xacro:property name="x" value="4"/><xacro:property name="depth" value="5"/></robot>'
    )
    include = '<xacro:include filename="n.xacro" ns="n"/>'
    assert 'a="8"' in expanded(tmp_path, f'{include}<a a="${{n.x * 2}}"/>')["text"]
    for name in (
        "depth",
        "parent",
        "root",
        "top()",
        "update(x=1)",
        "unevaluated",
        "_resolve_('x')",
        "__class__",
        "keys()",
    ):
        answer = expanded(tmp_path, f'{include}<a a="${{n.{name}}}"/>')
        assert answer["error"]["code"] == "unsafe", name


def test_separators_are_no_regular_expression(tmp_path: Path) -> None:
    split = "<a a=\"${xacro.tokenize('1, 2;3', %s)}\"/>"
    assert "['1', '2', '3']" in expanded(tmp_path, split % "' ,;'")["text"]
    for separators in ("'a-z'", "'[)+('", "'^1'", "'\\\\d'", "']+|(.*)*|['"):
        assert expanded(tmp_path, split % separators)["error"]["code"] == "unsafe", separators


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2", "3"),
        ("arg('n') * 2", "5.0"),
        ("n * 2 if flag else 0", "5.0"),
        ("round(pi, 2)", "3.14"),
        ("find('arm')[:1]", "/"),
        ("'a' + name", "axy"),
        ("true and not false", "True"),
        ("optenv('HOME', 'none')", "none"),
        ("len(name) + sqrt(4)", "4.0"),
    ],
)
def test_substitutions_are_evaluated_too(tmp_path: Path, text: str, value: str) -> None:
    """The text of a property, for xacro ends `$(eval` at the first `)`."""
    parts = f'<xacro:property name="p" value="{text}"/><a b="$(eval ${{p}})"/>'
    answer = expanded(tmp_path, parts, n="2.5", flag="true", name="xy")
    assert f'b="{value}"' in answer["text"]


def test_names_are_those_of_python() -> None:
    import xacro

    for name in ("a", "_b1", "é", "ﬁ", "None", "pass", "match", "1a", "a b", "a.b", "", " a", "a\n", "(a)", "lambda"):
        assert expanding._is_name(name) == xacro.is_valid_name(name), name


CHANGES = [
    "${math.update(python.dict(pi=7))}",
    "${xacro.update(python.dict(q=1))}",
    "${python.clear()}",
    "${load_yaml('v.yaml').update(a=2)}",
    "${load_yaml('v.yaml').l.append(2)}",
    "${xacro.root.update(pi=7)}",
    "${[1].append(2)}",
]


def test_no_template_changes_another(tmp_path: Path) -> None:
    (tmp_path / "v.yaml").write_text("a: 1\nl: [1]\n")
    asks = '<link a="${pi} ${math.pi}" b="${load_yaml(\'v.yaml\').a}" c="${load_yaml(\'v.yaml\').l}" d="${sin(0)}"/>'
    alone = expanded(tmp_path, asks)["text"]
    redefines = '<xacro:property name="pi" value="7" scope="global"/><xacro:property name="sin" value="1"/><xacro:macro name="m"><a/></xacro:macro>'
    assert 'b="7"' in expanded(tmp_path, f'{redefines}<link b="${{pi}}"/>')["text"]
    for change in CHANGES:
        assert "error" in expanded(tmp_path, f'<link a="{change}"/>'), change
    assert expanded(tmp_path, asks)["text"] == alone
    assert expanded(tmp_path, "<xacro:m/>")["error"]["code"] == "macro"
    import xacro

    xacro.eval_text = xacro.Table = None  # what somebody else does to the module
    assert expanded(tmp_path, asks)["text"] == alone


def test_what_a_pattern_fits_is_asked_of_the_door_first(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "p1.xml").write_text("<robot><one/></robot>")
    (tmp_path / "p2.xml").write_text("<robot><two/></robot>")
    answer = expanded(tmp_path, '<xacro:include filename="*/p?.xml"/><xacro:include filename="p*.xml"/>')
    assert "<one/>" in answer["text"] and "<two/>" in answer["text"]
    for pattern in ("/etc/host*", "/etc/nothing-of-this-name*", "../*/r.xacro", "/*/hostname"):
        answer = expanded(tmp_path, f'<xacro:include filename="{pattern}" optional="true"/>')
        assert answer["error"]["code"] == "refused", pattern


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
        ('<xacro:property name="p" value="${xacro.load_yaml(\'/etc/passwd\')}"/><link name="${p}"/>', "refused", 2),
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
    expanded(tmp_path, '<link name="${no}"/>')
    import xacro

    assert xacro.safe_eval("1 + 1", {}) == 2 and "type" in xacro._global_symbols["python"]


def test_an_argument_that_nobody_asks_for(tmp_path: Path) -> None:
    answer = expanded(tmp_path, '<xacro:arg name="size" default="1"/><link name="a"/>', siz="2")
    assert answer["unused"] == ["siz"] and answer["arguments"] == ["size"]

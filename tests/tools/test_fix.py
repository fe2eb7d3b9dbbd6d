from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from cases import Case, cases
from mjcompose.base.diagnostic import Diagnostic, Fix, Severity, Span
from mjcompose.base.files import read_regular
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.sources.context import Context
from mjcompose.tools.fix import Fixed, Fixing, Judged, TextEdit, _Apart, applied, edit_of, exact, fix


def found(fix: Fix | None, span: Span | None) -> Diagnostic:
    return Diagnostic("unknown-name", "no", span, fix=fix)


def at(line: int, column: int, end: int | None = None, file: str = "a.yaml") -> Span:
    return Span(file, line, column, None if end is None else line, end)


@pytest.mark.parametrize(
    ("source", "span", "fix", "result"),
    [
        ("x: tpi\n", at(1, 4, 7), Fix("tip", "tpi"), "x: tip\n"),
        ("x: 'tpi'\n", at(1, 4, 9), Fix("tip", "tpi"), 'x: "tip"\n'),
        ("x: tpi\n", at(1, 4, 7), Fix("*tip", "tpi"), 'x: "*tip"\n'),
        ("é: 1\r\nx: tpi # c\r\n", at(2, 4, 7), Fix("tip", "tpi"), "é: 1\r\nx: tip # c\r\n"),
        ("x: 1 2\n", at(1, 4, 7), Fix("[1, 2]"), "x: [1, 2]\n"),
        ("x: [1, 2]\n", at(1, 4, 10), Fix("[1deg, 2]"), "x: [1deg, 2]\n"),
        ("# c\nx: 1\n", at(2, 1), Fix("recipe: 1\n"), "# c\nrecipe: 1\nx: 1\n"),
        ("x: 1\n", at(1, 1, 2), Fix("y", "x", at(1, 1, 2)), "y: 1\n"),
        ('<a b="tpi"/>', at(1, 7, 10, "a.xml"), Fix("a*", "tpi"), '<a b="a*"/>'),
    ],
)
def test_what_it_writes(source: str, span: Span, fix: Fix, result: str) -> None:
    edit = edit_of(found(fix, span), source)
    assert edit is not None and applied(source, [edit]) == result


@pytest.mark.parametrize(
    ("source", "span", "fix"),
    [
        ("x: other\n", at(1, 4, 9), Fix("tip", "tpi")),
        ("x: [1,\n  2]\n", at(1, 4, 7), Fix("[1, 2deg]")),
        ("x: tpi\n", at(3, 4, 7), Fix("tip", "tpi")),
        ("x: tpi\n", at(1, 4, 99), Fix("tip", "tpi")),
        ("x: tpi\n", Span("a.yaml", 1, 4, 2, 1), Fix("tip", "tpi")),
        ("x: tpi\n", None, Fix("tip", "tpi")),
        ("x: tpi\n", at(1, 4, 7), None),
        ("x: ${t}\n", at(1, 4, 8), Fix("10deg")),
        ("x: [${t}, 2]\n", at(1, 4, 13), Fix("[10deg, 2deg]")),
        ("x: |-\n  0.1 0.1\n", at(1, 4, 6), Fix("[0.1, 0.1]")),
        ('x: "0.1\n  0.1"\n', at(1, 4, 8), Fix("[0.1, 0.1]")),
        ("x: 0.1\n  0.1\ny: 1\n", at(1, 4, 7), Fix("[0.1, 0.1]")),
        ("{x: 1, y: 2}\n", at(1, 8, 9), Fix("x", "y")),
    ],
)
def test_what_does_not_fit_is_left(source: str, span: Span | None, fix: Fix | None) -> None:
    diagnostic = found(fix, span)
    assert edit_of(diagnostic, source) is None
    assert exact(diagnostic, source).fix is None


def test_exact_has_the_quotes() -> None:
    told = exact(found(Fix("**/tip", "tpi"), at(1, 4, 7)), "x: tpi\n")
    assert told.fix == Fix('"**/tip"', None, at(1, 4, 7))


def test_two_equal_edits_are_one() -> None:
    assert applied("ab", [TextEdit(0, 1, "x"), TextEdit(0, 1, "x")]) == "xb"


ERRORS = Path(__file__).resolve().parents[1] / "errors"
ARM = """<mujoco><worldbody><body name="base"><geom size="0.1"/><body name="link"><joint name="elbow" damping="1"/>
  <joint name="hip"/><geom name="rod" size="0.1"/><site name="tip"/></body></body></worldbody></mujoco>"""


def fixed(folder: Path, text: str | bytes, **others: str) -> tuple[str, Fixed]:
    """The text of the recipe afterwards; nothing is written."""
    (folder / "arm.xml").write_text(ARM)
    for name, content in others.items():
        (folder / f"{name}.yaml").write_text(content)
    recipe = folder / "recipe.yaml"
    source = text if isinstance(text, bytes) else text.encode()
    recipe.write_bytes(source)
    found = fix(recipe, Context(folder=folder))
    assert recipe.read_bytes() == source
    return found.files.get(recipe, (b"", source))[1].decode(), found


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("attatch: {a: {model: ./arm.xml}}", "attach: {a: {model: ./arm.xml}}"),
        ("keyframe: {up: {ctrl: hodl}}", "keyframe: {up: {ctrl: hold}}"),
        ("keyframe: {up: {ctrl: {hold: force}}}", "keyframe: {up: {ctrl: {hold: forces}}}"),
        ("attach: {a: {modle: ./arm.xml}}", "attach: {a: {model: ./arm.xml}}"),
        ("attach: {a: {model: ./arm.xml, site: tpi}}", "attach: {a: {model: ./arm.xml, site: tip}}"),
        ("edit: [{select: {jiont: elbow}, set: {damping: 1}}]", "edit: [{select: {joint: elbow}, set: {damping: 1}}]"),
        ("edit: [{select: {joint: elbw}, set: {damping: 1}}]", "edit: [{select: {joint: elbow}, set: {damping: 1}}]"),
        ("edit: [{select: {joint: elbow}, set: {dampin: 1}}]", "edit: [{select: {joint: elbow}, set: {damping: 1}}]"),
        ("edit: [{select: {joint: elbow}, sett: {damping: 1}}]", "edit: [{select: {joint: elbow}, set: {damping: 1}}]"),
        ("edit: [{select: {joint: **}, set: {damping: 1}}]", 'edit: [{select: {joint: "**"}, set: {damping: 1}}]'),
        (
            "edit: [{select: {joint: elbow}, set: {dampin: null}}]\n",
            "edit: [{select: {joint: elbow}, set: {damping: null}}]\n",
        ),
        ("add: [{to: link, geom: {size: 0.1 0.1}}]", "add: [{to: link, geom: {size: [0.1, 0.1]}}]"),
        ("add: [{to: link, geom: {size: ['0.1']}}]", "add: [{to: link, geom: {size: [0.1]}}]"),
        ("add: [{to: link, geom: {size: [10cm]}}]", "add: [{to: link, geom: {size: [0.1]}}]"),
        (
            "add: [{to: link, geom: {size: [0.1], euler: [0, 90, 0]}}]",
            "add: [{to: link, geom: {size: [0.1], euler: [0, 90deg, 0]}}]",
        ),
        (
            "add: [{to: link, geom: {size: [0.1], euler: [0, 1.57, 0.1]}}]",
            "add: [{to: link, geom: {size: [0.1], euler: [0, 1.57rad, 0.1rad]}}]",
        ),
        (
            "add: [{to: link, geom: {size: [0.1], tpye: sphere}}]",
            "add: [{to: link, geom: {size: [0.1], type: sphere}}]",
        ),
        (
            "add: [{to: link, geom: {size: [0.1], type: shpere}}]",
            "add: [{to: link, geom: {size: [0.1], type: sphere}}]",
        ),
        ("option: {flag: {gravity: off}}", "option: {flag: {gravity: disable}}"),
        ("sensor: {s: {typ: jointpos, joint: elbow}}", "sensor: {s: {type: jointpos, joint: elbow}}"),
        ("sensor: {s: {type: jointpso, joint: elbow}}", "sensor: {s: {type: jointpos, joint: elbow}}"),
        ("keyframe: {k: {qpos: {elbw: 0}}}", "keyframe: {k: {qpos: {elbow: 0}}}"),
        ("keyframe: {k: {qpoz: {elbow: 0}}}", "keyframe: {k: {qpos: {elbow: 0}}}"),
        ("check: {c: {expct: {attr: nq, equals: 2}}}", "check: {c: {expect: {attr: nq, equals: 2}}}"),
        ("check: {c: {expect: {attr: mass, rnge: [0, 99]}}}", "check: {c: {expect: {attr: mass, range: [0, 99]}}}"),
        ("params: {r: {defualt: 1}}", "params: {r: {default: 1}}"),
        (
            "params: {r: 1}\nadd: [{to: link, geom: {size: [${r}]}}]",
            'params: {r: 1}\nadd: [{to: link, geom: {size: ["${r}"]}}]',
        ),
    ],
)
def test_one_of_each(tmp_path: Path, wrong: str, right: str) -> None:
    head = "# what it is for\nrecipe: 1  # the version\nbase: ./arm.xml\n\n"
    text, found = fixed(tmp_path, head + wrong)
    assert text == head + right
    assert len(found.fixed) == 1 and not found.left


@pytest.mark.parametrize(
    "text",
    [
        "keyframe: {k: {qpos: {hipp: 0, hip: 0}}}",  # there already
        "sensor: {s: {type: jointpos, joint: tip}}",  # is a site
        "sensor: {s: {type: jointpos, joint: elpow_or_hipp}}",
        "add: [{to: link, geom: {size: [0.1], euler: [0, 1, 0]}}]",  # degrees or radians
        "nonsense: 1",
        "edit: [{select: {joint: '*'}, expect: 7, set: {damping: 1}}]",  # a decision
    ],
)
def test_what_nobody_can_tell_is_left(tmp_path: Path, text: str) -> None:
    text = f"recipe: 1\nbase: ./arm.xml\n{text}"
    after, found = fixed(tmp_path, text)
    assert after == text and not found.fixed and found.left


def test_several_rounds_and_what_remains(tmp_path: Path) -> None:
    text, found = fixed(tmp_path, "# robot\nbsae: ./arm.xml\nadd: [{to: lnk, geom: {sise: 0.1}}]\nnonsense: 1\n")
    assert text == "# robot\nrecipe: 1\nbase: ./arm.xml\nadd: [{to: link, geom: {size: 0.1}}]\nnonsense: 1\n"
    assert [each.code for each in found.left] == ["unknown-key"] and len(found.fixed) == 4


def test_the_faults_up_to_the_limit_are_fixed_and_then_the_others(tmp_path: Path) -> None:
    rows = "".join(f"  m{number}: {{type: motor, joint: j, geer: {number}}}\n" for number in range(7))
    body = '<body><joint name="j"/><geom size="1"/></body>'
    (tmp_path / "robot.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    with allow(faults=3):
        text, result = fixed(tmp_path, f"recipe: 1\nbase: ./robot.xml\nactuator:\n{rows}")
    assert text.count("gear:") == len(result.fixed) == 7
    assert not [each for each in result.left if each.severity is Severity.ERROR]


def test_changes_that_meet_are_found_among_their_neighbors() -> None:
    apart = _Apart()
    edits = [
        TextEdit(5, 9, "a"),
        TextEdit(0, 3, "b"),
        TextEdit(8, 12, "c"),
        TextEdit(3, 5, "d"),
        TextEdit(9, 9, "e"),
        TextEdit(5, 5, "f"),
    ]
    for edit in edits:
        apart.add(edit, found(None, None))
    kept = []
    for edit in edits:
        kept += [] if any(edit.meets(other) for other in kept) else [edit]
    assert list(apart.edits) == kept


def test_line_ends_and_a_byte_order_mark_stay(tmp_path: Path) -> None:
    _, found = fixed(tmp_path, b"\xef\xbb\xbfrecipe: 1\r\nbsae: ./arm.xml\r\n# \xc3\xa9\r\n")
    ((_, after),) = found.files.values()
    assert after == b"\xef\xbb\xbfrecipe: 1\r\nbase: ./arm.xml\r\n# \xc3\xa9\r\n"


def test_what_it_extends_and_nests_is_fixed_too(tmp_path: Path) -> None:
    text = "recipe: 1\nextends: ./lower.yaml\nattach: {b: {model: ./part.yaml, site: tpi}}\n"
    part = "recipe: 1\nbase: ./arm.xml\nsensor: {s: {type: touch, site: tpi}}\n"
    after, found = fixed(tmp_path, text, lower="base: ./arm.xml\noption: {timestpe: 0.001}\n", part=part)
    assert "site: tip" in after
    assert {path.name for path in found.files} == {"recipe.yaml", "lower.yaml", "part.yaml"}
    assert not found.left


def test_models_are_not_touched(tmp_path: Path) -> None:
    (tmp_path / "bad.xml").write_text(ARM.replace("</mujoco>", "</mujco>"))
    _, found = fixed(tmp_path, "recipe: 1\nbase: ./bad.xml\n")
    assert found.left and not found.files


@pytest.mark.parametrize("case", cases(ERRORS), ids=lambda case: case.id)
def test_every_wrong_recipe(case: Case, tmp_path: Path) -> None:
    """What is fixed is not found again, nothing else breaks, and there is nothing to fix the second time."""
    folder = case.lay(tmp_path / "case")
    found = fix(folder / "recipe.yaml", Context(folder=folder))
    for path, (_, after) in found.files.items():
        path.write_bytes(after)
    again = fix(folder / "recipe.yaml", Context(folder=folder))
    assert not again.files and [str(each) for each in again.left] == [str(each) for each in found.left]


@pytest.mark.parametrize("severity", [Severity.ERROR, Severity.WARNING])
def test_a_fix_that_breaks_a_model_is_reverted(tmp_path: Path, severity: Severity) -> None:
    (tmp_path / "a.xml").write_text("<a/>", encoding="utf-8")
    context = Context(sink=Sink(), folder=tmp_path)

    def look(context: Context) -> list[Diagnostic]:
        if read_regular(tmp_path / "a.xml") == b"<a/>":
            return [found(Fix("b", None, at(1, 2, 3, "a.xml")), at(1, 2, 3, "a.xml"))]
        return [Diagnostic("mujoco-rejects", "no", at(1, 1, file="a.xml"), severity=severity)]

    first = replace(look(context)[0], severity=Severity.WARNING)

    def judged(own: Context) -> list[Judged]:
        return [Judged(None, tuple(first if each.fix else each for each in look(own)))]

    fixing = Fixing(judged, context, (".xml",))
    assert bool(fixing.fixed().files) is (severity is Severity.WARNING)

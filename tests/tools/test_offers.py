"""Every fix that a message offers: it keeps templates, removes its fault in every model, and changes nothing else."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from cases import Case, cases
from mjcompose.base.diagnostic import Diagnostic, Severity
from mjcompose.base.sink import Sink
from mjcompose.language.validate import validate_what_remains
from mjcompose.pipeline.cache.cells import cells_of
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.tools.fix import Fixing, applied, edit_of, fix, models_of, place_of

TESTS = Path(__file__).resolve().parents[1]
TEMPLATE = re.compile(r"\$\{[^}]*\}")
Findings = dict[str, list[Diagnostic]]


def findings(folder: Path) -> Findings:
    """What a build says of the model with default values, and of each cell."""
    recipe = folder / "recipe.yaml"
    context = Context(environment={}, folder=folder)
    build(ModelRequest(recipe, verified=False), context)
    found = {"": context.sink.diagnostics}
    for cell in cells_of(recipe, Context(environment={}, folder=folder)):
        if cell.sample > 1:  # the samples read the same lines
            continue
        own = Context(environment={}, folder=folder)
        build(ModelRequest(recipe, cell.given, cell.name, sample=cell.sample, verified=False), own)
        found[cell.name] = own.sink.diagnostics
    return found


def offered(found: Findings, folder: Path) -> Iterator[tuple[Diagnostic, Path, str]]:
    """The fixes in the case's recipes, each with the text that it makes of a file."""
    for diagnostic in dict.fromkeys(each for model in found.values() for each in model):
        place = place_of(diagnostic)
        path = None if place is None else folder / place.file
        if path is None or path.suffix != ".yaml" or not path.is_file():
            continue
        source = path.read_bytes().decode("utf-8-sig", "replace")
        if (edit := edit_of(diagnostic, source)) is not None:
            yield diagnostic, path, applied(source, [edit])


def gone(diagnostic: Diagnostic, before: Findings, after: Findings) -> bool:
    """Whether no model has the fault anymore, and none has another error instead."""
    for model, found in after.items():
        known = [told(each) for each in before.get(model, before[""])]
        if [told(each) for each in found].count(told(diagnostic)) >= max(known.count(told(diagnostic)), 1):
            return False
        new = [each for each in found if told(each) not in known and each.severity is Severity.ERROR]
        if any(each.code.startswith("yaml-") or start(each) == start(diagnostic) for each in new):
            return False
    return True


def told(diagnostic: Diagnostic) -> tuple[str, str]:
    return diagnostic.code, diagnostic.message


def start(diagnostic: Diagnostic) -> object:
    span = diagnostic.span
    return None if span is None else (span.file, span.line, span.column)


SCATTERED = "attach/scatter_room"  # it searches for room for nine seconds
ADVISING = [
    each
    for each in cases(TESTS / "errors")
    if re.search("= help: (write|did you mean|quote)", each.expected) and each.id != SCATTERED
]


@pytest.mark.parametrize("case", ADVISING, ids=lambda case: case.id)
def test_every_offer_of_a_build(case: Case, tmp_path: Path) -> None:
    folder = case.lay(tmp_path / case.path.stem)
    before = findings(folder)
    for diagnostic, path, text in offered(before, folder):
        source = path.read_bytes()
        changed = [
            pair for pair in zip(*map(TEMPLATE.findall, (source.decode(), text)), strict=True) if len({*pair}) > 1
        ]
        assert not changed or (diagnostic.code == "unknown-name" and "parameter" in diagnostic.message)
        judge = partial(models_of, folder / "recipe.yaml", given={})
        holds = Fixing(judge, Context(environment={}, folder=folder)).holds(diagnostic)
        path.write_text(text, encoding="utf-8", newline="")
        assert holds is gone(diagnostic, before, findings(folder)), told(diagnostic)
        path.write_bytes(source)


@pytest.mark.parametrize("case", cases(TESTS / "language" / "errors"), ids=lambda case: case.id)
def test_every_offer_of_the_language(case: Case, tmp_path: Path) -> None:
    """These recipes have no models: each is judged by the language alone."""

    def judged(text: str) -> list[Diagnostic]:
        sink = Sink()
        if (node := load(text, "recipe.yaml", sink)) is not None:
            validate_what_remains(node, sink)
        return sink.diagnostics

    source = case.texts["recipe.yaml"]
    before = judged(source)
    for diagnostic in before:
        if (edit := edit_of(diagnostic, source)) is not None:
            after = judged(applied(source, [edit]))
            assert gone(diagnostic, {"": before}, {"": after}), told(diagnostic)


ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="left"><joint name="left_elbow" axis="0 1 0"/>
  <geom name="rod" size="0.1"/></body><body name="right"><joint name="right_elbow" axis="0 1 0"/><geom size="0.1"/>
</body></worldbody></mujoco>"""

COMPUTED = {
    "an angle": "params: {t: {default: 10}}\nadd: [{to: left, site: {name: s, euler: [0, '${t}', 0]}}]",
    "a list": "params: {t: {default: 10}}\nadd: [{to: left, site: {name: s, euler: ['${t}', 20, 0]}}]",
    "a whole list": "params: {t: {default: [0, 50, 0]}}\nadd: [{to: left, site: {name: s, euler: '${t}'}}]",
    "an angle in an edit": "params: {t: {default: 10}}\nedit: [{select: {joint: left_elbow}, set: {ref: '${t}'}}]",
    "an expression": "params: {t: {default: 10}}\nedit: [{select: {joint: left_elbow}, set: {ref: '${2 * t}'}}]",
    "a name in a part": "params: {t: {default: l}}\nsensor: {s: {type: jointpos, joint: '${t}eft_elbw'}}",
    "a word": "params: {t: {default: sph}}\nadd: [{to: left, geom: {type: '${t}ere_', size: [1]}}]",
    "a number in text": "params: {t: {default: '10cm'}}\nadd: [{to: left, geom: {size: ['${t}']}}]",
    "a switch": "params: {t: {default: 'off'}}\noption: {flag: {gravity: '${t}'}}",
    "a place": "params: {t: {default: l}}\nadd: [{to: '${t}efft', geom: {size: [1]}}]",
    "a selection": "params: {t: {default: l}}\nedit: [{select: {joint: '${t}eft_elbw'}, set: {damping: 1}}]",
    "an alias": "params: {t: {default: 10}}\nadd:\n- {to: left, site: {name: s, axisangle: [0, 1, 0, &a '${t}']}}\n"
    "- {to: left, site: {name: r, axisangle: [0, 1, 0, *a]}}",
    "a block": "params: {t: {default: 10}}\nadd:\n- to: left\n  site:\n    name: s\n    euler: [1rad, 0, 0]\n"
    "- select: {joint: left_elbow}\n  to: left\n  site: {name: r, axisangle: [0, 1, 0, '${t}']}",
    "a literal block": "params: {t: {default: 10}}\nedit:\n- select: {joint: left_elbow}\n  set:\n    ref: |-\n      ${t}\n",
    "a keyframe": "params: {t: {default: 10}}\nkeyframe: {k: {qpos: {left_elbow: '${t}'}}}",
}


@pytest.mark.parametrize("text", COMPUTED.values(), ids=COMPUTED)
def test_no_fix_replaces_a_template(tmp_path: Path, text: str) -> None:
    (tmp_path / "arm.xml").write_text(ARM, encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(f"recipe: 1\nbase: ./arm.xml\n{text}\n", encoding="utf-8")
    context = Context(environment={}, folder=tmp_path)
    build(ModelRequest(recipe), context)
    assert context.sink.errors
    for each in context.sink.errors:
        assert each.fix is None and "write `" not in (each.help or "") and "did you mean" not in (each.help or "")
    found = fix(recipe, Context(environment={}, folder=tmp_path))
    assert not found.files and found.left


def test_cells_that_need_different_texts_get_none(tmp_path: Path) -> None:
    (tmp_path / "left.xml").write_text(ARM.replace("left_elbow", "elbow_a"), encoding="utf-8")
    (tmp_path / "right.xml").write_text(ARM.replace("left_elbow", "elbow_bb"), encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    text = """recipe: 1
params: {arm: {default: left}}
base: ./${arm}.xml
sensor: {s: {type: jointpos, joint: elbow_b}}
matrix: {axes: {arm: [left, right]}}
"""
    recipe.write_text(text, encoding="utf-8")
    found = fix(recipe, Context(environment={}, folder=tmp_path))
    assert not found.files and found.left


def test_a_fault_of_one_cell_is_fixed_and_the_other_cell_keeps_its_model(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM, encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    text = """recipe: 1
base: ./arm.xml
variants:
  tool:
    none: {}
    pad: {add: [{to: left, geom: {type: shpere, size: [0.1]}}]}
matrix: {axes: {tool: [none, pad]}}
"""
    recipe.write_text(text, encoding="utf-8")
    found = fix(recipe, Context(environment={}, folder=tmp_path))
    assert found.files[recipe][1].decode() == text.replace("shpere", "sphere") and not found.left


def test_a_name_that_two_cells_share_is_not_renamed_for_one_of_them(tmp_path: Path) -> None:
    """`elbw` exists in one of the arms: writing `elbow` would break that cell."""
    (tmp_path / "old.xml").write_text(ARM.replace("left_elbow", "elbw"), encoding="utf-8")
    (tmp_path / "new.xml").write_text(ARM.replace("left_elbow", "elbow"), encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    text = """recipe: 1
params: {arm: {default: new}}
base: ./${arm}.xml
sensor: {s: {type: jointpos, joint: elbw}}
matrix: {axes: {arm: [old, new]}}
"""
    recipe.write_text(text, encoding="utf-8")
    found = fix(recipe, Context(environment={}, folder=tmp_path))
    assert not found.files and found.left


def test_a_model_without_the_fault_keeps_its_files(tmp_path: Path) -> None:
    """One arm has both names, so the fix of the other cell would silently move its sensor to another joint."""
    (tmp_path / "two.xml").write_text(ARM.replace("right_elbow", "left_elbw"), encoding="utf-8")
    (tmp_path / "one.xml").write_text(ARM, encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    text = """recipe: 1
params: {arm: {default: one}}
base: ./${arm}.xml
sensor: {s: {type: jointpos, joint: left_elbw}}
matrix: {axes: {arm: [one, two]}}
"""
    recipe.write_text(text, encoding="utf-8")
    found = fix(recipe, Context(environment={}, folder=tmp_path))
    assert not found.files and [each.code for each in found.left if each.severity is Severity.ERROR] == ["unknown-name"]

"""A keystroke in a long recipe shows what is certain at once, and the rest after a pause."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from growth.counting import calls_of
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.lsp import desk as desk_module
from mjcompose.lsp.analysis import Analysis
from mjcompose.lsp.desk import Desk, Workspace
from mjcompose.lsp.glance import glance, waits_for_pause

MODEL = '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'


def _recipe(count: int, *more: str) -> str:
    parts = "".join(f"  p{number}: {{model: ./m.xml, pos: [{number}, 0, 0]}}\n" for number in range(count))
    return f"recipe: 1\nparams: {{a: 1}}\nattach:\n{parts}{''.join(more)}"


def _analyzed(folder: Path, text: str) -> Analysis:
    (folder / "m.xml").write_text(MODEL)
    (folder / "r.yaml").write_text(text)
    workspace = Workspace(folder)
    try:
        return workspace.analyze(folder / "r.yaml", text, {})
    finally:
        workspace.close()


def _faults(analysis: Analysis) -> list[tuple[str, int]]:
    return [(each.code, each.span.line) for each in analysis.found if each.span is not None]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("  p5: {model: ./m.xml, poss: [1, 0, 0]}", [("unknown-key", 9)]),
        ("  p5: {model: ./m.xml, pos: [1, 0]}", [("wrong-length", 9)]),
        ("  p5: {model: ./m.xml, pos: ['${a}', '${b}', 0]}", []),  # another recipe may declare `b`
        ("  p5: {model: ./m.xml, site: p7/none}", []),
        ("  p5: {model: ./m.xml, pos: [1", [("yaml-syntax", 9)]),
    ],
)
def test_faults_of_the_changed_line_are_seen(tmp_path: Path, line: str, expected: list[tuple[str, int]]) -> None:
    text = _recipe(20)
    before = _analyzed(tmp_path, text)
    lines = text.split("\n")
    lines[8] = line
    after = glance("\n".join(lines), before)
    assert _faults(after) == expected
    assert after.plan is before.plan
    assert not after.is_composed
    assert after.is_current == (("yaml-syntax", 9) not in expected)


def test_faults_of_other_lines_stay_and_move(tmp_path: Path) -> None:
    text = _recipe(20, "sensor:\n  s: {type: force, sight: p1/none}\n")
    before = _analyzed(tmp_path, text)
    faults = _faults(before)
    assert {line for _, line in faults} == {25}
    inserted = text.replace("attach:\n", "attach:\n  new: {model: ./m.xml}\n")
    assert _faults(glance(inserted, before)) == [(code, 26) for code, _ in faults]
    mended = text.replace("sight: p1/none", "cutoff: 1")
    assert _faults(glance(mended, before)) != faults


def test_a_fault_of_yaml_goes_with_its_cause(tmp_path: Path) -> None:
    text = _recipe(20)
    broken = text.replace("p5: {", "p5: {{")
    before = _analyzed(tmp_path, broken)
    assert _faults(before)
    assert _faults(glance(text, before)) == []


def test_a_keystroke_reads_the_changed_entry_alone(tmp_path: Path) -> None:
    calls = []
    for count in (100, 400):
        text = _recipe(count)
        before = _analyzed(tmp_path, text)
        changed = text.replace("  p50: {model: ./m.xml, pos: [50,", "  p50: {model: ./m.xml, pos: [5,")
        glance(changed, before)  # imports modules
        calls.append(calls_of(lambda: glance(changed, before)))  # noqa: B023
    # Five calls for each of 300 more lines; reading all of them takes more than fifty.
    assert calls[1] - calls[0] < 5 * 300, calls


def test_only_long_and_slow_recipes_wait_for_a_pause() -> None:
    assert waits_for_pause(_recipe(500), 1.0)
    assert not waits_for_pause(_recipe(500), 0.01)
    assert not waits_for_pause(_recipe(50), 1.0)


def test_the_model_is_composed_once_nobody_types(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(desk_module, "waits_for_pause", lambda text, seconds: seconds > 0)
    monkeypatch.setattr(desk_module, "PAUSE", 0.3)
    (tmp_path / "m.xml").write_text(MODEL)
    path = tmp_path / "r.yaml"
    text = _recipe(10)
    published: list[list[Diagnostic]] = []
    analyzed: list[str] = []
    wrong: list[str] = []

    async def edit() -> Analysis | None:
        desk = Desk(tmp_path, lambda _, found: published.append(found), wrong.append)
        analyze = desk.workspace.analyze
        monkeypatch.setattr(
            desk.workspace, "analyze", lambda file, now, *rest: analyzed.append(now) or analyze(file, now, *rest)
        )
        desk.take(path, text)
        await desk.analyzed(path, newest=True)
        for number in range(4):
            desk.change(path, text.replace("  p3: {", f"  p3: {{wrong{number}: 1, "))
            await asyncio.sleep(0.05)
        assert analyzed == [text]
        assert [each.code for each in published[-1]] == ["unknown-key"]
        desk.change(path, text + "name: last\n")
        last = await desk.analyzed(path, newest=True)  # a question does not wait for the pause
        assert analyzed == [text, text + "name: last\n"]
        desk.change(path, text + "name: later\n")
        for _ in range(200):
            if len(analyzed) == 3:
                break
            await asyncio.sleep(0.05)
        await desk.shut()
        return last

    with ThreadPoolExecutor() as threads:  # a browser of another test may have left its event loop in this one
        last = threads.submit(asyncio.run, edit()).result()
    assert last is not None
    assert last.is_composed
    assert analyzed[2:] == [text + "name: later\n"]
    assert not wrong

"""When a verdict of MuJoCo arrives late, it is one on another text.

What is kept from one analysis to the next: each sees what it would see if nothing were kept.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.lsp import desk as desk_module
from mjcompose.lsp.analysis import Analysis
from mjcompose.lsp.desk import Desk, Workspace
from mjcompose.trace.explanation import render
from mjcompose.tree.xml_text import to_text

MODEL = '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
TEXT = "recipe: 1\nbase: ./m.xml\n"


class Judge:
    """In the place of MuJoCo: its first verdict waits until it is let go, others are that nothing is wrong."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.begun = threading.Event()
        self.may_answer = threading.Event()
        self.asked_again = threading.Event()

    def verify(self, path: Path, text: str, texts: Mapping[str, bytes]) -> tuple[Diagnostic, ...]:
        self.asked.append(text)
        if len(self.asked) > 1:
            self.asked_again.set()
            return ()
        self.begun.set()
        assert self.may_answer.wait(60)
        return (Diagnostic("check-failed", "too heavy", Span(path.name, 2, 1)),)


@pytest.fixture
def judge(monkeypatch: pytest.MonkeyPatch) -> Judge:
    monkeypatch.setattr(desk_module, "PAUSE", 0.01)
    return Judge()


def published(folder: Path, judge: Judge, meanwhile: str) -> list[list[str]]:
    """The codes that were published of a recipe, one list each time, where something happens before the verdict."""
    (folder / "m.xml").write_text(MODEL)
    path = folder / "r.yaml"
    found = []
    wrong = []

    async def edit() -> None:
        desk = Desk(folder, lambda _, faults: found.append([each.code for each in faults]), wrong.append)
        desk.verifier.verify = judge.verify  # type: ignore[method-assign]
        desk.take(path, TEXT)
        assert await asyncio.to_thread(judge.begun.wait, 60)
        if meanwhile == "typed":
            desk.change(path, TEXT + "name: heavy\n")
        elif meanwhile == "closed":
            desk.close(path)
        judge.may_answer.set()
        if meanwhile == "typed":
            assert await asyncio.to_thread(judge.asked_again.wait, 60)
        for _ in range(20):
            await asyncio.sleep(0.01)
        await desk.shut()

    # Another test of this process may have left a browser open, whose loop runs in this thread.
    with ThreadPoolExecutor(1) as own_thread:
        own_thread.submit(asyncio.run, edit()).result()
    assert not wrong, "".join(wrong)
    return found


def test_a_verdict_on_the_text_as_it_is_is_shown(tmp_path: Path, judge: Judge) -> None:
    assert published(tmp_path, judge, "nothing")[-1] == ["check-failed"]


def test_a_verdict_on_an_earlier_text_is_not(tmp_path: Path, judge: Judge) -> None:
    assert not any(published(tmp_path, judge, "typed"))
    assert judge.asked == [TEXT, TEXT + "name: heavy\n"], "the new text is judged by itself"


def test_a_verdict_on_a_file_that_was_closed_is_not(tmp_path: Path, judge: Judge) -> None:
    assert not any(published(tmp_path, judge, "closed"))


ARM = '<mujoco><worldbody><body name="link"><geom name="shell" size="{size}"/></body></worldbody></mujoco>'
ROBOT = "boston_dynamics_spot"
BASE = "recipe: 1\nname: base\nbase: {model: floor.xml}\nattach:\n  arm: {model: arm.xml, pos: [0, 0, 1]}\n"
RECIPE = "recipe: 1\nextends: base.yaml\nname: whole\n"


@pytest.fixture
def workspace(tmp_path: Path) -> Iterator[Workspace]:
    (tmp_path / "floor.xml").write_text("<mujoco><worldbody/></mujoco>")
    (tmp_path / "arm.xml").write_text(ARM.format(size=1))
    (tmp_path / "base.yaml").write_text(BASE)
    (tmp_path / "whole.yaml").write_text(RECIPE)
    workspace = Workspace(tmp_path)
    yield workspace
    workspace.close()


def analyzed(workspace: Workspace, before: Analysis | None = None, text: str = RECIPE) -> Analysis:
    return workspace.analyze(workspace.folder / "whole.yaml", text, {}, before)


def text_of(analysis: Analysis) -> str:
    assert analysis.model is not None, analysis.found
    return to_text(analysis.model.unit.root)


def _model(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "arm.xml").write_text(ARM.format(size=25))


def _base(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "base.yaml").write_text(BASE.replace("[0, 0, 1]", "[0, 0, 25]"))


def _environment(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MENAGERIE_ROOT", str(_robots(folder / "others", 25)))


def _robots(folder: Path, size: int) -> Path:
    """Return a folder with one robot of MuJoCo Menagerie, in name only."""
    (folder / ROBOT).mkdir(parents=True)
    (folder / ROBOT / "spot.xml").write_text(ARM.format(size=size))
    return folder


@pytest.mark.parametrize("change", [_model, _base, _environment])
def test_an_edit_elsewhere_is_seen_in_the_model_and_in_its_trace(
    workspace: Workspace, monkeypatch: pytest.MonkeyPatch, change: Callable[[Path, pytest.MonkeyPatch], None]
) -> None:
    if change is _environment:
        monkeypatch.setenv("MENAGERIE_ROOT", str(_robots(workspace.folder / "robots", 1)))
        (workspace.folder / "base.yaml").write_text(BASE.replace("arm.xml", f"menagerie:{ROBOT}/spot"))
    before = workspace.traced(analyzed(workspace))
    assert "25" not in text_of(before)
    change(workspace.folder, monkeypatch)
    after = analyzed(workspace, before)
    assert "25" in text_of(after)
    assert "25" in text_of(workspace.traced(after))


def test_a_trace_is_that_of_the_analyzed_sources_though_a_file_has_changed_since(workspace: Workspace) -> None:
    analysis = analyzed(workspace)
    (workspace.folder / "arm.xml").write_text(ARM.format(size=25))
    traced = workspace.traced(analysis)
    assert text_of(traced) == text_of(analysis)
    shell = traced.names.find("geom", "arm/shell")
    assert shell is not None and shell.node is not None and traced.traced is not None
    assert "arm.xml:1" in render(traced.traced.element(shell.node))


def test_a_trace_is_made_once_and_dropped_with_its_model(workspace: Workspace) -> None:
    first = analyzed(workspace)
    traced = workspace.traced(first)
    assert first.traced is None and traced.traced is not None
    assert workspace.traced(first) is traced and workspace.traced(traced) is traced
    assert analyzed(workspace, traced).traced is None
    half = analyzed(workspace, traced, RECIPE + "attach: {arm")
    assert not half.is_composed and half.traced is traced.traced and half.model is traced.model

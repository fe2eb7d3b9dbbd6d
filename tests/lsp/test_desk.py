"""When a verdict of MuJoCo arrives late, it is one on another text."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Mapping
from pathlib import Path

import pytest

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.lsp import desk as desk_module
from composer.lsp.desk import Desk

MODEL = '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
TEXT = "recipe: 1\nbase: ./m.xml\n"


class Judge:
    """In the place of MuJoCo: its first verdict waits until it is let go, others are that nothing is wrong."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.begun, self.may_answer, self.asked_again = (
            threading.Event(),
            threading.Event(),
            threading.Event(),
        )

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
    path, found, wrong = folder / "r.yaml", [], []

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

    asyncio.run(edit())
    assert not wrong, "".join(wrong)
    return found


def test_a_verdict_on_the_text_as_it_is_is_shown(tmp_path: Path, judge: Judge) -> None:
    assert published(tmp_path, judge, "nothing")[-1] == ["check-failed"]


def test_a_verdict_on_an_earlier_text_is_not(tmp_path: Path, judge: Judge) -> None:
    assert not any(published(tmp_path, judge, "typed"))
    assert judge.asked == [TEXT, TEXT + "name: heavy\n"], "the new text is judged by itself"


def test_a_verdict_on_a_file_that_was_closed_is_not(tmp_path: Path, judge: Judge) -> None:
    assert not any(published(tmp_path, judge, "closed"))

"""What is kept from one analysis to the next: each sees what it would see if nothing were kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from composer.explain.text import render
from composer.lsp.analysis import Analysis
from composer.lsp.workspace import Workspace
from composer.tree.write import to_text

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


def analysed(workspace: Workspace, before: Analysis | None = None, text: str = RECIPE) -> Analysis:
    return workspace.analyse(workspace.folder / "whole.yaml", text, {}, before)


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
    workspace: Workspace,
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[Path, pytest.MonkeyPatch], None],
) -> None:
    if change is _environment:
        monkeypatch.setenv("MENAGERIE_ROOT", str(_robots(workspace.folder / "robots", 1)))
        (workspace.folder / "base.yaml").write_text(BASE.replace("arm.xml", f"menagerie:{ROBOT}/spot"))
    before = workspace.traced(analysed(workspace))
    assert "25" not in text_of(before)
    change(workspace.folder, monkeypatch)
    after = analysed(workspace, before)
    assert "25" in text_of(after)
    assert "25" in text_of(workspace.traced(after))


def test_a_trace_is_that_of_the_analyzed_sources_though_a_file_has_changed_since(
    workspace: Workspace,
) -> None:
    analysis = analysed(workspace)
    (workspace.folder / "arm.xml").write_text(ARM.format(size=25))
    traced = workspace.traced(analysis)
    assert text_of(traced) == text_of(analysis)
    shell = traced.names.find("geom", "arm/shell")
    assert shell is not None and shell.node is not None and traced.traced is not None
    assert "arm.xml:1" in render(traced.traced.element(shell.node))


def test_a_trace_is_made_once_and_dropped_with_its_model(workspace: Workspace) -> None:
    first = analysed(workspace)
    traced = workspace.traced(first)
    assert first.traced is None and traced.traced is not None
    assert workspace.traced(first) is traced and workspace.traced(traced) is traced
    assert analysed(workspace, traced).traced is None
    half = analysed(workspace, traced, RECIPE + "attach: {arm")
    assert not half.is_composed and half.traced is traced.traced and half.model is traced.model

from __future__ import annotations

from pathlib import Path

import pytest
from fidelity import run
from fidelity.summary import BEGIN, END


def test_the_table_is_printed_and_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = tmp_path / "models" / "robot.xml"
    robot.parent.mkdir()
    (tmp_path / "feature-cases").mkdir()
    robot.write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    monkeypatch.setenv("MJCOMPOSE_CORPUS", str(tmp_path))
    monkeypatch.setattr(run.corpora, "packaged", lambda: iter(()))
    page = tmp_path / "page.md"
    page.write_text(f"# Page\n{BEGIN}\n{END}\n")
    assert run.main(["--roundtrip", "--workers", "1", "--write", str(page)]) == 0
    out, err = capsys.readouterr()
    row = "| parse → write → compile: corpus | 1 | 1 (100 %) | 1 (100 %) |"
    assert row in out
    assert row in page.read_text(encoding="utf-8")
    assert "1 of 1" in err


def test_without_a_corpus_only_packages_are_read(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("MJCOMPOSE_CORPUS", raising=False)
    monkeypatch.setattr(run.corpora, "packaged", lambda: iter(()))
    assert run.main([]) == 0
    assert "names no corpus" in capsys.readouterr().err

from __future__ import annotations

from pathlib import Path

import pytest
from foreign import fetching
from foreign.run import main


def test_every_package_is_pinned() -> None:
    assert {"dm_control", "absl-py", "mujoco-warp"} <= fetching.pins().keys()
    assert all(line.count("==") == 1 for line in fetching.pins().values())


def test_what_is_there_is_not_fetched_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fetching, "_installer", lambda: pytest.fail("it asked for it again"))
    folder = tmp_path / fetching.pins()["brax"]
    folder.mkdir()
    assert fetching.fetched("brax", tmp_path) == folder


def test_what_cannot_be_had_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fetching, "_installer", lambda: ("sh", "-c", "echo ERROR: no network >&2; exit 1", "sh"))
    with pytest.raises(fetching.Unavailable, match=r"brax==[\d.]+ cannot be fetched: ERROR: no network"):
        fetching.fetched("brax", tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.mujoco4("the lists of differences are of MuJoCo 4")
def test_without_packages_a_run_says_why_and_is_no_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(fetching, "_installer", lambda: ("sh", "-c", "echo ERROR: no network >&2; exit 1", "sh"))
    monkeypatch.setattr("foreign.strings.found_in", lambda package, name: [])
    assert main(["--cache", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    assert (
        "dm_control 1.0.50, its own tests of `mjcf`: skipped, dm_control==1.0.50 cannot be fetched: ERROR: no network"
        in told
    )
    assert "brax: skipped, brax==" in told and "no surprises" in told

from __future__ import annotations

from pathlib import Path

import pytest
from foreign import run, strings
from foreign.strings import Source, Verdict
from foreign.turned import judge

ARM = """<mujoco model="arm"><worldbody><body name="link" pos="0 0 1"><joint name="j" axis="0 1 0"/>
  <geom name="rod" type="capsule" size="0.05" fromto="0 0 0 1 0 0"/></body></worldbody>
  <actuator><motor name="m" joint="j"/></actuator><keyframe><key name="k" qpos="0.3"/></keyframe></mujoco>"""
ALONG_X = '<mujoco><worldbody><body><freejoint name="f"/><geom size="0.1"/><body pos="1 0 0"><geom size="0.3"/></body></body></worldbody><actuator><motor joint="f" gear="1 0 0 0 1 0"/></actuator></mujoco>'


def test_a_model_twice_is_unchanged(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    assert judge(Source("text", tmp_path, ARM)) == Verdict("text", True)
    assert judge(Source("file", tmp_path / "arm.xml")) == Verdict("file", True)
    assert judge(Source("none", tmp_path, "<mujoco><geom/></mujoco>")) == Verdict("none", False)


def test_a_model_that_is_another_where_it_is_turned_says_where(tmp_path: Path) -> None:
    verdict = judge(Source("text", tmp_path, ALONG_X))
    assert verdict.loads and "`actuator_acc0` is " in verdict.said


def test_a_build_that_moves_a_part_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    right = judge.__globals__["_recipe"]

    def wrong(model: Path, folder: Path) -> Path:
        recipe: Path = right(model, folder)
        recipe.write_text(recipe.read_text().replace("3.1", "3.2"))
        return recipe

    monkeypatch.setitem(judge.__globals__, "_recipe", wrong)
    said = judge(Source("text", tmp_path, ARM)).said
    assert "`one/link`: `body_pos` is " in said and "two/" not in said


def test_a_refused_model_is_told(tmp_path: Path) -> None:
    verdict = judge(Source("body", tmp_path, "<mujoco><body><geom size='1'/></body></mujoco>"))
    assert verdict.loads and verdict.said.startswith("refused: ")


def test_a_sample_is_evenly_spread() -> None:
    assert list(run._spread(range(10), None)) == list(range(10))
    assert list(run._spread(range(10), 4)) == [0, 3, 6, 9]
    assert list(run._spread(range(3), 12)) == [0, 1, 2]


def test_lines_of_models_out_of_the_sample_are_not_asked_for() -> None:
    sources = [Source(f"p/{each}", Path()) for each in "abc"]
    expected = {"p/a": "so", "p/b": "so", "p/gone": "so", "q/a": "so"}
    mine = run._of("p", expected, [Verdict("p/a", True, "differs")], sources)
    assert mine == {"p/a": "so", "p/gone": "so"}


def test_every_listed_place_has_a_package() -> None:
    for kind in ("group", "turned", "merged"):
        places = strings.intended(kind)
        assert places and {place.partition("/")[0] for place in places} <= run.MODELS.keys()

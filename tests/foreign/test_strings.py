from __future__ import annotations

from pathlib import Path

import pytest
from foreign.strings import Source, Verdict, found_in, in_program, judge, surprises

BALL = '<mujoco model="m"><worldbody><geom name="ball" size="0.1"/></worldbody></mujoco>'


def test_models_of_a_program_by_their_lines() -> None:
    program = f'''"""Words {BALL} and words."""
x = 1
def f(n):
    load("""
    {BALL.replace("ball", "other")}
    """)
    load(f"<mujoco model='{{n}}'></mujoco>")
    load("<mujoco")
    return """{BALL}"""
'''
    assert in_program(program) == [(1, BALL), (4, BALL.replace("ball", "other"))]


def test_files_and_programs_of_a_package(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "ball.xml").write_text(BALL)
    (tmp_path / "ball_test.py").write_text(f"XML = '''{BALL}'''\n")
    (tmp_path / "notes.txt").write_text(BALL)
    assert [(source.id, source.text) for source in found_in(tmp_path, "p")] == [
        ("p/ball_test.py:1", BALL),
        ("p/data/ball.xml", None),
    ]


def test_a_model_that_stays_the_same(tmp_path: Path) -> None:
    (tmp_path / "ball.xml").write_text(BALL)
    assert judge(Source("text", tmp_path, BALL)) == Verdict("text", True)
    assert judge(Source("file", tmp_path / "ball.xml")) == Verdict("file", True)
    assert judge(Source("none", tmp_path, "<mujoco><geom/></mujoco>")) == Verdict("none", False)


def test_a_model_that_is_refused_here_alone(tmp_path: Path) -> None:
    body = "<mujoco><body><geom size='1'/></body></mujoco>"
    verdict = judge(Source("body", tmp_path, body))
    assert verdict.loads and verdict.said.startswith("refused: ") and "unknown-element" in verdict.said


def test_a_model_that_changes_is_told_by_its_arrays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.mjcf.RootElement.to_xml_string", lambda root: BALL.replace("0.1", "0.2"))
    assert "geom_size" in judge(Source("text", tmp_path, BALL)).said.split(", ")


def test_only_what_is_not_listed_is_a_surprise() -> None:
    found = [
        Verdict("good", True),
        Verdict("meant", True, "refused"),
        Verdict("bad", True, "geom_size"),
        Verdict("no model", False),
        Verdict("mended", True),
    ]
    assert surprises(found, {"meant": "so", "mended": "so", "gone": "so"}) == [
        "bad: geom_size",
        "mended compiles to the same model, and is listed as an intended difference",
        "gone is listed as an intended difference, and does not exist",
    ]

"""The judge asked through MuJoCo's child process."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.engine import CompileRequest, Session
from mjcompose.mujoco.match import Difference
from mjcompose.verify.parts import compare_part, differences_of

PART = """
<mujoco>
  <worldbody><body name="a" pos="0 0 1"><joint damping="{}"/><geom size=".1"/></body></worldbody>
</mujoco>
"""
WHOLE = """
<mujoco>
  <worldbody>
    <body name="base"><geom size=".2"/><site name="top" pos="0 0 .5"/>
      <frame pos="0 0 .5"><body name="p/a" pos="0 0 1"><joint damping="1"/><geom size=".1"/></body></frame>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize(("damping", "expected"), [(1, []), (2, [("joint", "#0 of body `p/a`", 2.0, 1.0)])])
def test_the_answer_comes_back_as_differences(
    tmp_path: Path, damping: float, expected: list[tuple[object, ...]]
) -> None:
    pose = {"pos": (0, 0, 0.5), "quat": (1, 0, 0, 0)}
    question = {"prefix": "p/", "body": "base", "pose": pose, "keys": KeyMode.PREFIX}
    with Session() as session:
        for name, text in (("part", PART.format(damping)), ("whole", WHOLE)):
            answer, _ = session.ask(CompileRequest(tmp_path, text=text, keep=name))
            assert answer["ok"], answer
        answer = session.call(compare_part, ["part", "whole"], question)
    assert answer["ok"], answer
    found = differences_of(answer["value"])
    assert [(one.kind, one.name, one.expected, one.actual) for one in found] == expected
    assert all(isinstance(one, Difference) and one.array == "dof_damping" for one in found)


def test_an_unknown_pose_is_taken_from_the_composition(tmp_path: Path) -> None:
    with Session() as session:
        for name, text in (("part", PART.format(1)), ("whole", WHOLE)):
            session.ask(CompileRequest(tmp_path, text=text, keep=name))
        questions = [{"prefix": "p/", "body": body, "pose": None} for body in ("base", None)]
        at_base, in_world = (session.call(compare_part, ["part", "whole"], each) for each in questions)
    assert at_base["value"] == []
    assert in_world["value"]


def test_a_body_that_the_composition_does_not_have_has_no_answer(tmp_path: Path) -> None:
    with Session() as session:
        for name, text in (("part", PART.format(1)), ("whole", WHOLE)):
            session.ask(CompileRequest(tmp_path, text=text, keep=name))
        gone = session.call(compare_part, ["part", "whole"], {"prefix": "p/", "body": "gone"})
    assert gone["ok"] and gone["value"] is None

"""Checks as a recipe has them, asked of a model in this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import mujoco
import pytest
from language.validating import validate
from mjcompose.base.diagnostic import Fault
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.language.check import checks_of
from mjcompose.text.load import load
from mjcompose.verify.checks.check import RecipeFacts, WorldPlace, ask as ask_in_child, from_json

Ask = Callable[..., list[Fault]]

WORLD = {"body": None, "pos": [0, 0, 0], "quat": [1, 0, 0, 0]}


def notes(fault: Fault) -> tuple[str, ...]:
    """The texts of the notes."""
    return tuple(note.message for note in fault.notes)


@pytest.fixture
def ask() -> Ask:
    """What a check finds in a model: `ask(xml, "settles: {}")`; more arguments are fields of the scope."""

    def ask(xml: str, check: str, frame: dict[str, Any] = WORLD, head: str = "", **scope: Any) -> list[Fault]:
        sink = Sink()
        node = load(f"recipe: 1\n{head}\ncheck: {{it: {{{check}}}}}", "recipe.yaml", sink)
        assert node is not None
        recipe = validate(node, sink)
        assert recipe is not None, "\n".join(map(render, sink.diagnostics))
        (read,) = checks_of(recipe.check)
        facts = RecipeFacts(recipe.angle, WorldPlace(**frame), text=xml)
        if scope.get("prefix") or scope.get("others"):
            scope["whole"] = False
        question = {"word": read.word, "written": read.written, "scope": scope, "facts": asdict(facts)}
        question = json.loads(json.dumps(question))  # as it crosses into the child
        return [
            from_json(each) for each in ask_in_child(mujoco, mujoco.MjModel.from_xml_string(xml), question)["findings"]
        ]

    return ask


ARM = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="left/" pos="0 0 1">
      <freejoint name="left/"/>
      <geom size=".01" mass=".5" contype="0" conaffinity="0"/>
      <body name="left/base">
        <geom name="left/g" size=".1" mass="2"/>
        <geom size=".1" mass="3" contype="0" conaffinity="0"/>
        <body pos="0 0 .3">
          <joint name="left/shoulder" axis="0 1 0" range="-90 90" damping="3"/>
          <joint axis="1 0 0"/>
          <geom size=".05" mass="1"/>
          <site name="left/tcp" pos="0 0 .3"/>
        </body>
      </body>
    </body>
    <body name="right/base" pos="1 0 1"><geom name="right/g" size=".1" mass="4"/></body>
    <camera name="watch" fovy="45"/>
  </worldbody>
  <actuator><motor name="left/a" joint="left/shoulder"/><motor joint="left/shoulder"/><motor name="more" joint="left/shoulder"/></actuator>
  <sensor><jointpos joint="left/shoulder"/><clock/></sensor>
  <keyframe><key name="home" qpos="0 0 2 1 0 0 0 0 0"/><key name="left/low" qpos="0 0 0.05 1 0 0 0 0 0"/></keyframe>
</mujoco>
"""
"""A part `left/` on a body of its own, a part `right/`, and what is of neither."""


@pytest.fixture
def arm() -> str:
    return ARM

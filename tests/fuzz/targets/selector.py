"""Selectors: each means some elements of a model, or nothing."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from fuzz.mutation import json_changed
from fuzz.target import Seed, Target, Tools, without_a_place
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

_MODEL = """<mujoco><default><default class="pad"><geom friction="1"/></default></default><asset><mesh name="m"
  vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody><body name="left/a"><joint name="j"/><geom class="pad" size=".1"/>
  <frame name="f"><body name="b"><geom name="g1" type="mesh" mesh="m"/></body></frame></body><replicate count="2">
  <site name="s"/></replicate></worldbody><sensor><jointpos name="p" joint="j"/></sensor>
  <tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon></mujoco>"""
_SEEDS = (
    {"geom": "**", "parent": {"body": "**/a"}, "class": "**pad"},
    {"body": "{left,right}/*"},
    {"joint": "/j|k/"},
    {"geom": "**", "parent": {"body": "world"}},
    {"geom": "g?", "in": {"frame": "f"}, "where": {"type": "mesh"}},
    {"sensor": "*"},
    {"default": "pad"},
    {"fixed/joint": "*"},
    {"geom": "**", "where": "${index == 0}"},
    {"body": "**", "part": "p"},
)


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    yield from (Seed(json.dumps(each).encode()) for each in _SEEDS)


def check(path: Path, tools: Tools) -> str | None:
    (path.parent / "model.xml").write_text(_MODEL, encoding="utf-8")
    recipe = path.with_name("recipe.yaml")
    part = b"recipe: 1\nattach: {p: {model: ./model.xml, pos: [1, 0, 0]}}\nedit:\n  - optional: true\n    set: {}\n    select: "
    recipe.write_bytes(part + path.read_bytes().replace(b"\n", b" ") + b"\n")
    context = Context(environment={}, folder=path.parent)
    build(ModelRequest(recipe, verified=False), context, session=tools.session)
    return without_a_place(context)


TARGET = Target("selector", ".json", _seeds, json_changed, check)

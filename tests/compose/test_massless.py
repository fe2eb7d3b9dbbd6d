"""A joint of the recipe on a part that has no mass where the joint is: as MuJoCo decides it, but with the culprit."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from composer.context import Context
from composer.diagnostics.diagnostic import Diagnostic
from composer.stages import Request, build

BALL = '<geom size=".1"/>'
NOTHING = '<inertial pos="0 0 0" mass="1" diaginertia="0 0 0"/>'
MOVES = f'<body name="link"><joint/>{BALL}</body>'
CASES = {
    "a geom": f'<body name="root">{BALL}</body>',
    "a geom of the world": BALL,
    "an inertial": '<body name="root"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>',
    "a full inertia": '<body><inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0"/></body>',
    "no inertia": f'<body name="root">{NOTHING}{BALL}{MOVES}</body>',
    "no mass": '<body name="root"><geom size=".1" mass="0"/></body>',
    "no density": '<body name="root"><geom size=".1" density="0"/></body>',
    "nothing": '<body name="root"/>',
    "a site": '<site name="s"/>',
    "what moves alone": MOVES,
    "what moves below": f'<body name="root">{MOVES}</body>',
    "what is fixed below": f'<body name="root">{NOTHING}<body>{BALL}</body></body>',
    "what is fixed in a frame": f'<frame pos="1 0 0"><body><frame><body>{BALL}</body></frame></body></frame>',
    "what moves in a frame": f"<frame><frame>{MOVES}</frame></frame>",
    "what is fixed to what moves": f'<body><joint/>{NOTHING}<body name="tip">{BALL}</body></body>',
    "copies": f'<replicate count="2"><body>{BALL}</body></replicate>',
}  # fmt: skip


def built(folder: Path, part: str, more: str = "") -> list[Diagnostic]:
    (folder / "arm.xml").write_text(f"<mujoco><worldbody>{part}</worldbody></mujoco>")
    recipe = "recipe: 1\nattach:\n  arm:\n    model: ./arm.xml\n    joint: {type: hinge}\n"
    (folder / "recipe.yaml").write_text(recipe + more)
    context = Context(environment={}, folder=folder)
    build(Request(folder / "recipe.yaml", verified=False), context)
    return context.sink.errors


@pytest.mark.parametrize("part", CASES.values(), ids=CASES.keys())
def test_it_is_refused_where_mujoco_refuses_it(tmp_path: Path, part: str) -> None:
    try:
        mujoco.MjModel.from_xml_string(f"<mujoco><worldbody><body><joint/>{part}</body></worldbody></mujoco>")
        is_refused = False
    except ValueError as error:
        assert "mass and inertia" in str(error)
        is_refused = True
    found = built(tmp_path, part)
    if not is_refused:
        assert not found
        return
    (fault,) = found
    assert fault.code == "mujoco-rejects"
    assert fault.span is not None and (fault.span.file, fault.span.line) == ("recipe.yaml", 5)


def test_the_culprit_is_named_where_it_is_written(tmp_path: Path) -> None:
    (fault,) = built(tmp_path, f'<body name="root">{NOTHING}{BALL}\n{MOVES}</body>')
    said = [(note.message, note.span and note.span.line) for note in fault.notes]
    assert said == [
        ("the body `arm/root` has no mass, or no inertia", 1),
        ("the body `arm/link` moves by a joint of its own, so that its mass does not count", 2),
    ]


def test_the_help_helps(tmp_path: Path) -> None:
    (fault,) = built(tmp_path, MOVES)
    assert fault.help is not None
    more = fault.help.split("`")[1]
    assert more.startswith("add: ")
    assert built(tmp_path, MOVES, more) == []

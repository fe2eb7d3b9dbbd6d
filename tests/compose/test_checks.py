"""Numbers of a class that are angles for some joints and lengths for others.

A joint of the recipe on a part that has no mass where the joint is: as MuJoCo decides it, but with the culprit.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import pytest
from cases import Case
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ERRORS = Path(__file__).parents[1] / "errors"
LEGS = Case(ERRORS / "angles" / "class_angle_of_slide.txt").texts["legs.xml"]
BY_DEFAULT = "default: {main: {joint: {range: VALUE}}}"
BY_EDIT = "edit: [{select: {default: main}, set: {joint: {range: VALUE}}}]"


def codes(folder: Path, written: str, source: str = LEGS) -> list[str]:
    (folder / "legs.xml").write_text(source)
    (folder / "recipe.yaml").write_text(f"recipe: 1\nangle: degree\nbase: ./legs.xml\n{written}\n")
    context = Context(environment={}, folder=folder)
    build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    return [each.code for each in context.sink.errors]


@pytest.mark.parametrize("value", ["[0, 90]", "[0, 90deg]", "[0, 1.5rad]"])
@pytest.mark.parametrize("written", [BY_DEFAULT, BY_EDIT])
def test_a_length_that_would_be_turned_like_an_angle_is_an_error(tmp_path: Path, written: str, value: str) -> None:
    source = LEGS.replace("<worldbody>", '<default><joint damping="1"/></default><worldbody>')
    assert codes(tmp_path, written.replace("VALUE", value), source) == ["bare-angle"]


@pytest.mark.parametrize(
    ("value", "source"),
    [
        ("[0, 1]", LEGS.replace('angle="radian"', 'angle="degree"')),  # the same number for both
        ("[0, 90]", LEGS.replace('type="slide"', 'type="slide" range="0 1"')),  # not from the class
        ("[0, 90]", LEGS.replace('type="slide"', "")),
    ],
)
def test_what_means_one_thing_for_all_that_take_it_is_right(tmp_path: Path, value: str, source: str) -> None:
    assert codes(tmp_path, BY_DEFAULT.replace("VALUE", value), source) == []


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
}


def built(folder: Path, part: str, more: str = "") -> list[Diagnostic]:
    (folder / "arm.xml").write_text(f"<mujoco><worldbody>{part}</worldbody></mujoco>")
    recipe = "recipe: 1\nattach:\n  arm:\n    model: ./arm.xml\n    joint: {type: hinge}\n"
    (folder / "recipe.yaml").write_text(recipe + more)
    context = Context(environment={}, folder=folder)
    build(ModelRequest(folder / "recipe.yaml", verified=False), context)
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
        ("the body `arm/link` moves by its own joint, so its mass does not count", 2),
    ]


def test_the_help_helps(tmp_path: Path) -> None:
    (fault,) = built(tmp_path, MOVES)
    assert fault.help is not None
    more = fault.help.split("`")[1]
    assert more.startswith("add: ")
    assert built(tmp_path, MOVES, more) == []


Compose = Callable[..., Any]
HEAD = "recipe: 1\nbase: ./robot.xml\n"


def test_elements_may_refer_to_later_ones(compose: Compose) -> None:
    model = compose(
        f"{HEAD}sensor: {{s: {{type: tendonpos, tendon: t}}}}\nactuator: {{a: {{type: motor, tendon: t}}}}\n"
        "tendon: {t: {type: fixed, path: [{joint: hinge, coef: 1}]}}\nadd: [{to: base, geom: {size: [1], material: m}}]\n"
        "asset: {material: {m: {rgba: [1, 1, 1, 1]}}}\n"
    )
    assert not isinstance(model, list)


@pytest.mark.parametrize(
    ("section", "place"),
    [
        ("sensor: {s: {type: jointpos, joint: x}}", "3:37"),
        ("sensor: {s: {type: framepos, objtype: site, objname: flange, reftype: body, refname: x}}", "3:86"),
        ("contact: {exclude: [{body1: base, body2: x}]}", "3:42"),
        ("default: {c: {geom: {material: x}}}", "3:32"),
        ("default: {c: {parent: x}}", "3:23"),
        ("asset: {material: {m: {texture: x}}}", "3:33"),
        ("equality: {e: {type: joint, joint1: x}}", "3:37"),
        ("add: [{to: base, light: {mode: targetbody, target: x}}]", "3:52"),
        ("add: [{to: base, body: {childclass: x}}]", "3:37"),
    ],
)
def test_every_reference_is_looked_up(compose: Compose, section: str, place: str) -> None:
    assert compose(f"{HEAD}{section}\n") == [f"{place} unknown-name"]


def test_a_class_that_is_there_is_checked_too(compose: Compose) -> None:
    classes = (
        '<mujoco><default><default class="c"><geom rgba="1 1 1 1"/></default></default>'
        '<worldbody><geom size="1"/></worldbody></mujoco>'
    )
    text = "recipe: 1\nbase: ./classes.xml\ndefault: {c: {geom: {material: x}}}\n"
    assert compose(text, classes__xml=classes) == ["3:32 unknown-name"]


def test_the_world_and_the_top_class_are_always_there(compose: Compose) -> None:
    model = compose(
        f"{HEAD}contact: {{exclude: [{{body1: world, body2: base}}]}}\n"
        "sensor: {s: {type: framepos, objtype: body, objname: world}}\nadd: [{to: base, geom: {size: [1], class: main}}]\n"
    )
    assert not isinstance(model, list)


def test_names_of_what_mujoco_makes_are_let_through(compose: Compose) -> None:
    add = "add: [{to: base, replicate: {count: 3, offset: [1, 0, 0], site: {name: s}}}]\n"
    sensor = "sensor: {{s: {{type: touch, site: {}}}}}\n"
    assert not isinstance(compose(HEAD + add + sensor.format("s2")), list)
    assert compose(HEAD + add + sensor.format("x")) == ["4:33 unknown-name"]


def test_a_lost_place_is_one_fault(compose: Compose) -> None:
    """What would have been added counts as there."""
    assert compose(f"{HEAD}add: [{{to: bass, site: {{name: s}}}}]\nsensor: {{s: {{type: touch, site: s}}}}\n") == [
        "3:12 unknown-name"
    ]
    assert compose(f"{HEAD}default: {{c: {{parent: d}}}}\nadd: [{{to: base, geom: {{size: [1], class: c}}}}]\n") == [
        "3:23 unknown-name"
    ]


def test_one_name_in_two_namespaces_is_no_clash(compose: Compose) -> None:
    assert not isinstance(
        compose(f"{HEAD}add: [{{to: base, site: {{name: base}}}}, {{to: base, site: {{name: geom}}}}]\n"), list
    )
    assert compose(f"{HEAD}add: [{{to: base, site: {{name: flange}}}}]\n") == ["3:31 name-clash"]
    assert compose(f"{HEAD}add: [{{to: world, frame: {{name: f}}}}, {{to: world, frame: {{name: f}}}}]\n") == [
        "3:64 name-clash"
    ]

"""`drop` of a base or a part.

Entries of `edit`: what each verb changes in the compiled model, and that it changes nothing else.

Edits of a part alone, in its own names and units.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from compose.arm import DEGREES, Case, changed
from mjcompose.compose.preview import preview_plan
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context


def test_drop(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nbase: {model: ./arm.xml, drop: [light, contact, {geom: 'visual_*'}, {body: prop}]}\n"
    )
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    found = changed(before, model)
    assert {each for each in found if each[0] == "-"} == {"-sun", "-no", "-visual_upper", "-prop", "-free", "-ball"}
    assert {each for each in found if each[0] != "-"} <= {
        f"{key} {row}" for key in ("home", "other") for row in ("qpos", "qvel")
    }
    assert model.key("home").qpos == pytest.approx([0.1, 0.2])


def test_what_is_dropped_is_listed(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text("recipe: 1\nbase: {model: ./arm.xml, drop: [{body: link2}]}\n")
    context = Context(environment={}, folder=radian.folder)
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    (found,) = preview_plan(plan, context).subtrees.values()
    listed = {(each.what, each.name) for each in found.dropped}
    assert {("body", "link2"), ("joint", "elbow"), ("site", "tip"), ("actuator", "a2")} <= listed
    assert not {"frame", "inertial"} & {what for what, _ in listed}, "they are no more than poses and numbers"


def test_drop_of_what_is_not_there(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text("recipe: 1\nbase: {model: ./arm.xml, drop: [equality, camera]}\n")
    context = Context(environment={}, folder=radian.folder)
    assert build(ModelRequest(radian.folder / "recipe.yaml", verified=False), context) is None
    assert [(each.code, each.span.column) for each in context.sink.errors if each.span] == [
        ("selector", 33),
        ("selector", 43),
    ]


@pytest.mark.parametrize(
    ("edits", "expected"),
    [
        ("{select: {joint: elbow}, set: {armature: 0.3}}", {"elbow dof_armature"}),
        ("{select: {joint: '{shoulder,elbow}'}, scale: {damping: 0.5}}", {"shoulder dof_damping", "elbow dof_damping"}),
        ("{select: {joint: elbow}, set: {ref: '${value + 5deg}'}}", {"elbow ref"}),
        ("{select: {joint: elbow}, set: {range: [-20deg, 1rad]}}", {"elbow range"}),
        ("{select: {joint: elbow}, set: {'range[1]': 30deg}}", {"elbow range"}),
        ("{select: {geom: upper}, set: {'friction[1]': 0.1}}", {"upper friction"}),
        ("{select: {geom: upper}, set: {friction: [1, 0.1]}}", {"upper friction"}),
        ("{select: {geom: upper}, set: {mass: null, density: 1}}", {"link1 mass", "link1 inertia"}),
        ("{select: {geom: base_geom}, set: {euler: [90deg, 0, 0]}}", {"base_geom quat", "base iquat"}),
        ("{select: {geom: '**', class: link, where: {group: 2}}, set: {rgba: [1, 0, 0, 1]}}", {"visual_upper rgba"}),
        (
            "{select: {geom: '**', in: {body: link1}, where: '${size[0] == 0.03 and group == 0}'}, set: {condim: 4}}",
            {"upper condim", "lower condim"},
        ),
        ("{select: {geom: '*', parent: {body: link1}}, set: {solmix: 2}}", {"upper solmix", "visual_upper solmix"}),
        ("{select: {geom: '/(upper|lower)/'}, set: {gap: 0.01}}", {"upper gap", "lower gap"}),
        ("{select: {default: visual}, set: {geom: {group: 3}}}", {"visual_upper group"}),
        ("{select: {default: link}, scale: {joint: {damping: 3}}}", {"shoulder dof_damping", "elbow dof_damping"}),
        ("{select: {geom: '**', parent: {body: world}}, set: {rgba: [1, 1, 1, 1]}}", {"floor rgba"}),
        ("{select: {body: link2}, set: {gravcomp: 1}}", {"link2 gravcomp"}),
        ("{select: {body: link2}, scale: {mass: 1.5}}", {"link2 mass", "link2 inertia"}),
        ("{select: {body: link1}, scale: {mass: 1.5}}", {"link1 mass", "link1 inertia"}),
        ("{select: {body: prop}, set: {mass: 3}}", {"prop mass", "prop inertia"}),
        ("{select: {site: tip}, move: {to: tray, pos: [0, 0, 0.3]}}", {"tip pos"}),
        ("{select: {geom: upper}, rename: '${name}_${parent}'}", {"-upper", "+upper_link1"}),
        ("{select: {key: other}, remove: true}", {"-other"}),
        ("{select: {sensor: s1}, remove: true}", {"-s1"}),
        ("{select: {site: tip}, remove: cascade}", {"-tip", "-s2"}),
        ("{select: {material: steel}, remove: cascade}", {"-steel"}),
        ("{select: {actuator: a1}, set: {kp: 3, 'forcerange[1]': 20}}", {"a1 gainprm", "a1 biasprm", "a1 forcerange"}),
        (
            "{select: {actuator: '?1', where: {joint: shoul*}}, set: {gear: [2]}}",
            {f"{each} gear" for each in ("a1", "v1", "f1", "g1")},
        ),
        (
            "{select: {actuator: '?1', where: {joint: '/sho.+r/'}}, set: {gear: [2]}}",
            {f"{each} gear" for each in ("a1", "v1", "f1", "g1")},
        ),
    ],
)
def test_a_verb_changes_what_it_says(arm: Case, edits: str, expected: set[str]) -> None:
    """In a whole model in radians, and in a part alone in degrees."""
    own = "degree" in (arm.folder / "arm.xml").read_text()
    before = arm.model("recipe: 1\nbase: ./arm.xml\n")
    assert changed(before, arm.edited(edits, own)) == expected


@pytest.mark.parametrize(
    ("edit", "expected", "said"),
    [
        ("{select: {joint: elbw}, set: {damping: 1}}", "14 selector", "did you mean `joint: elbow`"),
        (
            "{select: {joint: '*'}, expect: 2, set: {damping: 1}}",
            "36 selector",
            "selects 3 elements, expected 2\nit selects joint `shoulder`",
        ),
        (
            "{select: {geom: '*', parent: {body: lnk}}, set: {group: 1}}",
            "14 selector",
            "`parent: {body: lnk}` selects nothing",
        ),
        ("{select: {geom: '*', part: x}, set: {group: 1}}", "14 selector", "parts that exist: base"),
        ("{select: {xpath: '//geom'}, set: {group: 1}}", "15 unknown-element", "write a tag and narrow it"),
        ("{select: {geom: '*'}, rename: x}", "35 name-clash", "would both be called `x`"),
        ("{select: {geom: upper}, rename: lower}", "37 name-clash", "cannot be called `lower`"),
        ("{select: {geom: upper}, set: {material: stel}}", "45 unknown-name", "did you mean `material: steel`"),
        ("{select: {geom: upper}, set: {pos: [0, 0, 1]}}", "40 wrong-type", "`fromto` sets it"),
        ("{select: {geom: upper}, set: {group: '${vlue}'}}", "42 unknown-name", "did you mean `value`"),
        ("{select: {geom: base_geom}, scale: {mass: 2}}", "41 wrong-type", "change that, or the whole mass"),
        ("{select: {geom: upper}, set: {rgba: null}}", "35 unknown-attribute", "written on none"),
        ("{select: {body: prop}, move: {to: link1}}", "39 freejoint-on-body", "has a free joint"),
        ("{select: {body: link1}, move: {to: tray}}", "40 wrong-type", "into itself"),
        ("{select: {site: tip}, move: {to: trai}}", "38 unknown-name", "did you mean `to: tray`"),
        ("{select: {joint: elbow}, move: {to: world}}", "41 unknown-element", "cannot stand in `world`"),
        (
            "{select: {actuator: v1}, convert: {to: motor, ctrlrange: from-forcerange}}",
            "62 missing-key",
            "no `forcerange`",
        ),
    ],
)
def test_wrong(radian: Case, edit: str, expected: str, said: str) -> None:
    assert radian.told(edit) == [expected]
    assert said in radian.said


def test_edits_are_done_in_order(radian: Case) -> None:
    model = radian.edited(
        "{select: {joint: elbow}, rename: bend, scale: {damping: 2}, set: {damping: 5}}, {select: {joint: bend}, set: {damping: '${value + 1}'}}"
    )
    assert model.joint("bend").damping[0] == 11


def test_keys_follow(radian: Case, own: bool) -> None:
    """The columns of what is gone go, and those of what is moved come with it."""
    model = radian.edited("{select: {joint: shoulder}, remove: cascade}", own)
    assert model.key("home").qpos == pytest.approx([0.2, 1, 0, 0.1, 1, 0, 0, 0])
    assert model.key("home").qvel == pytest.approx([2, 3, 4, 5, 6, 7, 8])
    assert model.key("home").ctrl == pytest.approx([0.2, 0.3])
    model = radian.edited("{select: {body: base}, move: {to: world}}", own)
    assert model.key("home").qpos == pytest.approx([1, 0, 0.1, 1, 0, 0, 0, 0.1, 0.2])
    assert model.key("home").ctrl == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    ball = "{select: {joint: elbow}, set: {ref: null, type: ball, limited: false}}"
    model = radian.edited(f"{{select: {{sensor: s1}}, remove: true}}, {ball}", own)
    assert model.key("home").qpos[:5] == pytest.approx([0.1, 1, 0, 0, 0])


def test_keys_of_parts_follow_edits_of_the_whole(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nbase: ./arm.xml\nattach: {b: {model: ./arm.xml, pos: [0, 3, 0]}}\nedit:\n"
        "  - {select: {joint: '{elbow,b/shoulder}'}, remove: cascade}\n  - {select: {key: other}, rename: last}\n"
    )
    assert model.key("home").qpos[:1] == pytest.approx([0.1])
    assert model.key("home").qpos[8:9] == pytest.approx([0.2]) and model.key("last").qpos[8:9] == pytest.approx([0.4])
    assert model.key("home").ctrl == pytest.approx([0.1, 0.4, 0.5, 0.6, 0.2, 0.3])


UNNAMED = """<mujoco><worldbody><geom size="1"/><body name="b"><geom name="a" size=".1"/><geom size=".2"/>
  <frame pos="0 0 1"><geom size=".3"/></frame><body><geom size=".4"/></body><geom size=".5"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("where", "sizes"),
    [
        ("parent: {body: b}, where: '${index == 0}'", {0.2}),
        ("parent: {body: b}, where: '${index == 1}'", {0.3}),  # frames do not count
        ("parent: {body: b}, where: '${index == 2}'", {0.5}),
        ("where: '${index == 0}'", {1, 0.2, 0.4}),
        ("where: '${index < 0}'", {0.1}),
        ("parent: {body: '**', parent: {body: b}, where: '${index == 0}'}", {0.4}),
    ],
)
def test_what_has_no_name_has_a_number_in_its_parent(tmp_path: Path, where: str, sizes: set[float]) -> None:
    model = Case(tmp_path, UNNAMED).edited(f"{{select: {{geom: '**', {where}}}, set: {{group: 3}}}}")
    assert set(model.geom_size[model.geom_group == 3, 0]) == sizes


def test_a_part_is_edited_alone_in_its_own_names(radian: Case) -> None:
    """And in its own unit of angle, whatever that of the model will be."""
    (radian.folder / "deg.xml").write_text(DEGREES)
    model = radian.model(
        "recipe: 1\nbase: ./arm.xml\nattach:\n  d: {model: ./deg.xml, pos: [0, 2, 0], drop: [key], edit: "
        "[{select: {joint: elbow}, set: {range: [-10deg, 0.1rad], ref: '${value + 5deg}'}}, {select: {geom: lower}, rename: low}]}\n"
    )
    assert model.joint("d/elbow").range == pytest.approx([-np.radians(10), 0.1])
    assert model.joint("d/elbow").qpos0 == pytest.approx([np.radians(15)])
    assert model.geom("d/low").id > model.geom("lower").id
    assert model.joint("elbow").range == pytest.approx([-1.5, 1.5])

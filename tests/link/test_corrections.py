"""A part that is not valid alone: the lines of its errors are pasted into the recipe, which then builds."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
import yaml
from mjcompose.base.sink import Sink
from mjcompose.link.corrections import added_again, without_reference
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_text

ARM = """<mujoco>
  <asset><material name="steel" rgba="0.5 0.5 0.5 1"/></asset>
  <worldbody><body name="wrist"><joint name="roll"/><geom size="0.1"/><site name="tip"/></body></worldbody>
</mujoco>"""
HAND = """<mujoco>
  {before}
  <worldbody>
    <body name="palm" {body}><joint name="bend"/><geom name="pad" size="0.1" {geom}/><geom type="mesh" mesh="shell"/></body>
  </worldbody>
  {after}
</mujoco>"""
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SHELL = '<asset><mesh name="shell" file="shell.obj"/>{}</asset>'
REFERENCES = {"contact": "exclude", "sensor": "framepos", "equality": "weld", "actuator": "motor"}


def _build(folder: Path, recipe: object) -> tuple[mujoco.MjModel | None, Context]:
    (folder / "recipe.yaml").write_text(yaml.safe_dump(recipe))
    context = Context(environment={}, folder=folder)
    result = build(ModelRequest(folder / "recipe.yaml"), context)
    if result is None:
        return None, context
    files = result.bundle.files
    return mujoco.MjModel.from_xml_string(files["model.xml"].decode(), dict(files)), context


def _lay(folder: Path, *, before: str = SHELL.format(""), body: str = "", geom: str = "", after: str = "") -> None:
    (folder / "arm.xml").write_text(ARM)
    (folder / "shell.obj").write_text(MESH)
    (folder / "hand.xml").write_text(HAND.format(before=before, body=body, geom=geom, after=after))


@pytest.mark.parametrize(
    ("broken", "lines"),
    [
        ({"body": 'grasp="3"'}, ["edit: [{select: {body: palm}, set: {grasp: null}}]"]),
        (
            {
                "before": '<default><default class="soft" group="1"><geom mode="2"/></default></default>'
                + SHELL.format("")
            },
            [
                "edit: [{select: {default: soft}, set: {group: null}}]",
                "edit: [{select: {default: soft}, set: {geom: {mode: null}}}]",
            ],
        ),
        (
            {"before": SHELL.format('<mesh name="shell" file="missing.obj"/>')},
            ['drop: [{mesh: shell, where: "${index > 0}"}]'],
        ),
        (
            {"before": SHELL.format("") + SHELL.format("")},
            ['drop: [{mesh: shell, where: "${index > 0}"}]'],
        ),
        (
            {"geom": 'material="chrome"'},
            ["edit: [{select: {geom: pad}, set: {material: null}}]"],
        ),
        (
            {"geom": 'material="steel"'},
            [
                "edit: [{select: {geom: pad}, set: {material: null}}]",
                "edit: [{select: {geom: hand/pad}, set: {material: arm/steel}}]",
            ],
        ),
        (
            {"after": '<contact><exclude body1="wrist" body2="palm"/></contact>'},
            [
                'drop: [{exclude: "**", where: {body1: wrist}}]',
                "contact: {exclude: [{body1: arm/wrist, body2: hand/palm}]}",
            ],
        ),
        (
            {"after": '<sensor><framepos name="at" objtype="site" objname="tip" cutoff="3"/></sensor>'},
            [
                "drop: [{framepos: at}]",
                "sensor: {hand/at: {type: framepos, objtype: site, objname: arm/tip, cutoff: 3}}",
            ],
        ),
        (
            {"after": '<actuator><motor name="turn" joint="roll" gear="2" ctrllimited="false"/></actuator>'},
            [
                "drop: [{motor: turn}]",
                'actuator: {hand/turn: {type: motor, joint: arm/roll, gear: [2], ctrllimited: "false"}}',
            ],
        ),
    ],
)
def test_the_lines_of_the_errors_are_pasted_and_the_recipe_builds(
    tmp_path: Path, broken: dict[str, str], lines: list[str]
) -> None:
    _lay(tmp_path)
    recipe: dict = {"recipe": 1, "attach": {"arm": {"model": "./arm.xml"}, "hand": {"model": "./hand.xml"}}}
    whole, _ = _build(tmp_path, recipe)
    assert whole is not None
    _lay(tmp_path, **broken)
    model, context = _build(tmp_path, recipe)
    assert model is None
    helps = [each.help or "" for each in context.sink.errors if each.code != "asset-missing"]
    shown = [line for help in helps for line in re.findall(r"`((?:drop|edit|contact|sensor|actuator): .*)`", help)]
    assert shown == lines
    for line in shown:
        for key, value in yaml.safe_load(line).items():
            is_own = "hand/" in line
            target = recipe if is_own else recipe["attach"]["hand"]
            target[key] = target.get(key, []) + value if isinstance(value, list) else value
    model, context = _build(tmp_path, recipe)
    assert context.sink.errors == [] and model is not None
    assert (model.ngeom, model.nmesh, model.nbody) == (whole.ngeom, whole.nmesh, whole.nbody)
    extra = (model.nexclude, model.nsensor, model.nu)
    assert extra == tuple(int(name in broken.get("after", "")) for name in ("<exclude", "<framepos", "<motor"))
    if "arm/steel" in lines[-1]:
        assert model.geom("hand/pad").matid[0] == model.material("arm/steel").id


def test_an_attribute_that_no_selected_element_has_is_still_an_error(tmp_path: Path) -> None:
    _lay(tmp_path, body='grasp="3"')
    edit = [{"select": {"body": "palm"}, "set": {"grip": None}}]
    model, context = _build(tmp_path, {"recipe": 1, "attach": {"hand": {"model": "./hand.xml", "edit": edit}}})
    messages = {each.message for each in context.sink.errors}
    assert model is None
    assert messages == {"`grip` is not an attribute of `body`", "`grasp` is not an attribute of `<body>`"}


def test_the_file_is_checked_for_each_part(tmp_path: Path) -> None:
    _lay(tmp_path, body='grasp="3"')
    edit = [{"select": {"body": "palm"}, "set": {"grasp": None}}]
    parts = {"left": {"model": "./hand.xml", "edit": edit}, "right": {"model": "./hand.xml"}}
    model, context = _build(tmp_path, {"recipe": 1, "attach": parts})
    assert model is None and [each.code for each in context.sink.errors] == ["unknown-attribute"]


def test_an_attribute_of_another_mujoco_is_not_offered_for_removal(tmp_path: Path) -> None:
    _lay(tmp_path, before='<option collision="predefined"/>' + SHELL.format(""))
    _, context = _build(tmp_path, {"recipe": 1, "attach": {"hand": {"model": "./hand.xml"}}})
    assert [each.help and "edit:" in each.help for each in context.sink.errors] == [False]


def test_an_element_with_settings_of_a_class_is_not_written_again() -> None:
    text = """<mujoco><default><general gear="3"/></default><actuator><motor name="m" joint="j"/></actuator></mujoco>"""
    unit = parse_text(text, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    motor = unit.root.find("actuator/motor")
    assert motor is not None
    removal = without_reference(motor, "joint", "joint")
    assert removal is not None and removal.text == "drop: [{motor: m}]"
    assert added_again(motor, "joint", "joint", "arm/j", unit) is None

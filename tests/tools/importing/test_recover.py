from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.importing.propose import propose
from mjcompose.tools.importing.recover import Recovered, recover
from mjcompose.tools.importing.search import find, separator_of
from mjcompose.tree.parse import parse_file

ARM = """\
<mujoco model="arm">
  <compiler angle="radian"/>
  <default><default class="arm"><joint damping="2"/></default></default>
  <worldbody>
    <body name="base" childclass="arm">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="link" pos="0 0 1">
        <joint name="shoulder" axis="0 1 0" range="-1 1"/>
        <geom name="rod" type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <site name="flange" pos="0 0 0.3" quat="0 1 0 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="shoulder" joint="shoulder"/></actuator>
</mujoco>
"""
TOOL = """\
<mujoco model="tool">
  <worldbody>
    <body name="palm"><geom name="palm" type="box" size="0.03 0.03 0.01"/></body>
  </worldbody>
</mujoco>
"""
# Two arms with a tool each, written by hand: other classes, one value changed, a camera and a sensor more.
MERGED = """\
<mujoco model="pair">
  <compiler angle="radian"/>
  <option timestep="0.001"/>
  <worldbody>
    <camera name="watch" pos="0 -2 1"/>
    <body name="left/base" pos="0.5 0 0">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="left/link" pos="0 0 1">
        <joint name="left/shoulder" axis="0 1 0" range="-1 1" damping="2"/>
        <geom name="left/rod" type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <site name="left/flange" pos="0 0 0.3" quat="0 1 0 0"/>
        <body name="left_tool/palm" pos="0 0 0.3" quat="0 1 0 0">
          <geom name="left_tool/palm" type="box" size="0.03 0.03 0.01"/>
        </body>
      </body>
    </body>
    <body name="right/base" pos="-0.5 0 0" euler="0 0 3.141592653589793">
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="right/link" pos="0 0 1">
        <joint name="right/shoulder" axis="0 1 0" range="-1 1" damping="{damping}"/>
        <geom name="right/rod" type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <site name="right/flange" pos="0 0 0.3" quat="0 1 0 0"/>
        <body name="right_tool/palm" pos="0 0 0.2">
          <geom name="right_tool/palm" type="box" size="0.03 0.03 0.01"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="left/link" body2="right/link"/></contact>
  <actuator>
    <motor name="left/shoulder" joint="left/shoulder"/>
    <motor name="right/shoulder" joint="right/shoulder"/>
  </actuator>
  <sensor><jointpos name="angle" joint="left/shoulder"/></sensor>
</mujoco>
"""


def recovered(folder: Path, damping: str = "2") -> Recovered:
    for name, text in (("arm", ARM), ("tool", TOOL), ("pair", MERGED.format(damping=damping))):
        (folder / f"{name}.xml").write_text(text)
    context = Context(folder=folder)
    found = recover(folder / "pair.xml", [folder / "arm.xml", folder / "tool.xml"], folder / "pair.yaml", context)
    assert found is not None and not context.sink.diagnostics
    return found


def test_a_model_of_four_parts(tmp_path: Path) -> None:
    found = recovered(tmp_path)
    assert found.faults == () and found.outcome is not None and found.outcome.same
    assert found.text.splitlines() == [
        "recipe: 1",
        "name: pair",
        "angle: radian",
        "",
        "attach:",
        "  left: {model: ./arm.xml, pos: [0.5, 0, 0]}",
        "  left_tool: {model: ./tool.xml, site: left/flange}",
        "  right: {model: ./arm.xml, pos: [-0.5, 0, 0], quat: [0, 0, 0, 1]}",
        "  right_tool: {model: ./tool.xml, body: right/link, pos: [0, 0, 0.2]}",
        "",
        "option: {timestep: 0.001}",
        "",
        "add:",
        """  - {to: world, xml: '<camera name="watch" pos="0 -2 1"/>'}""",
        "",
        "contact:",
        "  exclude:",
        "    - {body1: left/link, body2: right/link}",
        "",
        "sensor:",
        """  angle: {xml: '<jointpos name="angle" joint="left/shoulder"/>'}""",
    ]
    assert not (tmp_path / "pair.yaml").exists()


def test_a_changed_value_is_an_edit(tmp_path: Path) -> None:
    found = recovered(tmp_path, damping="5")
    assert "{select: {joint: right/shoulder}, set: {damping: [5]}}" in found.text
    assert found.outcome is not None and found.outcome.same


@pytest.mark.parametrize("setting", ['mass="0"', 'mass="0" density="0"', 'friction="0.3"', 'rgba="1 0 0 1" mass="2"'])
def test_a_class_that_lost_its_values(setting: str, tmp_path: Path) -> None:
    """A program that saves a model may drop the values of a class; the elements of the class have none to remove."""
    text = """<mujoco model="arm"><default><default class="shell"><geom {}/></default></default><worldbody>
      <body name="base"><geom size="0.1"/><geom name="a" class="shell" size="0.1"/><geom class="shell" size="0.2"/>
      <body name="link"><joint/><geom size="0.1"/></body></body></worldbody></mujoco>"""
    (tmp_path / "arm.xml").write_text(text.format(setting))
    (tmp_path / "all.xml").write_text(text.format(""))
    found = recover(tmp_path / "all.xml", [tmp_path / "arm.xml"], tmp_path / "all.yaml", Context(folder=tmp_path))
    assert found is not None and found.outcome is not None and found.outcome.same
    assert "not expressed" not in found.text


def test_what_cannot_be_said_is_a_comment(tmp_path: Path) -> None:
    """A material with layers is left out, so is the geom that has it, and the rest builds."""
    (tmp_path / "tool.xml").write_text(TOOL)
    layered = (
        '<asset><texture name="t" type="2d" builtin="flat" width="4" height="4"/>'
        '<material name="m"><layer role="rgb" texture="t"/></material></asset><worldbody>'
        '<geom name="shown" size="1" material="m"/><geom name="plain" size="1"/>'
    )
    (tmp_path / "all.xml").write_text(TOOL.replace("<worldbody>", layered))
    context = Context(folder=tmp_path)
    found = recover(tmp_path / "all.xml", [tmp_path / "tool.xml"], tmp_path / "all.yaml", context)
    assert found is not None and found.bundle is not None and found.faults == ()
    notes = {entry.group or entry.section: entry.note for entry in found.proposal.entries if entry.note}
    assert notes == {"material": "it has elements of its own", "add": "the material `m` does not exist"}
    assert (
        '  # not expressed: the material `m` does not exist\n  # - {to: world, xml: \'<geom name="shown"' in found.text
    )
    assert ("geom", "shown") in [(each.kind, each.name) for each in found.outcome.changes]


def test_a_part_that_is_not_there_is_told(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "tool.xml").write_text(TOOL)
    context = Context(folder=tmp_path)
    found = recover(tmp_path / "arm.xml", [tmp_path / "arm.xml", tmp_path / "tool.xml"], tmp_path / "o.yaml", context)
    assert found is not None and found.outcome is not None and found.outcome.same
    assert "base: ./arm.xml" in found.text and "attach" not in found.text
    assert [each.message.split(":")[0] for each in context.sink.diagnostics] == [
        "`arm.xml` has no body with the names of `tool.xml`"
    ]


def test_a_file_that_is_no_model_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text("<mujoco")
    context = Context(folder=tmp_path)
    assert recover(tmp_path / "arm.xml", [tmp_path / "gone.xml"], tmp_path / "o.yaml", context) is None
    assert {each.code for each in context.sink.errors} == {"xml-syntax", "file-not-found"}


@pytest.mark.parametrize(
    ("prefixes", "separator"), [(("a_", "b_"), "_"), (("a/", "b/"), "/"), (("a.", "b"), "/"), (("",), "/")]
)
def test_separator(tmp_path: Path, prefixes: tuple[str, ...], separator: str) -> None:
    (tmp_path / "tool.xml").write_text(TOOL)
    bodies = "".join(f'<body name="{prefix}palm"><geom size="1"/></body>' for prefix in prefixes)
    (tmp_path / "all.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    context = Context()
    units = [parse_file(tmp_path / name, context.sink) for name in ("all.xml", "tool.xml")]
    assert units[0] is not None and units[1] is not None
    found = find(units[0], [units[1]])
    assert [each.prefix for each in found] == list(prefixes) and separator_of(found) == separator


def test_a_prefix_that_was_not_there_is_taken_away_again(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "tool.xml").write_text(TOOL)
    tool = '<body name="palm"><geom name="palm" type="box" size="0.03 0.03 0.01"/></body></body></body>'
    (tmp_path / "all.xml").write_text(ARM.replace("</body>\n    </body>", tool))
    context = Context()
    units = [parse_file(tmp_path / f"{name}.xml", context.sink) for name in ("all", "arm", "tool")]
    merged, *parts = [unit for unit in units if unit is not None]
    found = propose(merged, parts, ["./arm.xml", "./tool.xml"], str)
    edits = [(entry.text, entry.note is None) for entry in found.entries if entry.section == "edit"]
    assert edits == [
        ("{select: {body: tool/palm}, rename: palm}", True),
        ("{select: {geom: tool/palm}, rename: palm}", True),
    ]
    assert not any(found.renamed.values())


@pytest.fixture
def menagerie() -> Path:
    root = os.environ.get("MENAGERIE_ROOT")
    if not root:
        pytest.skip("MENAGERIE_ROOT is not set")
    return Path(root)


@pytest.mark.slow
def test_panda_with_hand(menagerie: Path, tmp_path: Path) -> None:
    robot = menagerie / "franka_emika_panda"
    context = Context(folder=tmp_path)
    found = recover(
        robot / "panda.xml", [robot / "panda_nohand.xml", robot / "hand.xml"], tmp_path / "panda.yaml", context
    )
    assert found is not None and found.bundle is not None and not found.faults
    assert "body: link7, pos: [0, 0, 0.107]" in found.text
    assert found.outcome is not None and found.outcome.same


@pytest.mark.slow
def test_two_arms(menagerie: Path, tmp_path: Path) -> None:
    context = Context(folder=tmp_path)
    arm = menagerie / "trossen_vx300s" / "vx300s.xml"
    found = recover(menagerie / "aloha" / "aloha.xml", [arm], tmp_path / "aloha.yaml", context)
    assert found is not None and found.bundle is not None and not found.faults
    lines = [line.strip() for line in found.text.splitlines()]
    assert [line.partition("vx300s.xml")[2] for line in lines if "vx300s.xml" in line] == [
        f', pos: [{pose}, drop: [{{light: "**", parent: {{body: world}}, where: "${{name == \'\'}}"}}]}}'
        for pose in ("-0.469, -0.019, 0.02]", "0.469, -0.019, 0.02], quat: [0, 0, 0, 1]")
    ]
    assert any("select: {body: left/left_finger_link}, move: {to: left/gripper_base" in line for line in lines)
    assert found.outcome is not None and found.outcome.same and not any(entry.note for entry in found.proposal.entries)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("merged", "parts"),
    [
        ("franka_emika_panda/scene", ("franka_emika_panda/panda_nohand", "franka_emika_panda/hand")),
        ("aloha/scene", ("trossen_vx300s/vx300s",)),
        ("boston_dynamics_spot/spot_arm", ("boston_dynamics_spot/spot",)),
        ("ufactory_xarm7/xarm7", ("ufactory_xarm7/xarm7_nohand", "ufactory_xarm7/hand")),
    ],
)
def test_scenes_and_robots_that_were_merged_by_hand(
    merged: str, parts: tuple[str, ...], menagerie: Path, tmp_path: Path
) -> None:
    files = [menagerie / f"{name}.xml" for name in (merged, *parts)]
    found = recover(files[0], files[1:], tmp_path / "recipe.yaml", Context(folder=tmp_path))
    assert found is not None and found.outcome is not None and found.outcome.same


WITHOUT_NAMES = """
<mujoco model="part">
  <worldbody>
    <light pos="0 0 3"/>
    <body name="base">
      <geom size="0.1"/>
      <geom type="box" size="0.1 0.1 0.1" rgba="1 0 0 1"/>
      <geom type="capsule" size="0.1 0.2"/>
      <body name="link" pos="0 0 0.5"><joint name="turn"/><geom size="0.05"/></body>
      <body name="other" pos="0 1 0.5"><geom size="0.05"/></body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="base" body2="link"/>
  </contact>
  <keyframe><key name="home" qpos="1"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('<geom size="0.1"/>', "", '{geom: "**", parent: {body: base}, where: "${index == 0}"}, remove: true}'),
        ('rgba="1 0 0 1"', 'rgba="0 1 0 1"', 'where: "${index == 1}"}, set: {rgba: [0, 1, 0, 1]}}'),
        ('<geom size="0.1"/>', '<geom size="0.1"/><geom size="0.3"/>', "add:"),
        ("<exclude", "<!-- <exclude", "where: {body1: base, body2: link}}, remove: true}"),
        ('<light pos="0 0 3"/>', "", '{light: "**", parent: {body: world}, where: "${index == 0}"}, remove: true}'),
        ('<key name="home" qpos="1"/>', "", "{select: {key: home}, remove: true}"),
        ('<key name="home" qpos="1"/>', '<key name="new" qpos="2"/>', "new: {qpos: {turn: [2rad]}}"),
    ],
)
def test_what_has_no_name_is_found_by_its_place(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert old in WITHOUT_NAMES
    (tmp_path / "part.xml").write_text(WITHOUT_NAMES)
    changed = WITHOUT_NAMES.replace(old, new)
    if "<!--" in new:
        changed = changed.replace('body2="link"/>', 'body2="link"/> -->')
    (tmp_path / "all.xml").write_text(changed)
    found = recover(tmp_path / "all.xml", [tmp_path / "part.xml"], tmp_path / "recipe.yaml", Context(folder=tmp_path))
    assert found is not None and found.outcome is not None and found.outcome.same and said in found.text


NAMELESS_ARM = """<mujoco model="arm"><worldbody>
  <body pos="1 0 0"><geom size=".07"/></body>
  <body name="link1"><joint name="j1"/><geom size=".03"/>
    <body name="link2" pos="0 0 .1"><joint name="j2"/><geom size=".03"/><body pos=".1 0 0"><geom size=".01"/></body></body></body>
</worldbody><keyframe><key name="home" qpos=".1 .2"/></keyframe></mujoco>
"""
NAMELESS_BASE = """<mujoco model="base"><worldbody>
  <body pos="0 1 0"><geom size=".3"/></body>
  <body name="torso"><geom size=".1"/><body pos="0 0 .2"><geom size=".02"/><body pos="0 0 .1"/></body>
    <body name="leg" pos="0 0 -.2"><joint name="hip"/><geom size=".05"/></body></body>
</worldbody><keyframe><key name="home" qpos=".5"/></keyframe></mujoco>
"""


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", []),
        # Of a key that the parts share, the values of all of them stay.
        (
            'qpos=".5 .1 .2"',
            'qpos=".5 .3 .2"',
            ["keyframe:", "  home: {from: {base: home, arm: home}, qpos: {arm/j1: [0.3rad]}}"],
        ),
        (
            'size=".02"',
            'size=".025"',
            [
                "edit:",
                (
                    '  - {select: {geom: "**", parent: {body: "**", parent: {body: torso}, where: "${index == 0}"},'
                    ' where: "${index == 0}"}, set: {size: [.025]}}'
                ),
            ],
        ),
    ],
)
def test_bodies_without_a_name_come_with_their_part(old: str, new: str, expected: list[str], tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(NAMELESS_ARM)
    (tmp_path / "base.xml").write_text(NAMELESS_BASE)
    attached = "arm: {model: ./arm.xml, body: torso, pos: [0, 0.1, 0.3], euler: [10deg, 20deg, 30deg]}"
    (tmp_path / "all.yaml").write_text(f"recipe: 1\nname: all\nbase: ./base.xml\nattach:\n  {attached}\n")
    context = Context(folder=tmp_path)
    built = build(ModelRequest(tmp_path / "all.yaml"), context)
    assert built is not None
    text = built.bundle.files["model.xml"].decode()
    assert old in text
    (tmp_path / "merged.xml").write_text(text.replace(old, new) if old else text)
    parts = [tmp_path / "base.xml", tmp_path / "arm.xml"]
    found = recover(tmp_path / "merged.xml", parts, tmp_path / "found.yaml", context)
    assert found is not None and found.outcome is not None and found.outcome.same
    lines = found.text.splitlines()
    rest = [line for line in lines[lines.index("attach:") + 2 :] if line]
    assert rest == expected

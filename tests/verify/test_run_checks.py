"""The check `unchanged` of recipes, and what the manifest says of the parts, by building."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from mjcompose.base.diagnostic import Note
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.bundle.manifest import from_json
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import RequestLimits, Session
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.read import read_source
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.verify import parts

Run = Callable[[str], tuple[Built | None, list[str]]]

CUBE = """
<mujoco model="cube">
  <worldbody>
    <body name="cube" pos="0 0 1">
      <freejoint {name}/>
      <geom name="g" size=".1" mass="2"/>
      <body name="arm" pos=".2 0 0">
        <joint name="j" axis="0 1 0" range="-90 90" damping="3"/>
        <geom size=".05" friction=".5"/>
        <site name="tip" pos=".1 0 0" euler="0 30 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="a" joint="j" kp="5"/></actuator>
  <sensor><jointpos joint="j"/></sensor>
  <keyframe><key name="home" qpos="0 0 2 1 0 0 0 0.5"/></keyframe>
</mujoco>
"""
BASE = """
<mujoco model="base">
  <compiler angle="radian"/>
  <default><geom friction="0.3"/></default>
  <worldbody>
    <light pos="0 0 3"/><geom type="plane" size="1 1 1"/>
    <frame name="high" pos="0 0 1" euler="0 .3 0">
      <body name="b" euler="0.1 0 0">
        <joint name="h"/><geom size=".2"/>
        <frame name="inner" pos="0 0 .1" euler="0 0 .4"/>
        <site name="s" pos="0 0 .2" euler="0.5 0 0"/>
      </body>
    </frame>
  </worldbody>
  <keyframe><key name="home" qpos="0.25"/></keyframe>
</mujoco>
"""
FILES = {
    "cube.xml": CUBE.format(name='name="f"'),
    "cube2.xml": CUBE.format(name=""),
    "base.xml": BASE,
    "inner.yaml": """
recipe: 1
base: ./base.xml
attach:
  w: {model: ./cube.xml, site: s, joint: none, pos: [0.1, 0, 0], keys: prefix}
check:
  inside: {unchanged: {part: w}}
""",
}
EVERYTHING = """
recipe: 1
base: ./base.xml
attach:
  weld: {model: ./cube.xml, site: s, joint: none, pos: [0.1, 0, 0]}
  weld2: {model: ./cube2.xml, frame: inner, joint: none, euler: [0, 20deg, 0]}
  free: {model: ./cube.xml, pos: [3, 0, 0], euler: [0, 20deg, 0]}
  nokeys: {model: ./cube.xml, pos: [3, 0, 0], drop: [key]}
  nest: {model: ./inner.yaml, pos: [7, 0, 0], euler: [0, 0, 1rad]}
  nest2: {model: ./inner.yaml, pos: [9, 0, 0], keys: prefix}
  mated: {model: ./cube.xml, joint: none, body: nest/b, mate: tip}
  bare: {model: ./tool.xml, prefix: "", body: b}
  hinged: {model: ./tool.xml, body: b, joint: {type: hinge, axis: [0, 0, 1]}}
add:
  - {to: weld/arm, body: {name: extra, geom: {size: 0.3}}}
  - {to: b, geom: {size: 0.4}}
check:
  whole: {unchanged: {}}
"""
TOOL = """
<mujoco model="tool">
  <worldbody><geom name="tg" size=".1"/><body name="tb" pos="1 0 0"><joint/><geom size=".1"/></body></worldbody>
</mujoco>
"""
CHANGING = """
recipe: 1
base: ./base.xml
attach:
  part: {model: ./cube.xml, pos: [3, 0, 0]}
default:
  part/: {geom: {rgba: [1, 0, 0, 1]}, joint: {armature: 0.1}}
check:
"""


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Builds the text of a recipe; `LINE:COLUMN CODE` of every error."""
    for name, text in {**FILES, "tool.xml": TOOL}.items():
        (tmp_path / name).write_text(text)

    def run(text: str) -> tuple[Built | None, list[str]]:
        (tmp_path / "recipe.yaml").write_text(text.lstrip())
        context = Context(folder=tmp_path, environment={})
        built = build(ModelRequest(tmp_path / "recipe.yaml"), context)
        told = [
            f"{each.span.file}:{each.span.line}:{each.span.column} {each.code}" if each.span else each.code
            for each in context.sink.errors
        ]
        return built, told

    return run


def test_however_a_part_hangs_it_is_unchanged(run: Run) -> None:
    built, told = run(EVERYTHING)
    assert told == []
    assert built is not None
    members = {member.part: member for member in built.composed.members}
    assert list(members) == [
        "base",
        "weld",
        "weld2",
        "free",
        "nokeys",
        "nest/base",
        "nest/w",
        "nest2/base",
        "nest2/w",
        "mated",
        "bare",
        "hinged",
    ]
    assert [members[part].body for part in ("base", "weld", "nest/w", "hinged")] == [None, "b", "nest/b", "hinged/"]
    assert [members[part].keys for part in ("weld", "nokeys", "nest/w", "nest2/w", "nest2/base")] == [
        "",
        None,
        "w/",
        "nest2/w/",
        "nest2/",
    ]
    assert members["nest2/w"].prefix == "nest2/w/"
    manifest = from_json(built.bundle.files["manifest.json"])
    assert [part.part for part in manifest.parts] == list(members)
    assert [manifest.inputs[part.input].path for part in manifest.parts[:3]] == ["base.xml", "cube.xml", "cube2.xml"]


@pytest.mark.parametrize(
    ("check", "expected"),
    [
        ("a: {unchanged: {}}", ["recipe.yaml:8:7 part-changed"]),
        ("a: {unchanged: {part: part}}", ["recipe.yaml:8:25 part-changed"]),
        ("a: {unchanged: {part: base}}", []),
        ("a: {unchanged: {part: part, except: [rgba]}}", ["recipe.yaml:8:25 part-changed"]),
        ("a: {unchanged: {part: part, except: [rgba, armature]}}", []),
        ("a: {unchanged: {part: prt}}", ["recipe.yaml:8:25 unknown-name"]),
    ],
)
def test_what_the_recipe_changes_itself_is_told_unless_it_is_excepted(
    run: Run, check: str, expected: list[str]
) -> None:
    _, told = run(CHANGING + f"  {check}\n")
    assert told == expected


def test_what_the_recipe_changes_on_purpose_is_in_the_manifest(run: Run) -> None:
    built, _ = run(CHANGING.replace("check:", ""))
    assert built is not None
    base, part = from_json(built.bundle.files["manifest.json"]).parts
    assert base.changed == ()
    assert {"geom_rgba", "dof_armature"} <= set(part.changed)


def test_expected_and_actual_are_told(tmp_path: Path, run: Run) -> None:
    run(CHANGING + "  a: {unchanged: {}}\n")
    context = Context(folder=tmp_path, environment={})
    build(ModelRequest(tmp_path / "recipe.yaml"), context)
    (error,) = context.sink.errors
    assert error.message == (
        "check `a`: `part/` differs from `cube.xml` alone: 3 differences (`geom_rgba`, `dof_armature`)"
    )
    assert [note.message for note in error.notes] == [
        "geom `part/g`: `geom_rgba` is [1.0, 0.0, 0.0, 1.0], alone it is [0.5, 0.5, 0.5, 1.0]",
        "geom #0 of body `part/arm`: `geom_rgba` is [1.0, 0.0, 0.0, 1.0], alone it is [0.5, 0.5, 0.5, 1.0]",
        "joint `part/j`: `dof_armature` is 0.1, alone it is 0.0",
    ]
    assert error.help == "to accept it, write `except: [rgba, armature]`"


def test_the_help_names_the_attribute_that_the_array_follows_from(tmp_path: Path, run: Run) -> None:
    forces = "edit: [{select: {joint: part/j}, set: {actuatorfrcrange: [-1, 1], actuatorfrclimited: 'true'}}]"
    run(f"recipe: 1\nattach: {{part: {{model: ./cube.xml}}}}\n{forces}\ncheck: {{a: {{unchanged: {{}}}}}}\n")
    context = Context(folder=tmp_path, environment={})
    build(ModelRequest(tmp_path / "recipe.yaml"), context)
    (error,) = context.sink.errors
    assert error.help == "to accept it, write `except: [actuatorfrclimited]`"


def test_a_check_in_a_nested_recipe_is_told_there(tmp_path: Path, run: Run) -> None:
    inner = FILES["inner.yaml"].replace("check:", "default: {w/: {geom: {rgba: [1, 0, 0, 1]}}}\ncheck:")
    (tmp_path / "inner.yaml").write_text(inner.lstrip())
    _, told = run("recipe: 1\nattach:\n  nest: {model: ./inner.yaml}\n")
    assert told == ["inner.yaml:7:30 part-changed"]


def test_every_check_is_heard_in_order_with_what_came_of_it(tmp_path: Path, run: Run) -> None:
    run(EVERYTHING)
    heard: list[CheckOutcome] = []
    recipe = "recipe: 1\nattach:\n  nest: {model: ./inner.yaml}\ncheck:\n  both: {expect: {attr: nq, equals: 2}, settles: {max_speed: 9e9}}\n"
    (tmp_path / "recipe.yaml").write_text(recipe)
    context = Context(folder=tmp_path, environment={})
    assert build(ModelRequest(tmp_path / "recipe.yaml"), context, outcomes=heard) is not None, context.sink.diagnostics
    assert [(each.name, each.kind, each.span.file, each.span.line, each.holds) for each in heard] == [
        ("both", "expect", "recipe.yaml", 5, True),
        ("both", "settles", "recipe.yaml", 5, True),
        ("nest/inside", "unchanged", "inner.yaml", 7, True),
    ]


def test_a_check_that_takes_too_long_is_told_at_its_place(tmp_path: Path, run: Run) -> None:
    (tmp_path / "recipe.yaml").write_text(
        "recipe: 1\nbase: ./cube.xml\ncheck:\n  rest: {settles: {seconds: 1e9}}\n  have: {expect: {select: {body: cube}}}\n"
    )
    context = Context(folder=tmp_path, environment={})
    with Session(RequestLimits(seconds=3)) as session:
        assert build(ModelRequest(tmp_path / "recipe.yaml"), context, session=session) is None
    (late,) = context.sink.errors
    assert late.code == "mujoco-timeout"
    assert late.span is not None and late.span.line == 4
    assert late.notes == (Note("no check behind it was run"),)


def test_a_target_in_a_nested_recipe_is_in_that_one_s_world(tmp_path: Path, run: Run) -> None:
    (tmp_path / "aim.yaml").write_text(
        "recipe: 1\nbase: ./cube.xml\ncheck:\n  aim: {reachable: {site: tip, target: [0.2, 0, 1.1]}}\n"
        "  not: {reachable: {site: tip, target: [5, 0, 1]}}\n"
    )
    place = "site: s, joint: none, pos: [0.1, 0, 0], euler: [40deg, 0, 10deg]"
    _, told = run(f"recipe: 1\nbase: ./base.xml\nattach:\n  a: {{model: ./aim.yaml, {place}}}\n")
    assert told == ["aim.yaml:5:40 check-failed"]


def test_what_takes_elements_away_cannot_be_compared(run: Run) -> None:
    recipe = "recipe: 1\nbase: ./tool.xml\ncompiler: {discardvisual: true}\ncheck: {a: {unchanged: {}}}\n"
    _, told = run(recipe)
    assert told == ["recipe.yaml:4:13 part-not-compared"]


@pytest.mark.own_children
def test_a_build_starts_mujoco_once(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[Session] = []
    spawn = Session._spawn

    def counted(self: Session) -> None:
        started.append(self)
        spawn(self)

    monkeypatch.setattr(Session, "_spawn", counted)
    recipe = "recipe: 1\nattach:\n  a: {model: ./heavy.xml}\ncheck: {a: {unchanged: {}}}\n"
    folder = Path(run("recipe: 1\nbase: ./base.xml")[0].plan.path).parent  # type: ignore[union-attr]
    (folder / "heavy.xml").write_text(TOOL.replace("<worldbody>", '<compiler settotalmass="9"/><worldbody>'))
    started.clear()
    built, told = run(recipe)
    assert built is not None, told
    assert len(started) == 1


WHOLE = """<mujoco model="whole">
  <compiler settotalmass="9" angle="radian"/>
  <default><joint range="0 2"/><default class="c"><geom rgba="1 0 0 1" mass="1"/></default></default>
  <worldbody><body name="root"><joint name="root"/><geom size=".1"/>
    <body childclass="c" pos="0 0 1"><joint type="slide"/><geom size=".1"/>
      <frame euler="0 0 1"><body name="hand" pos="0 1 0">
        <joint name="hand"/><geom name="palm" size=".1"/><site name="palm"/>
      </body></frame></body></body></worldbody>
  <actuator><motor name="root" joint="root"/><motor name="hand" joint="hand"/></actuator>
  <keyframe><key name="k" qpos=".1 .2 .3" ctrl="4 5"/></keyframe></mujoco>"""


@pytest.mark.parametrize("keys", ["keys: merge", "keys: prefix", "drop: [key]"])
def test_a_subtree_is_compared_with_that_body_of_its_source(tmp_path: Path, run: Run, keys: str) -> None:
    run("recipe: 1\nbase: ./base.xml\n")
    (tmp_path / "whole.xml").write_text(WHOLE)
    part = f"{{model: ./whole.xml, subtree: hand, pos: [1, 0, 0], {keys}}}"
    recipe = f"recipe: 1\nbase: ./base.xml\nattach:\n  a: {part}\ncheck: {{a: {{unchanged: {{part: a}}}}}}\n"
    built, told = run(recipe)
    assert built is not None, told
    assert told == []
    _, told = run(f"{recipe}edit:\n  - {{select: {{geom: a/palm}}, set: {{size: [0.2]}}}}\n")
    assert told == ["recipe.yaml:5:31 part-changed"]


def test_subtrees_of_one_source_compile_it_once(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    names = [f"b{number}" for number in range(5)]
    bodies = "".join(f'<body name="{name}"><geom size=".1"/></body>' for name in names)
    (tmp_path / "whole.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    read: list[Path] = []
    compiled: list[int] = []

    def count_read(source: Source, *words: object, **options: object) -> object:
        read.append(source.path)
        return read_source(source, *words, **options)  # type: ignore[arg-type]

    def count_compiled(folder: Path, *words: object, **options: object) -> object:
        model = engine.compile(folder, *words, **options)  # type: ignore[arg-type]
        compiled.append(model.sizes["nbody"])
        return model

    monkeypatch.setattr(parts, "read_source", count_read)
    monkeypatch.setattr(parts, "engine", SimpleNamespace(compile=count_compiled, call=engine.call))
    attached = "".join(f"  {name}: {{model: ./whole.xml, subtree: {name}}}\n" for name in names)
    checked = "".join(f"  {name}: {{unchanged: {{}}}}\n" for name in names)
    built, _ = run(f"recipe: 1\nattach:\n{attached}check:\n{checked}")
    assert built is not None
    assert len(read) == 1
    assert sorted(compiled) == [2, 2, 2, 2, 2, 6]


def test_what_a_subtree_leaves_behind_may_have_acted_on_it(tmp_path: Path, run: Run) -> None:
    """A tendon with an armature is inertia that the body's joints feel in the whole model."""
    run("recipe: 1\nbase: ./base.xml\n")
    bodies = [f'<body name="{x}" pos="{x} 0 0"><joint name="{x}"/><geom size=".1" pos=".3 .2 0"/></body>' for x in "12"]
    both = '<joint joint="1" coef="1"/><joint joint="2" coef="1"/>'
    tendon = f'<tendon><fixed name="t" armature="1">{both}</fixed></tendon>'
    (tmp_path / "whole.xml").write_text(f"<mujoco><worldbody>{''.join(bodies)}</worldbody>{tendon}</mujoco>")
    recipe = "recipe: 1\nattach:\n  a: {model: ./whole.xml, subtree: '1'}\ncheck: {a: {unchanged: {}}}\n"
    built, told = run(recipe)
    assert built is not None, told


def test_the_body_below_a_subtree_may_be_fused_away_in_its_source(tmp_path: Path, run: Run) -> None:
    run("recipe: 1\nbase: ./base.xml\n")
    fused = WHOLE.replace('settotalmass="9"', 'fusestatic="true"').replace('<joint type="slide"/>', "")
    (tmp_path / "whole.xml").write_text(fused.replace('qpos=".1 .2 .3"', 'qpos=".1 .3"'))
    part = "{model: ./whole.xml, subtree: hand, pos: [0, 1, 0]}"
    built, told = run(f"recipe: 1\nattach:\n  a: {part}\ncheck: {{a: {{unchanged: {{}}}}}}\n")
    assert built is not None, told


def test_what_a_subtree_has_lost_on_the_way_is_told(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if the class that was in force around the body had not come along: the body alone differs from the whole."""
    run("recipe: 1\nbase: ./base.xml\n")
    (tmp_path / "whole.xml").write_text(WHOLE)
    monkeypatch.setattr("mjcompose.link.subtree.childclass_of", lambda body: None)
    _, told = run("recipe: 1\nattach:\n  a: {model: ./whole.xml, subtree: hand}\ncheck: {a: {unchanged: {}}}\n")
    assert told == ["recipe.yaml:4:13 part-changed"]


def test_of_a_subtree_of_a_recipe_it_is_said_that_it_cannot_be_compared(tmp_path: Path, run: Run) -> None:
    run("recipe: 1\nbase: ./base.xml\n")
    (tmp_path / "inner.yaml").write_text("recipe: 1\nbase: ./cube.xml\n")
    recipe = "recipe: 1\nattach:\n  a: {model: ./inner.yaml, subtree: arm}\ncheck: {a: {unchanged: {}}}\n"
    _, told = run(recipe)
    assert "recipe.yaml:4:13 part-not-compared" in told


def test_assets_that_were_merged_are_the_ones_that_stand_for_them(tmp_path: Path, run: Run) -> None:
    run("recipe: 1\nbase: ./base.xml\n")
    mesh = '<mujoco model="m"><asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>'
    (tmp_path / "m.xml").write_text(
        mesh + '<worldbody><body name="b"><geom type="mesh" mesh="t"/></body></worldbody></mujoco>'
    )
    (tmp_path / "recipe.yaml").write_text(
        "recipe: 1\nattach:\n  a: {model: ./m.xml}\n  b: {model: ./m.xml}\ncheck: {a: {unchanged: {}}}\n"
    )
    context = Context(folder=tmp_path, environment={})
    built = build(ModelRequest(tmp_path / "recipe.yaml", deduplicated=True), context)
    assert built is not None, context.sink.diagnostics
    assert built.composed.merged == {"mesh": {"b/t": "a/t"}}


def test_urdf_is_compared_with_what_mujoco_makes_of_it_in_that_place(tmp_path: Path, run: Run) -> None:
    inertial = '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<collision><geometry><box size=".1 .1 .1"/></geometry></collision>'
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="arm"><link name="base">{inertial}{shape}</link><link name="tip">{inertial}{shape}</link>'
        '<joint name="j" type="continuous"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/></joint></robot>'
    )
    parts = "  a: {model: ./arm.urdf, body: tip}\n  b: {model: ./arm.urdf, joint: free, pos: [0, 0, 3]}\n"
    built, told = run(f"recipe: 1\nbase: ./arm.urdf\nattach:\n{parts}check: {{a: {{unchanged: {{}}}}}}\n")
    assert told == []
    assert built is not None
    assert [member.is_fixed_in_world for member in built.composed.members] == [True, False, False]

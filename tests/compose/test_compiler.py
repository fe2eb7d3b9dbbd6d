"""`compiler` next to a `model`: MuJoCo's own reading of a file that a `<compiler>` begins."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.write import write
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.describe import as_data, describe
from mjcompose.plan.planner import make_plan
from mjcompose.plan.read import files_of_source
from mjcompose.sources.context import Context
from mjcompose.verify.stored import verify_stored

FRAGMENT = """<mujoco model="claw">{compiler}
  <asset><mesh name="tip" file="tip.obj"/></asset>
  <worldbody>
    <body name="palm" euler="0.1 0.2 0.3"><geom name="palm" size="0.1 0.05 0.02" type="box"/>
      <body name="finger" pos="0 0 0.1">
        <joint name="hinge" axis="0 1 0" range="-0.4 0.7" ref="0.1" springref="0.2" limited="auto"/>
        <geom name="tip" type="mesh" mesh="tip" axisangle="0 1 0 0.5"/>
        <geom name="ghost" size="0.3" group="4"/>
      </body>
      <body name="light" pos="0.3 0 0"><joint name="slide" type="slide" axis="1 0 0" range="0 0.1"/>
        <geom size="0.001" mass="0.0001"/></body>
    </body>
  </worldbody>
  <actuator><position name="hinge" joint="hinge" inheritrange="1"/></actuator>
</mujoco>"""
TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SETTINGS: dict[str, dict[str, Any]] = {
    "an angle": {"angle": "radian"},
    "a folder": {"angle": "radian", "meshdir": "shapes"},
    "a sequence": {"angle": "degree", "eulerseq": "ZYX"},
    "masses": {"angle": "radian", "boundmass": 0.01, "boundinertia": 1e-4},
    "a total": {"settotalmass": 3},
    "groups": {"angle": "radian", "inertiagrouprange": [0, 3]},
    "limits": {"angle": "radian", "autolimits": True},
}  # fmt: skip
FIELDS = (
    "jnt_range",
    "qpos0",
    "qpos_spring",
    "body_mass",
    "body_inertia",
    "body_ipos",
    "body_quat",
    "geom_quat",
    "geom_size",
    "actuator_ctrlrange",
    "jnt_limited",
)


def written(settings: dict[str, Any]) -> str:
    def text(value: Any) -> str:
        if isinstance(value, list):
            return " ".join(map(text, value))
        return str(value).lower() if isinstance(value, bool) else str(value)

    pairs = [f'{name}="{text(value)}"' for name, value in settings.items()]
    return f"<compiler {' '.join(pairs)}/>"


def lay(folder: Path, compiler: str = "") -> None:
    for place in (folder, folder / "shapes"):
        place.mkdir(exist_ok=True)
        (place / "tip.obj").write_text(TETRAHEDRON, encoding="utf-8")
    (folder / "claw.xml").write_text(FRAGMENT.format(compiler=compiler), encoding="utf-8")


def built(folder: Path, recipe: str) -> tuple[Built | None, Context]:
    (folder / "recipe.yaml").write_text(f"recipe: 1\nallow: [license-missing]\n{recipe}\n", encoding="utf-8")
    context = Context(environment={}, folder=folder)
    return build(ModelRequest(folder / "recipe.yaml"), context), context


def compiled(made: Built, folder: Path) -> mujoco.MjModel:
    write(made.bundle, f"{folder / 'out'}/", environment={})
    return mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml"))


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.parametrize("is_part", [False, True], ids=["base", "part"])
def test_it_is_read_as_if_it_began_with_it(tmp_path: Path, settings: dict[str, Any], is_part: bool) -> None:
    lay(tmp_path)
    (tmp_path / "alone.xml").write_text(FRAGMENT.format(compiler=written(settings)), encoding="utf-8")
    expected = mujoco.MjModel.from_xml_path(str(tmp_path / "alone.xml"))
    model = json.dumps({"model": "./claw.xml", "compiler": settings})
    recipe = f"attach: {{a: {model}}}" if is_part else f"base: {model}"
    made, context = built(tmp_path, f"{recipe}\ncheck: {{same: {{unchanged: {{}}}}}}")
    assert made is not None and {each.code for each in context.sink.diagnostics} <= {"mujoco-warning"}
    found = compiled(made, tmp_path)
    for name in FIELDS:
        assert np.allclose(getattr(found, name), getattr(expected, name), rtol=1e-9, atol=1e-12), name
    with Session() as session:
        stored = verify_stored(tmp_path / "out", Context(environment={}, folder=tmp_path), session)
    assert stored is not None and [part.ok for part in stored.parts] == [True]


def test_two_parts_of_one_file_have_settings_of_their_own(tmp_path: Path) -> None:
    lay(tmp_path)
    parts = "a: {model: ./claw.xml, compiler: {angle: radian}}, b: {model: ./claw.xml, pos: [2, 0, 0]}"
    made, _ = built(tmp_path, f"attach: {{{parts}}}")
    assert made is not None
    model = compiled(made, tmp_path)
    assert np.allclose(model.joint("a/hinge").range, [-0.4, 0.7])
    assert np.allclose(model.joint("b/hinge").range, np.radians([-0.4, 0.7]))


def test_a_subtree_of_it(tmp_path: Path) -> None:
    lay(tmp_path)
    part = "{model: ./claw.xml, subtree: finger, compiler: {angle: radian, meshdir: shapes}}"
    made, context = built(tmp_path, f"attach: {{a: {part}}}\ncheck: {{same: {{unchanged: {{}}}}}}")
    assert made is not None, context.sink.diagnostics
    assert np.allclose(compiled(made, tmp_path).joint("a/hinge").range, [-0.4, 0.7])


@pytest.mark.parametrize("own", ['<compiler angle="degree"/>', '<compiler eulerseq="ZYX"/><compiler angle="degree"/>'])
def test_the_file_wins_and_the_recipe_says_so(tmp_path: Path, own: str) -> None:
    lay(tmp_path, own)
    made, context = built(tmp_path, "base: {model: ./claw.xml, compiler: {angle: radian, boundmass: 0.01}}")
    assert made is not None
    assert [each.code for each in context.sink.diagnostics] == ["compiler-unused"]
    model = compiled(made, tmp_path)
    assert np.allclose(model.joint("hinge").range, np.radians([-0.4, 0.7])) and model.body("light").mass[0] == 0.01


def test_an_included_file_wins_too(tmp_path: Path) -> None:
    lay(tmp_path, '<include file="settings.xml"/>')
    text = '<mujocoinclude><compiler angle="radian"/></mujocoinclude>'
    (tmp_path / "settings.xml").write_text(text, encoding="utf-8")
    made, context = built(tmp_path, "base: {model: ./claw.xml, compiler: {angle: degree}}")
    assert made is not None and [each.code for each in context.sink.diagnostics] == ["compiler-unused"]
    assert np.allclose(compiled(made, tmp_path).joint("hinge").range, [-0.4, 0.7])


def test_a_variant_with_another_model_drops_it(tmp_path: Path) -> None:
    lay(tmp_path)
    (tmp_path / "other.xml").write_text(FRAGMENT.format(compiler=""), encoding="utf-8")
    recipe = "base: {model: ./claw.xml, compiler: {angle: radian}}\nvariants: {v: {other: {base: ./other.xml}}}"
    made, context = built(tmp_path, recipe)
    assert made is not None, context.sink.diagnostics
    assert np.allclose(compiled(made, tmp_path).joint("hinge").range, np.radians([-0.4, 0.7]))


def test_what_knows_the_files_of_a_recipe_knows_it(tmp_path: Path) -> None:
    lay(tmp_path)
    recipe = "params: {unit: radian}\nbase: {model: ./claw.xml, compiler: {angle: '${unit}', meshdir: shapes}}"
    made, _ = built(tmp_path, recipe)
    assert made is not None
    plan = make_plan(tmp_path / "recipe.yaml", Context(environment={}, folder=tmp_path))
    assert plan is not None
    assert 'read with <compiler angle="radian" meshdir="shapes"/>' in describe(plan)
    assert as_data(plan)["base"]["compiler"] == {"angle": "radian", "meshdir": "shapes"}
    manifest = json.loads(made.bundle.files["manifest.json"])
    assert manifest["inputs"][0]["compiler"] == {"angle": "radian", "meshdir": "shapes"}
    assert {tmp_path / "shapes" / "tip.obj"} <= {*files_of_source(next(iter(plan.sources())))}


def test_a_stored_bundle_cannot_smuggle_settings(tmp_path: Path) -> None:
    lay(tmp_path)
    made, _ = built(tmp_path, "base: {model: ./claw.xml, compiler: {angle: radian}}")
    assert made is not None
    compiled(made, tmp_path)
    path = tmp_path / "out" / "manifest.json"
    (tmp_path / "recipe.yaml").unlink()
    for settings in ({"angle": "radian", "no such": "1"}, {"angle": "\u0001"}, {"meshdir": "/"}, {"angle": "degree"}):
        manifest = json.loads(path.read_bytes())
        manifest["inputs"][0]["compiler"] = settings
        path.write_text(json.dumps(manifest), encoding="utf-8")
        with Session() as session:
            stored = verify_stored(tmp_path / "out", Context(environment={}, folder=tmp_path), session)
        assert stored is not None and not stored.parts[0].ok


URDF = """<robot name="r"><link name="base"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="tip"><collision><geometry><mesh filename="tip.obj"/></geometry></collision></link>
  <joint name="j" type="fixed"><parent link="base"/><child link="tip"/></joint></robot>"""


def test_a_urdf(tmp_path: Path) -> None:
    lay(tmp_path)
    (tmp_path / "tip.obj").unlink()
    (tmp_path / "r.urdf").write_text(URDF, encoding="utf-8")
    made, context = built(tmp_path, "base: {model: ./r.urdf, compiler: {meshdir: shapes, fusestatic: false}}")
    assert made is not None, context.sink.diagnostics
    assert compiled(made, tmp_path).body("tip").id > 0
    text = URDF.replace('<robot name="r">', '<robot name="r"><mujoco><compiler fusestatic="true"/></mujoco>')
    (tmp_path / "r.urdf").write_text(text, encoding="utf-8")
    made, context = built(tmp_path, "base: {model: ./r.urdf, compiler: {meshdir: shapes, fusestatic: false}}")
    assert made is not None and "compiler-unused" in [each.code for each in context.sink.diagnostics]


BASE = """<mujoco><compiler {}/><worldbody><body name="b"><joint axis="0 1 0"/><geom size="0.001" mass="1e-6"/></body>
</worldbody></mujoco>"""
BODY = "{to: world, body: {name: cup, freejoint: {}, geom: {size: [0.001], mass: 0.000001}}}"


@pytest.mark.parametrize(
    ("rules", "recipe", "is_noted"),
    [
        ('boundmass="0.001" boundinertia="0.0001"', f"add: [{BODY}]", True),
        ('settotalmass="2"', f"add: [{BODY}]", True),
        ('boundmass="0.001"', f"add: [{BODY}]\ncompiler: {{boundmass: 0.001}}", False),  # the whole model has it
        ('boundmass="0.001"', "add: [{to: b, site: {name: s}}]", False),
        ('angle="radian"', f"add: [{BODY}]", False),
        ('boundmass="0.001"', "add: [{to: world, frame: {name: f, body: {name: cup, geom: {size: [1]}}}}]", True),
    ],
)
def test_rules_of_the_base_do_not_reach_added_bodies(tmp_path: Path, rules: str, recipe: str, is_noted: bool) -> None:
    (tmp_path / "base.xml").write_text(BASE.format(rules), encoding="utf-8")
    made, context = built(tmp_path, f"base: ./base.xml\n{recipe}")
    assert made is not None
    notes = [each for each in context.sink.diagnostics if each.code == "mass-rule"]
    assert bool(notes) is is_noted
    if is_noted and "settotalmass" not in rules and "freejoint" in recipe:
        assert compiled(made, tmp_path).body("cup").mass[0] == pytest.approx(1e-6)
        help = str(notes[0].help).partition("`")[2].partition("`")[0]
        made, context = built(tmp_path, f"base: ./base.xml\n{recipe}\n{help}")
        assert made is not None and not context.sink.diagnostics
        assert compiled(made, tmp_path).body("cup").mass[0] == pytest.approx(1e-3)

"""The plain text: MuJoCo reads back the same model."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.bundle.write import write
from mjcompose.language.target_names import MUJOCO, NAMES
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.targets.plain import plain
from mjcompose.targets.same import differences
from sampling import rest_slow
from targets.models import RECIPES, SELDOM
from targets.writing import codes, compiled, written

GONE = ("frame", "default", "replicate", "include", "attach", "flexcomp", "composite")
SHIPPED = sorted(path.stem for path in RECIPES.glob("*.yaml"))
CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
MODELS = sorted(Path(CORPUS, "feature-cases").glob("*/*.xml")) if CORPUS else []
OWN = sorted((Path(__file__).parents[1] / "feature_cases").glob("*/*.xml"))
NOT_SAVED = {"32-odd-names/base"}
"""MuJoCo 4.0 saves a tab in a name as it is, which is read as a space: an error of the build."""
if mujoco.__version__.startswith("3."):  # it loses classes, the order of joints and the frames of keys
    NOT_SAVED |= {
        "13-classes-called-main/base",
        "13-classes-called-main/part",
        "14-order-of-actuators-in-classes/base",
        "45-joints-after-children/base",
        "80-later-default-and-angles/base",
        "82-keys-of-several-attached-models/base",
    }


def test_nothing_is_left_to_expand(tmp_path: Path) -> None:
    bundle, context = written(SELDOM, "plain", tmp_path)
    assert bundle is not None and codes(context) == []
    root = etree.fromstring(bundle.files["model.xml"])
    assert not [each.tag for each in root.iter(*GONE)]
    assert not root.xpath("//@class | //@childclass | //@fromto | //@euler")
    assert all(body.find("inertial") is not None for body in root.iterfind(".//body"))
    model = compiled(bundle, tmp_path / "out")
    assert model.joint("turn").qpos0 == pytest.approx(0.349065850)
    assert [model.actuator(n).name for n in range(model.nu)] == ["turn", "slide"]
    assert [each.tag for each in root.find("actuator")] == ["position", "motor"]  # type: ignore[union-attr]


def test_a_site_outside_of_the_class_of_its_body(tmp_path: Path) -> None:
    """MuJoCo 3.12 does not save `class="main"`."""
    classes = '<default><default class="a"><site group="4" rgba="1 0 0 1"/></default></default>'
    body = '<body name="b" childclass="a"><geom size=".1"/><site name="in"/><site name="out" class="main"/></body>'
    text = f"<mujoco>{classes}<worldbody>{body}</worldbody></mujoco>"
    bundle, context = written(text, "plain", tmp_path)
    assert bundle is not None, codes(context)
    before = mujoco.MjModel.from_xml_string(text)
    after = compiled(bundle, tmp_path / "out")
    for array in ("site_group", "site_rgba"):
        assert getattr(after, array).tolist() == getattr(before, array).tolist()


@pytest.mark.parametrize("name", rest_slow(SHIPPED, ("demo", "gantry", "soft_arm"), lambda name: name))
def test_every_recipe(
    name: str, tmp_path: Path, simple_robots: Path, menagerie_root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = RECIPES / f"{name}.yaml"
    monkeypatch.setattr("mjcompose.verify.run_checks.checks_in", lambda plan: iter(()))  # they measure robots
    root = menagerie_root if recipe.with_suffix(".lock").exists() else simple_robots  # a lock knows the meshes
    context = Context(environment={**os.environ, "MENAGERIE_ROOT": str(root)})
    built = build(ModelRequest(recipe, target="plain"), context)
    if built is None and any(each.code == "source-not-found" for each in context.sink.errors):
        pytest.skip("a robot of this recipe is not installed")
    assert built is not None, codes(context)
    write(built.bundle, f"{tmp_path}/out/", environment={})
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml")).nbody > 1


@pytest.mark.parametrize("path", [*OWN, *MODELS], ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_every_feature(path: Path, tmp_path: Path) -> None:
    try:
        mujoco.MjSpec.from_file(str(path)).compile()
    except ValueError:
        pytest.skip("it is a part that does not compile alone")
    if f"{path.parent.name}/{path.stem}" in NOT_SAVED:
        pytest.skip("MuJoCo saves another model")
    draft = plain(mujoco, path)
    for name, content in draft.files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(content)
    (tmp_path / "model.xml").write_bytes(etree.tostring(draft.root))
    again = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    assert list(differences(draft.model, again)) == []


@pytest.mark.parametrize("target", [name for name in NAMES if name != MUJOCO])
def test_an_empty_body_in_a_frame(target: str, tmp_path: Path) -> None:
    """MuJoCo takes the place of such a body, in its frame or without it, for its center of mass."""
    text = """<mujoco><worldbody><frame pos="0 1 1" euler="30 0 0"><body name="mount" pos=".1 0 0"><body name="hinge" pos=".2 0 0">
      <body name="door"><joint name="j"/><geom size=".1"/></body></body></body></frame></worldbody></mujoco>"""
    bundle, context = written(text, target, tmp_path)
    assert bundle is not None and not context.sink.has_errors


def test_what_differs_is_told() -> None:
    text = "<mujoco><worldbody><body><joint {}/><geom size='.1' pos='{} 0 0'/></body></worldbody></mujoco>"
    one, other = (
        mujoco.MjModel.from_xml_string(text.format(*each)) for each in (("damping='1'", 0), ("damping='2'", 0.5))
    )
    told = list(differences(one, other))
    assert any(each.startswith("`dof_damping`, row 0: 2.0, not 1.0") for each in told)
    assert any(each.startswith("`geom_pos`") for each in told)
    assert list(differences(one, one)) == []


def test_a_bias_that_is_not_used_may_differ() -> None:
    text = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody><actuator><{}/></actuator></mujoco>"
    for actuator, is_same in (("motor joint='j'", True), ("position joint='j'", False)):
        one, other = (mujoco.MjModel.from_xml_string(text.format(actuator)) for _ in range(2))
        other.actuator_biasprm[0, 2] = -30
        assert (list(differences(one, other)) == []) is is_same


QUAD = """<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3"
  texcoord="0 0 1 0 0 1 {}"/></asset><worldbody><body><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


def test_meshes_are_compared_by_their_faces() -> None:
    one, other = (mujoco.MjModel.from_xml_string(QUAD.format(each)) for each in ("1 1", "0.5 1"))
    assert list(differences(one, other)) == ["the texture coordinates of geom #0 of body `#1` is up to 0.5 off"]
    turned = mujoco.MjModel.from_xml_string(QUAD.format("1 1").replace("0 2 1 0 1 3", "0 1 3 0 2 1"))
    assert any(each.startswith("the surface of geom") for each in differences(one, turned))

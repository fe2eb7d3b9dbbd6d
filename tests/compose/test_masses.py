"""Masses under the compiler's rules: what an edit or a draw says is what MuJoCo compiles."""

from __future__ import annotations

from pathlib import Path

import mjcompose
import mujoco
import pytest

ARM = """
<mujoco model="arm"><compiler {rules}/>
  <worldbody><body name="root"><geom size=".05" mass="0.7"/>
    <body name="upper"><joint name="j" axis="0 1 0"/>{inertial}
      <geom size=".1" mass="1" group="0"/><geom size=".1" mass="2.1" group="3" pos=".2 0 0"/>
      <body name="plate" pos="0 0 .5"><geom type="box" size=".1 .1 .1" mass="2"/>
        <body name="bolt" pos="0 0 .1"><geom size=".02" mass="0.25"/></body></body>
      <body name="fore" pos="1 0 0"><joint name="k" axis="0 1 0"/><geom size=".1" mass="3"/></body></body></body></worldbody>
</mujoco>"""
RULES = [
    'settotalmass="9"',
    'boundmass="2.5"',
    'boundinertia="0.4"',
    'balanceinertia="true"',
    'inertiagrouprange="0 1"',
    'fusestatic="true"',
    'inertiafromgeom="true"',
    'fusestatic="true" inertiagrouprange="0 2"',
    'discardvisual="true"',
]
RECIPES = {
    "the edit of a part": "attach: {{a: {{model: ./arm.xml, edit: [{{select: {{body: upper}}, {0}}}]}}}}",
    "the edit of a part on a joint": "attach: {{a: {{model: ./arm.xml, joint: free, edit: [{{select: {{body: upper}}, {0}}}]}}}}",
    "the edit of the base": "base: {{model: ./arm.xml, edit: [{{select: {{body: upper}}, {0}}}]}}",
    "an edit of the base alone": "base: ./arm.xml\nedit: [{{select: {{body: upper}}, {0}}}]",
    "an edit of the whole": "attach: {{a: {{model: ./arm.xml}}}}\nedit: [{{select: {{body: a/upper}}, {0}}}]",
}
VERBS = {
    "set: {mass: 5}": lambda mass: 5,
    "scale: {mass: 1.5}": lambda mass: 1.5 * mass,
    'set: {mass: "${value + 2}"}': lambda mass: mass + 2,
}


def masses(model: mujoco.MjModel) -> dict[str, float]:
    return {model.body(n).name.removeprefix("a/"): float(model.body_mass[n]) for n in range(1, model.nbody)}


def composed(folder: Path, rules: str, recipe: str, inertial: str = "") -> tuple[dict[str, float], dict[str, float]]:
    """Return the masses of the file alone, and of the recipe."""
    (folder / "arm.xml").write_text(ARM.format(rules=rules, inertial=inertial))
    (folder / "r.yaml").write_text(f"recipe: 1\nallow: [license-missing]\n{recipe}\n")
    return masses(mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))), masses(mjcompose.model(folder / "r.yaml"))


@pytest.mark.parametrize("rules", RULES)
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("place", RECIPES)
def test_a_mass_means_what_mujoco_compiles(tmp_path: Path, place: str, verb: str, rules: str) -> None:
    alone, found = composed(tmp_path, rules, RECIPES[place].format(verb))
    assert found["upper"] == pytest.approx(VERBS[verb](alone["upper"]))
    others = {name: mass for name, mass in found.items() if name not in ("upper", "a/")}
    if "settotalmass" not in rules or "alone" not in place:
        assert others == pytest.approx({name: alone.get(name, mass) for name, mass in others.items()})


@pytest.mark.parametrize(
    "rules", ['settotalmass="9"', 'boundmass="2.5"', 'inertiagrouprange="0 1"', 'fusestatic="true"']
)
@pytest.mark.parametrize("operation", ["", "scale: "])
def test_a_drawn_mass_means_what_mujoco_compiles(tmp_path: Path, rules: str, operation: str) -> None:
    draw = "{scale: {uniform: [2, 2]}}" if operation else "{uniform: [6, 6]}"
    fields = f"fields: {{m: {{select: {{body: upper}}, attr: mass, {draw[1:-1]}}}}}"
    alone, _ = composed(tmp_path, rules, f"base: ./arm.xml\nrandomize: {{seed: 1, samples: 2, {fields}}}")
    drawn = masses(mjcompose.model(tmp_path / "r.yaml", sample=1))
    assert drawn["upper"] == pytest.approx(2 * alone["upper"] if operation else 6)


def test_bodies_that_are_fused_change_with_their_host(tmp_path: Path) -> None:
    for verb, factor in (("scale: {mass: 2}", 2), ("scale: {mass: 0.5}", 0.5)):
        edit = f'base: ./arm.xml\nedit: [{{select: {{body: "**"}}, {verb}}}]'
        alone, found = composed(tmp_path, 'fusestatic="true"', edit)
        assert found["upper"] == pytest.approx(factor * alone["upper"])
        assert found["fore"] == pytest.approx(factor * alone["fore"])
    with pytest.raises(mjcompose.BuildError, match="`fusestatic` makes it part of body `upper`"):
        composed(tmp_path, 'fusestatic="true"', "base: ./arm.xml\nedit: [{select: {body: plate}, set: {mass: 3}}]")


def test_an_inertial_that_the_file_ignores_is_not_the_mass(tmp_path: Path) -> None:
    inertial = '<inertial pos="0 0 0" mass="40" diaginertia="1 1 1"/>'
    edit = RECIPES["the edit of a part"].format("set: {mass: 5}")
    alone, found = composed(tmp_path, 'inertiafromgeom="true"', edit, inertial)
    assert alone["upper"] < 40 and found["upper"] == pytest.approx(5)


def test_an_inertia_from_geoms_counts_fused_bodies_once(tmp_path: Path) -> None:
    edit = "base: ./arm.xml\nedit: [{select: {body: upper}, inertia: {from: geoms, density: 100, group: 0}}]"
    _, found = composed(tmp_path, 'fusestatic="true"', edit)
    assert found["upper"] == pytest.approx(100 * 4 / 3 * 3.141592653589793 * 0.1**3 + 2.25)

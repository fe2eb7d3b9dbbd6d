"""`samples.csv` and `randomize.json` of `--as worlds`: what was drawn, and which numbers of mjModel it changes.

Numbers that follow from a drawn pose, compared with what MuJoCo compiles from the pose itself.
"""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.staging import write_folder
from mjcompose.mujoco.settable import DerivedValues, are_close
from mjcompose.mujoco.varying import flat
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.verify.draws import _following

MODEL = """\
<mujoco>
  <compiler angle="radian" inertiafromgeom="true"/>
  <default><geom friction="0.8"/></default>
  <worldbody>
    <camera name="top" pos="0 0 1" fovy="50"/>
    <light name="lamp" pos="0 0 3" diffuse="0.5 0.5 0.5"/>
    <geom type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" range="-1 1" damping="0.5" armature="0.1" ref="0.2"/>
      <geom name="link" type="capsule" size="0.05 0.2" mass="1"/>
      <geom size="0.06" mass="0.5" pos="0 0 0.2"/>
      <geom name="pad" size="0.06" mass="0"/>
      <site name="tip" pos="0 0 0.3"/>
      <body name="hand" pos="0 0 0.3">
        <joint name="ball" type="ball" damping="0.1"/>
        <joint name="slide" type="slide" axis="1 0 0" stiffness="3" springref="0.1"/>
        <geom type="box" size="0.05 0.02 0.03" mass="0.2"/>
      </body>
    </body>
    <body name="cube" pos="1 0 1">
      <freejoint name="cube"/>
      <geom name="cube" type="box" size="0.05 0.05 0.05" density="700"/>
    </body>
  </worldbody>
  <tendon><fixed name="rope" stiffness="5"><joint joint="hinge" coef="1"/></fixed></tendon>
  <actuator>
    <position name="servo" joint="hinge" kp="20" kv="2" ctrlrange="-1 1"/>
    <velocity name="speed" joint="slide" kv="3"/>
    <motor name="push" joint="slide" gear="2"/>
  </actuator>
</mujoco>
"""
FIELDS = [
    'friction: {select: {geom: "**", where: {type: box}}, attr: friction, uniform: [[0.4, 0.001, 0], [1.2, 0.01, 0.1]]}',
    'friction0: {select: {geom: "**"}, attr: "friction[0]", scale: {uniform: [0.5, 2]}}',
    "solref: {select: {geom: link}, attr: 'solref[0]', uniform: [0.02, 0.04]}",
    'damping: {select: {joint: "{hinge,ball}"}, attr: damping, scale: {loguniform: [0.5, 2]}}',
    "armature: {select: {joint: hinge}, attr: armature, per: sample, offset: {lognormal: {mean: -3, std: 1}}}",
    "stiffness: {select: {joint: slide}, attr: stiffness, truncnormal: {mean: 3, std: 1, min: 1, max: 5}}",
    "range: {select: {joint: hinge}, attr: range, offset: {normal: {std: 2deg}}}",
    'mass: {select: {body: "**"}, attr: mass, scale: {loguniform: [0.5, 2]}}',
    "weight: {select: {body: cube}, attr: mass, uniform: [0.1, 0.5]}",
    "place: {select: {body: hand}, attr: pos, offset: {normal: {std: 0.01}}}",
    "camera: {select: {camera: top}, attr: pos, offset: {normal: {std: 0.01}}}",
    "fovy: {select: {camera: top}, attr: fovy, uniform: [40, 60]}",
    "zoom: {select: {camera: top}, attr: fovy, offset: {uniform: [-1deg, 0.1rad]}}",
    "beam: {select: {light: lamp}, attr: cutoff, uniform: [0.5rad, 40deg]}",
    "light: {select: {light: lamp}, attr: diffuse, per: sample, uniform: [0.2, 0.9]}",
    "tip: {select: {site: tip}, attr: 'pos[2]', offset: {uniform: [0, 0.1]}}",
    "kp: {select: {actuator: servo}, attr: kp, scale: {uniform: [0.5, 2]}}",
    "kv: {select: {actuator: servo}, attr: kv, uniform: [1, 3]}",
    "speed: {select: {actuator: speed}, attr: kv, offset: {uniform: [-1, 1]}}",
    "gear: {select: {actuator: push}, attr: 'gear[0]', choice: [1, 2, 3]}",
    "group: {select: {geom: cube}, attr: group, integers: [0, 4]}",
    "rope: {select: {tendon: rope}, attr: stiffness, scale: {uniform: [0.5, 2]}}",
]
SIZES = [
    "size: {select: {geom: pad}, attr: 'size[0]', scale: {uniform: [0.9, 1.1]}}",
    "sizes: {select: {geom: pad}, attr: size, choice: [[0.1], [0.2]]}",
]
IS_OLD = mujoco.__version__.startswith("3.")
"""MuJoCo 3 does not compute the bounds of a geom again when its size changes, so no world can draw it."""
if not IS_OLD:
    FIELDS.append(SIZES[0])


def recipe(folder: Path, fields: list[str], model: str = MODEL, samples: int = 5) -> Path:
    (folder / "model.xml").write_text(model)
    lines = "".join(f"    {field}\n" for field in fields)
    text = f"recipe: 1\nname: m\nbase: ./model.xml\nrandomize:\n  seed: 7\n  samples: {samples}\n  fields:\n{lines}"
    path = folder / "r.yaml"
    path.write_text(text)
    return path


def built(path: Path, sample: int = 0) -> tuple[Built | None, Context]:
    context = Context(folder=path.parent, environment={})
    return build(ModelRequest(path, sample=sample, worlds=sample == 0), context), context


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("table")
    found, context = built(recipe(folder, FIELDS))
    assert found is not None, [each.message for each in context.sink.diagnostics]
    write_folder(found.bundle, folder / "out")
    return folder


def loaded(folder: Path) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(folder / "model.xml"))


def test_many_samples_begin_with_the_draws_of_few(table: Path, tmp_path: Path) -> None:
    """They are drawn all at once, with numpy: by other code than few, and to the same bits."""
    fields = FIELDS if IS_OLD else [*FIELDS, SIZES[1]]
    few, many = (
        built(recipe(tmp_path, fields, samples=count))[0].bundle.files["samples.csv"].splitlines()  # type: ignore[union-attr]
        for count in (5, 80)
    )
    assert len(many) == 82 and many[:7] == few


@pytest.mark.skipif(not IS_OLD, reason="MuJoCo 4 computes the bounds again")
@pytest.mark.parametrize("field", SIZES)
def test_sizes_of_mujoco_3_are_an_error(field: str, tmp_path: Path) -> None:
    found, context = built(recipe(tmp_path, [field]))
    assert found is None
    [error] = context.sink.errors
    assert error.code == "draw-at-run-time"
    assert error.message.endswith("differs from sample 1 as a build makes it: `bvh_aabb`, `geom_aabb`, `geom_rbound`")


def test_draws_are_within_their_bounds(table: Path) -> None:
    columns = json.loads((table / "out" / "randomize.json").read_text())["columns"]
    rows = np.genfromtxt(table / "out" / "samples.csv", delimiter=",", skip_header=1)[:, 1:]
    assert rows.shape == (6, len(columns)) and np.isnan(rows[0]).all()
    for column, draws in zip(columns, rows[1:].T, strict=True):
        assert column["low"] is None or min(draws) >= column["low"]
        assert column["high"] is None or max(draws) <= column["high"]
    assert columns[0]["low"] is not None


def test_the_file_says_what_its_columns_are(table: Path) -> None:
    data = json.loads((table / "out" / "randomize.json").read_text())
    by_name = {column["column"]: column for column in data["columns"]}
    model = loaded(table / "out")
    (target,) = by_name["friction[cube][0]"]["targets"]
    assert target == {
        "type": "geom",
        "name": "cube",
        "id": model.geom("cube").id,
        "array": "geom_friction",
        "index": [model.geom("cube").id, 0],
    }
    assert (by_name["friction[cube][0]"]["low"], by_name["friction[cube][0]"]["high"]) == (0.4, 1.2)
    assert [each["index"] for each in by_name["damping[ball]"]["targets"]] == [
        [model.joint("ball").dofadr[0] + n] for n in range(3)
    ]
    assert [each.get("sign", 1) for each in by_name["kp[servo]"]["targets"]] == [1, -1]
    assert data["fields"]["range"] == {
        "select": "{joint: hinge}",
        "attribute": "range",
        "operation": "offset",
        "per": "element",
        "distribution": "normal",
        "parameters": {"mean": 0.0, "std": 2.0},
        "unit": "deg",
    }


@pytest.mark.parametrize(("angle", "unit"), [("degree", np.pi / 180), ("radian", 1.0)])
def test_bounds_are_in_the_unit_of_the_draws(tmp_path: Path, angle: str, unit: float) -> None:
    """Bare angles are in the unit of the recipe; MuJoCo has radians, but degrees for `fovy`, and a slide has meters."""
    fields = [
        "range: {select: {joint: hinge}, attr: range, uniform: [[-90, 10], [-80, 20]]}",
        "ref: {select: {joint: hinge}, attr: 'range[1]', offset: {choice: [30, 60]}}",
        "slide: {select: {joint: slide}, attr: range, uniform: [[-3, 1], [-2, 2]]}",
        "fovy: {select: {camera: top}, attr: fovy, uniform: [40deg, 60deg]}",
    ]
    path = recipe(tmp_path, fields, model=MODEL.replace('axis="1 0 0"', 'axis="1 0 0" range="-1 1"'))
    path.write_text(f"angle: {angle}\n" + path.read_text())
    found, context = built(path)
    assert found is not None, [each.message for each in context.sink.diagnostics]
    columns = json.loads(found.bundle.files["randomize.json"])["columns"]
    bounds = {column["column"]: (column["low"], column["high"]) for column in columns}
    assert bounds == {
        "range[hinge][0]": pytest.approx((-90 * unit, -80 * unit)),
        "range[hinge][1]": pytest.approx((10 * unit, 20 * unit)),
        "ref[hinge]": pytest.approx((30 * unit, 60 * unit)),
        "slide[slide][0]": (-3, -2),
        "slide[slide][1]": (1, 2),
        "fovy[top]": (40, 60),
    }


def test_what_a_frame_turns_cannot_be_put_into_an_array(tmp_path: Path) -> None:
    """The position of a body in a turned frame is not its position in mjModel."""
    model = MODEL.replace('<body name="cube" pos="1 0 1">', '<frame euler="0 0 1"><body name="cube" pos="1 0 1">')
    model = model.replace("</body>\n  </worldbody>", "</body></frame>\n  </worldbody>")
    field = "place: {select: {body: cube}, attr: 'pos[0]', offset: {uniform: [0.1, 0.2]}}"
    found, context = built(recipe(tmp_path, [field], model=model))
    assert found is None
    (told,) = context.sink.diagnostics
    assert told.code == "draw-at-run-time" and "`body_pos`" in told.message


def test_copies_without_names_are_not_guessed(tmp_path: Path) -> None:
    model = MODEL.replace(
        '<geom size="0.06" mass="0.5" pos="0 0 0.2"/>',
        '<replicate count="2" offset="0 0 1"><geom size="0.06"/></replicate>',
    )
    found, context = built(
        recipe(tmp_path, ["f: {select: {geom: '**'}, attr: 'friction[0]', uniform: [1, 2]}"], model=model)
    )
    assert found is None
    assert any("cannot be distinguished" in each.message for each in context.sink.diagnostics)


def test_behind_an_actuator_with_several_outputs(tmp_path: Path) -> None:
    if not hasattr(mujoco.mjtGain, "mjGAIN_SO3"):
        pytest.skip("this MuJoCo has no actuator with several outputs")
    model = """<mujoco><worldbody><body name="b"><joint name="b" type="ball"/><geom size=".1"/>
      <body><joint name="j"/><geom size=".1"/></body></body></worldbody>
      <actuator><orientation name="o" joint="b" kp="2"/><motor name="p" joint="j" gear="2"/></actuator></mujoco>"""
    field = 'gear: {select: {actuator: p}, attr: "gear[0]", scale: {uniform: [0.5, 2]}}'
    found, context = built(recipe(tmp_path, [field], model=model))
    assert found is not None, [each.message for each in context.sink.diagnostics]
    (column,) = json.loads(found.bundle.files["randomize.json"])["columns"]
    assert [(each["array"], each["index"]) for each in column["targets"]] == [("actuator_gear", [3, 0])]


def test_what_mujoco_has_no_time_for_has_a_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.mujoco.engine import Called, Session
    from mjcompose.mujoco.settable import resolve_addresses
    from mjcompose.verify.draws import DrawTable

    (tmp_path / "m.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./m.xml\nrandomize:\n  seed: 1\n  samples: 3\n"
        "  fields: {d: {select: {joint: hinge}, attr: damping, uniform: [0.1, 1]}}\n"
    )
    context = Context(folder=tmp_path)
    built = build(ModelRequest(Path("r.yaml"), verified=False), context)
    assert built is not None
    late = Called(False, error="MuJoCo did not finish within 2 s", crash="timeout")
    monkeypatch.setattr("mjcompose.mujoco.engine.call", lambda *_, **__: late)
    with Session() as session:
        assert DrawTable(built.plan, (), session, context).ask(resolve_addresses, [], []) is None
    (error,) = context.sink.errors
    assert (error.code, error.span and error.span.line) == ("mujoco-timeout", 5)
    assert error.help is not None and "--timeout" in error.help


WORLDS_MODEL = """<mujoco><worldbody>
  <body name="fixed" pos="{fixed}"/>
  <body name="first" mocap="true" pos="{first}" quat="{first_quat}"/>
  <body name="loose" pos="{loose}"><freejoint/><geom size=".1"/></body>
  <body name="second" mocap="true" pos="{second}" quat="{second_quat}"/>
  <body name="third" mocap="true" pos="{third}"/>
</worldbody><keyframe>
  <key name="plain"/><key name="own" mpos="9 9 9 8 8 8 7 7 7" qpos="1 1 1 1 0 0 0"/><key name="again"/>
</keyframe></mujoco>"""
POSES = {
    "fixed": "5 5 5",
    "first": "1 2 3",
    "loose": "4 5 6",
    "second": "7 8 10",
    "third": "11 12 13",
    "first_quat": "1 0 0 0",
    "second_quat": ".6 .8 0 0",
}


def compiled(**poses: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(WORLDS_MODEL.format(**{**POSES, **poses}))


@pytest.mark.parametrize("name", ["fixed", "first", "loose", "second", "third"])
@pytest.mark.parametrize("component", range(3))
def test_what_follows_from_a_position_is_what_mujoco_copies(name: str, component: int) -> None:
    numbers = POSES[name].split()
    numbers[component] = "20"
    before = compiled()
    after = compiled(**{name: " ".join(numbers)})
    changed = {
        (array, int(index))
        for array in ("qpos0", "qpos_spring", "key_qpos", "key_mpos", "key_mquat", "body_ipos")
        for index in np.flatnonzero(flat(before, array) != flat(after, array))
    }
    target = {"array": "body_pos", "index": [before.body(name).id, component]}
    found = [place for _, places in _following(before, [{"targets": [target]}]) for place in places]
    assert set(found) == changed and len(found) == len(changed)


@pytest.mark.parametrize(("name", "mocap"), [("first", 0), ("second", 1), ("third", 2)])
def test_an_orientation_goes_into_every_key_that_has_it(name: str, mocap: int) -> None:
    model = compiled()
    target = {"array": "body_quat", "index": [model.body(name).id, 2]}
    found = [place for _, places in _following(model, [{"targets": [target]}]) for place in places]
    assert [index for array, index in found if array == "key_mquat"] == [key * 12 + mocap * 4 + 2 for key in range(3)]


@pytest.mark.parametrize("given", ["meaninertia", "meanmass"])
def test_a_mean_that_is_given_is_not_computed(given: str) -> None:
    text = WORLDS_MODEL.format(**POSES).replace("<keyframe>", f'<statistic {given}="7"/><keyframe>')
    model = mujoco.MjModel.from_xml_string(text)
    computed = DerivedValues(mujoco, model, mujoco.MjData(model))
    before = model.stat.meaninertia, model.stat.meanmass
    model.body_mass[3] *= 2
    model.body_inertia[3] *= 2
    computed.settle()
    other = "meanmass" if given == "meaninertia" else "meaninertia"
    assert getattr(model.stat, given) == 7
    assert getattr(model.stat, other) > 1.5 * before[other == "meanmass"]


def test_infinite_numbers_are_near_themselves_alone() -> None:
    inf = np.inf
    pairs = [(inf, inf), (-inf, -inf), (inf, -inf), (1, inf), (inf, 1), (np.nan, np.nan), (np.nan, inf), (1, 1)]
    assert [are_close(*pair) for pair in pairs] == [True, True, False, False, False, True, False, True]

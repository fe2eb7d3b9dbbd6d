"""`build --as worlds`: cells with other geoms and assets are one model, in which each moves as it does alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
from click.testing import CliRunner, Result
from mjcompose import worlds
from mjcompose.cli.main import main
from mjcompose.tools.worlds import cell_numbers, joint_text
from mjcompose.tools.worlds.join import WorldGroup
from mjcompose.tools.worlds.shared import check_shapes, difference
from mjcompose.tools.worlds.slots import GeomSlot, OwnGeom, with_geoms

FLOOR = '<mujoco><worldbody><geom name="floor" type="plane" size="2 2 .1"/></worldbody></mujoco>'
ROCK = "0 0 0  .05 0 0  0 .06 0  .01 .01 .07"
ROCK_FACES = "0 2 1  0 1 3  0 3 2  1 2 3"
SLAB = "0 0 0  .1 0 0  0 .1 0  .1 .1 0  0 0 .02  .1 0 .02  0 .1 .02  .1 .1 .02"
HANDLE = "0 0 0  .02 0 0  0 .02 0  .02 .02 0  0 0 .1  .02 0 .1  0 .02 .1  .02 .02 .1"
BOX_FACES = "0 2 1  1 2 3  4 5 6  5 7 6  0 1 4  1 5 4  2 6 3  3 6 7  0 4 2  2 4 6  1 3 5  3 7 5"
OBJECTS = {
    "cube": '<geom name="box" type="box" size=".03 .03 .03" mass=".1" material="paint"/>',
    "ball": '<geom name="box" type="sphere" size=".04" pos="0 0 .01" mass=".2" friction=".3 .01 .001" material="paint"/>',
    "hammer": '<geom type="capsule" size=".01 .06" mass=".1"/><geom type="box" size=".02 .04 .02" pos="0 0 .07" mass=".4"/>',
    "rock": '<geom type="mesh" mesh="one" contype="0" conaffinity="0" mass="0"/><geom type="mesh" mesh="one" mass=".3" condim="4"/>',
    "slab": '<geom type="mesh" mesh="two" condim="4" density="500"/><geom type="mesh" mesh="one" condim="4" density="700"/>',
}
MESHES = {
    "rock": f'<mesh name="one" vertex="{ROCK}" face="{ROCK_FACES}"/>',
    "slab": f'<mesh name="one" vertex="{HANDLE}" face="{BOX_FACES}"/><mesh name="two" vertex="{SLAB}" face="{BOX_FACES}"/>',
}
COLORS = {"cube": "1 0 0 1", "ball": "0 1 0 1"}
EXACT = ("ball", "hammer", "rock")
"""The objects that are the same bit for bit: MuJoCo treats the inertia of the cube specially, and moves a mesh of the
slab into another frame.
"""
RECIPE = """\
recipe: 1
name: pick
base: ./floor.xml
params: {object: {default: ./cube.xml, choices: [%(files)s]}}
attach: {object: {model: "${object}", pos: [0, 0, 0.1]}}
keyframe: {start: {}}
matrix: {axes: {object: [%(files)s]}, name: "${object}"}
"""
DRAWN = """\
randomize:
  seed: 3
  samples: 3
  fields:
    mass: {select: {body: object/object}, attr: mass, scale: {uniform: [0.5, 2]}}
    grip: {select: {geom: floor}, attr: "friction[0]", uniform: [0.3, 1.2]}
"""


def lay_out(folder: Path, names: tuple[str, ...] = tuple(OBJECTS), more: str = "") -> Path:
    (folder / "floor.xml").write_text(FLOOR)
    for name in names:
        material = f'<material name="paint" rgba="{COLORS[name]}"/>' if name in COLORS else ""
        (folder / f"{name}.xml").write_text(
            f"<mujoco><asset>{material}{MESHES.get(name, '')}</asset><worldbody>"
            f'<body name="object"><freejoint name="free"/>{OBJECTS[name]}</body></worldbody></mujoco>'
        )
    files = ", ".join(f"./{name}.xml" for name in names)
    (folder / "pick.yaml").write_text(RECIPE % {"files": files} + more)
    return folder


def run(folder: Path, *arguments: str) -> Result:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return CliRunner().invoke(main, ["build", "pick.yaml", *arguments])


def joint(folder: Path, *arguments: str) -> worlds.Worlds:
    result = run(folder, "--as", "worlds", "-o", "out/", *arguments)
    assert result.exit_code == 0, result.output
    return worlds.load(folder / "out")


def alone(folder: Path) -> list[mjcompose.Loaded]:
    result = run(folder, "--all", "-o", "each/{name}/")
    assert result.exit_code == 0, result.output
    return [each.load() for each in mjcompose.load_many(folder / "each")]


def thrown(model: mujoco.MjModel, steps: int = 500) -> np.ndarray:
    """The motion of the object after it was thrown at the floor."""
    data = mujoco.MjData(model)
    data.qvel[:] = [-0.8, 0.3, 0, 5, 9, 3]
    found = []
    touched = 0
    for _ in range(steps):
        mujoco.mj_step(model, data)
        touched += data.ncon
        found.append(data.qpos.copy())
    assert touched > 100
    return np.array(found)


@pytest.fixture(scope="module")
def pick(tmp_path_factory: pytest.TempPathFactory) -> tuple[worlds.Worlds, list[mjcompose.Loaded]]:
    folder = lay_out(tmp_path_factory.mktemp("pick"))
    return joint(folder), alone(folder)


def test_each_world_moves_as_its_cell(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    study, built = pick
    assert study.count == len(built) == len(OBJECTS)
    for world, each in enumerate(built):
        name = Path(str(study.table.cells[study.table.cell[world]]["name"])).stem
        found = thrown(study.model(world))
        wanted = thrown(each.model)
        assert np.abs(found - wanted).max() <= (0 if name in EXACT else 1e-8), name


def test_nothing_but_geoms_is_added(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    study, built = pick
    model = study.nominal
    for each in built:
        for size in ("nq", "nv", "nu", "nbody", "njnt"):
            assert getattr(model, size) == getattr(each.model, size)
    # The floor; a box, a sphere and a capsule with condim 3; a mesh that touches nothing; two that touch.
    assert model.ngeom == 7
    assert study.table.present.sum(axis=1).tolist() == [each.model.ngeom for each in built]
    assert (study.values("geom_rgba")[~study.table.present] == 0).all()
    assert model.nmesh == 3 and model.nmat == 2


def test_colors_are_those_of_the_cell(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    study, built = pick
    for world, each in enumerate(built[:2]):
        model = study.model(world)
        (slot,) = [at for at in np.flatnonzero(study.table.present[world]) if model.geom_bodyid[at] == 1]
        assert (model.mat_rgba[model.geom_matid[slot]] == each.model.mat_rgba[0]).all()


def test_draws_of_each_cell(tmp_path: Path) -> None:
    names = ("cube", "ball", "hammer", "rock")
    folder = lay_out(tmp_path, names, more=DRAWN)
    study = joint(folder)
    assert study.count == 12 and study.table.sample.tolist() == [1, 2, 3] * 4
    built = {(each.manifest.params["object"], each.manifest.sample): each.model for each in alone(folder)}
    for world in (0, 2, 4, 9, 11):
        key = study.table.cells[study.table.cell[world]]["object"], int(study.table.sample[world])
        assert np.allclose(thrown(study.model(world), 200), thrown(built[key], 200), atol=1e-6)


def test_a_batch_steps_the_worlds(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    pytest.importorskip("mujoco.batch", reason="MuJoCo 3.17")
    study, built = pick
    batch = worlds.mujoco(study, nthread=1)
    batch.reset()
    batch.step(nstep=300)
    for world, each in enumerate(built):
        data = mujoco.MjData(each.model)
        mujoco.mj_step(each.model, data, 300)
        assert np.abs(batch.qpos[world] - data.qpos).max() <= 1e-8


def test_shares_of_worlds(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    study, _ = pick
    assert study.assign(7).table.cell.tolist() == [0, 1, 2, 3, 4, 0, 1]
    few = study.assign(10, weights={"object": {"./ball.xml": 3, "./slab.xml": 0, "./rock.xml": 0}})
    assert np.bincount(few.table.cell, minlength=5).tolist() == [2, 6, 2, 0, 0]
    assert (few.values("geom_size")[1] == study.values("geom_size")[few.table.cell[1]]).all()
    assert set(few.table.cell[:5]) == {0, 1, 2}
    assert few.assign(5).table.cell.tolist() == [0, 1, 2, 3, 4]


def test_weights_of_a_recipe(tmp_path: Path) -> None:
    names = ("cube", "ball", "hammer")
    folder = lay_out(tmp_path, names)
    text = (folder / "pick.yaml").read_text()
    (folder / "pick.yaml").write_text(text.replace(', name: "', ', weights: {object: {./ball.xml: 3}}, name: "'))
    study = joint(folder)
    assert study.table.weights.tolist() == [1, 3, 1]
    assert np.bincount(study.assign(10).table.cell).tolist() == [2, 6, 2]
    assert np.bincount(study.assign(9, weights={}).table.cell).tolist() == [3, 3, 3]


@pytest.mark.parametrize(
    ("weights", "said"),
    [
        (
            "{object: {./cup.xml: 3}}",
            "error[out-of-range]: `matrix.weights.object` has `./cup.xml`, which is not a value",
        ),
        ("{objet: {./cube.xml: 3}}", "the matrix has no axis `objet`"),
        ("{object: {./cube.xml: 0, ./ball.xml: 0}}", "error[out-of-range]: all weights are 0"),
        ("{object: {./cube.xml: -1}}", "error["),
    ],
)
def test_wrong_weights_of_a_recipe(tmp_path: Path, weights: str, said: str) -> None:
    folder = lay_out(tmp_path, ("cube", "ball"))
    text = (folder / "pick.yaml").read_text()
    (folder / "pick.yaml").write_text(text.replace(', name: "', f', weights: {weights}, name: "'))
    result = run(folder, "--as", "worlds", "-o", "out/")
    assert result.exit_code == 1 and said in result.output, result.output


@pytest.mark.parametrize(
    ("weights", "said"),
    [
        ({"object": {"./bal.xml": 3}}, "`weights.object` has `./bal.xml`, which is not a value of the axis"),
        ({"objet": {"./ball.xml": 3}}, "the worlds have no axis `objet`"),
        ({"object": {f"./{name}.xml": 0 for name in OBJECTS}}, "all weights are 0"),
        ({"object": {"./ball.xml": -1}}, "the weight of `./ball.xml` is -1"),
    ],
)
def test_wrong_weights(
    pick: tuple[worlds.Worlds, list[mjcompose.Loaded]], weights: dict[str, dict[str, float]], said: str
) -> None:
    with pytest.raises(mjcompose.LoadError, match=said):
        pick[0].assign(8, weights=weights)


def test_warp_steps_the_worlds_and_switches_them(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    """Half of the worlds get other cells in place; the others move as without that, bit for bit."""
    mujoco_warp = pytest.importorskip("mujoco_warp", reason="mujoco-warp is not installed")
    study = pick[0].assign(6)

    def moved(study: worlds.Worlds, model: mujoco_warp.Model, data: mujoco_warp.Data) -> np.ndarray:
        data.qpos.assign(study.values("qpos0").astype(np.float32))
        for _ in range(100):
            mujoco_warp.step(model, data)
        return data.qpos.numpy().copy()

    model = worlds.warp(study)
    address = model.geom_dataid.ptr
    data = worlds.warp_data(study, nconmax=40, njmax=160)
    before = moved(study, model, data)
    wanted = []
    for each in study.models():
        own = mujoco.MjData(each)
        mujoco.mj_step(each, own, 100)
        wanted.append(own.qpos.copy())
    assert np.allclose(before, wanted, atol=1e-4)
    data = worlds.warp_data(study, nconmax=40, njmax=160)
    other = worlds.switch(model, data, study, worlds=[0, 2, 4], cells=["./rock.xml", 0, 1])
    assert other.table.cell.tolist() == [3, 1, 0, 3, 1, 0] and model.geom_dataid.ptr == address
    after = moved(other, model, data)
    assert (after[[1, 3, 5]] == before[[1, 3, 5]]).all()
    assert (after[[0, 2, 4]] == before[[3, 0, 1]]).all()


def test_what_mjx_has_once(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]], tmp_path: Path) -> None:
    with pytest.raises(
        mjcompose.LoadError, match="these cells differ in the mesh of #. of body `object/object`"
    ) as caught:
        check_shapes(pick[0].take([3, 4]))
    assert caught.value.diagnostics[0].code == "not-per-world"
    with pytest.raises(mjcompose.LoadError, match=r"the cell `./cube.xml` lacks that of #. of body `object/object`"):
        check_shapes(joint(lay_out(tmp_path, ("cube", "rock"))))


def test_an_error_names_cells_and_the_element(pick: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    assert (
        difference(pick[0], "geom_friction")
        == "these cells differ in it: `./cube.xml`, `./ball.xml`, of the geom #2 of body `object/object`"
    )


def without(name: str) -> Callable[[pytest.MonkeyPatch], None]:
    plain = WorldGroup.varying

    def change(patch: pytest.MonkeyPatch) -> None:
        patch.setattr(WorldGroup, "varying", lambda group: (each for each in plain(group) if each[0] != name))

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without("geom_friction"), "`geom_friction`"),
        (without("dof_invweight0"), "`dof_invweight0`"),
        (without("body_invweight0"), "`body_invweight0`"),
        (without("geom_dataid"), "`geom_dataid`, `mesh_vert`"),
        (lambda patch: patch.setattr(cell_numbers, "set_volumes", lambda *_: None), "`bvh_aabb`"),
        (lambda patch: patch.setattr(joint_text.JointText, "make_convex", lambda *_: None), "`mesh_graph`"),
    ],
    ids=["friction", "inverse inertia", "inverse weights", "meshes", "volumes", "hulls"],
)
def test_a_wrong_table_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: Callable[[pytest.MonkeyPatch], None], said: str
) -> None:
    change(monkeypatch)
    result = run(lay_out(tmp_path), "--as", "worlds", "-o", "out/")
    assert result.exit_code == 1 and "differs from its world in the joint model" in result.output
    assert said in result.output and not (tmp_path / "out").exists()


def test_geoms_keep_the_order_of_each_cell() -> None:
    cells = ["abc", "acb", "ba", "cab", "d"]
    slots: list[GeomSlot] = []
    for cell, keys in enumerate(cells):
        slots = with_geoms(slots, [OwnGeom(key, "", number) for number, key in enumerate(keys)], cell)
    for cell, keys in enumerate(cells):
        own = [slot for slot in slots if cell in slot.geoms]
        assert "".join(str(slot.key) for slot in own) == keys
        assert [slot.geoms[cell] for slot in own] == list(range(len(keys)))
    assert len(slots) <= 7


ARM = """\
<mujoco><worldbody><body name="{body}"><{joint} name="lid" {more}/><geom name="g" type="{shape}" size=".1 .1 .1" pos="0 0 .1"/>
  <site name="s"/></body></worldbody>{end}</mujoco>
"""
TWO = """\
recipe: 1
name: two
base: ./${which}.xml
params: {which: a}
matrix: {axes: {which: [a, b]}, name: "${which}"}
"""
DISTANCE = '<sensor><distance name="near" body1="box" body2="world" cutoff="1"/></sensor>'


@pytest.mark.parametrize(
    ("other", "end", "said", "help"),
    [
        ({"body": "can"}, "", "it has another tree", "`--pick`, or add `--as union`: one model has the parts of all"),
        ({"more": 'type="slide"'}, "", "the joint `lid` is a slide, not a hinge", "use one type of joint in all cells"),
        (
            {"shape": "sphere"},
            DISTANCE,
            "the sensor `near` measures the distance of the body `box`, whose absent geoms it would see",
            "name the geom in the sensor",
        ),
    ],
    ids=["bodies", "joints", "distances"],
)
def test_cells_that_are_no_worlds(tmp_path: Path, other: dict[str, str], end: str, said: str, help: str) -> None:
    plain = {"body": "box", "joint": "joint", "more": 'type="hinge"', "shape": "box", "end": end}
    (tmp_path / "a.xml").write_text(ARM.format(**plain))
    (tmp_path / "b.xml").write_text(ARM.format(**plain | other))
    (tmp_path / "pick.yaml").write_text(TWO)
    result = run(tmp_path, "--as", "worlds", "-o", "out/")
    assert result.exit_code == 1 and "error[not-a-world]: `b` cannot be a world of `a`" in result.output
    assert said in result.output and help in result.output, result.output
    assert not (tmp_path / "out").exists()


def test_many_places_are_a_warning(tmp_path: Path) -> None:
    geoms = "".join(f'<geom size=".02" pos="{n} 0 0" condim="{{condim}}" mass=".1"/>' for n in range(5))
    for name, condim in (("cube", 1), ("ball", 3), ("rock", 4)):
        text = f'<mujoco><worldbody><body name="object"><freejoint name="free"/>{geoms}</body></worldbody></mujoco>'
        (tmp_path / f"{name}.xml").write_text(text.format(condim=condim))
    files = "./cube.xml, ./ball.xml, ./rock.xml"
    (tmp_path / "floor.xml").write_text(FLOOR)
    (tmp_path / "pick.yaml").write_text(RECIPE % {"files": files})
    result = run(tmp_path, "--as", "worlds", "-o", "out/")
    assert result.exit_code == 0, result.output
    assert "warning[worlds-padded]: one body has 15 places for geoms, of which a world uses 5 at most" in result.output


RACK = '<body name="rack" pos="{}"><geom type="box" size=".2 .02 .1" pos="0 0 .1"/>{}</body>'
DRIVER = '<body name="driver" pos="0 0 .3"><joint name="turn" axis="0 0 1"/><geom type="capsule" size=".01 .05" mass=".2"/>{}</body>'
DOG = '<body name="trunk" pos="0 0 .4"><freejoint name="free"/><geom type="box" size=".2 .1 .05" mass="6"/><body name="pack" pos="0 0 .08">{}</body></body>'
TASKS = {
    "mug rack": [
        RACK.format("0 .4 0", '<geom name="peg" type="capsule" size=".008 .04" pos="0 -.05 .15" euler="90 0 0"/>'),
        RACK.format("0 .5 .1", '<geom name="hook" type="box" size=".01 .05 .01" pos="0 -.05 .15" friction=".4"/>'),
    ],
    "screwdriver": [
        DRIVER.format('<geom name="slotted" type="box" size=".004 .001 .02" pos="0 0 -.07" mass=".02"/>'),
        DRIVER.format('<geom name="cross" type="mesh" mesh="bit" pos="0 0 -.07" mass=".02"/>'),
        DRIVER.format('<geom name="hex" type="cylinder" size=".003 .02" pos="0 0 -.07" mass=".02"/>'),
        DRIVER.format('<geom name="torx" type="cylinder" size=".002 .03" pos="0 0 -.08" mass=".01"/>'),
    ],
    "backpack": [
        DOG.format(""),
        DOG.format('<geom type="box" size=".1 .08 .05" mass="2"/>'),
        DOG.format('<geom type="cylinder" size=".05 .1" mass="1"/><geom size=".04" pos="0 0 .12" mass=".3"/>'),
    ],
}


@pytest.mark.parametrize("task", TASKS)
def test_other_tasks(tmp_path: Path, task: str) -> None:
    """A ball falls on what differs; each world moves as its cell."""
    names = [f"v{number}" for number in range(len(TASKS[task]))]
    for name, body in zip(names, TASKS[task], strict=True):
        (tmp_path / f"{name}.xml").write_text(
            f'<mujoco><asset><mesh name="bit" vertex="{HANDLE}" face="{BOX_FACES}" scale=".1 .1 .1"/></asset><worldbody>'
            f'<geom name="floor" type="plane" size="2 2 .1"/>{body}'
            '<body name="ball" pos="0 .01 .7"><freejoint name="ball"/><geom size=".04" mass=".3"/></body></worldbody></mujoco>'
        )
    (tmp_path / "pick.yaml").write_text(TWO.replace("[a, b]", str(names)).replace("which: a", "which: v0"))
    study = joint(tmp_path)
    assert study.count == len(names) and study.nominal.nv == alone(tmp_path)[0].model.nv
    for world, each in enumerate(alone(tmp_path)):
        states = []
        for model in (study.model(world), each.model):
            data = mujoco.MjData(model)
            mujoco.mj_step(model, data, 400)
            states.append(data.qpos.copy())
        assert np.abs(states[0] - states[1]).max() <= 1e-8, names[world]
